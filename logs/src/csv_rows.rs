//! The rows of a CSV log in canonical order, checked one by one: what every CSV reader and the conversion in batches share.
//!
//! ```text
//! every cell finite,   t_k > t_{k−1},   or the row repeats row k−1 in every column read: then it is dropped and counted
//! ```
//!
//! Leaves out: the meaning of the columns. The formats say which column is which ([`Header`], [`RowLayout`]) and in
//! which unit time comes ([`Clock`]).

use std::io::BufRead;
use std::ops::Range;
use std::path::Path;

use tribo_files::csv_lines::{Lines, RowLayout};
use tribo_files::{LogError, ROWS_PER_GROUP};

use crate::differentiated::differentiate;
use crate::format::LogFormat;
use crate::header::Header;
use crate::log::{LogColumns, RobotLog};
use crate::stretches::Stretches;
use crate::summary::LogSummary;

/// The unit of the first column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Clock {
    Seconds,
    Milliseconds,
    /// Samples of 1 ms; whole numbers only.
    SampleIndex,
}

impl Clock {
    /// The stamp in seconds; `None` for a broken sample index.
    fn seconds(self, value: f64) -> Option<f64> {
        match self {
            Self::Seconds => Some(value),
            Self::Milliseconds => Some(value / 1e3),
            Self::SampleIndex => (value.fract() == 0.0).then_some(value / 1e3),
        }
    }
}

/// A CSV log being read.
pub(crate) struct CsvRows<'p, R> {
    lines: Lines<'p, R>,
    path: &'p Path,
    pub format: LogFormat,
    pub header: Header,
    layout: RowLayout,
    clock: Clock,
    /// Suspicions found before the first row.
    pub warnings: Vec<String>,
    pub dropped_repeats: usize,
    cells: Vec<Range<usize>>,
    row: Vec<f64>,
    previous: Vec<f64>,
}

impl<'p, R: BufRead> CsvRows<'p, R> {
    /// `lines` stands after the header line; `header` says where the canonical columns are among `names`.
    pub fn new(
        lines: Lines<'p, R>,
        path: &'p Path,
        format: LogFormat,
        names: &[String],
        delimiter: u8,
        header: Header,
        clock: Clock,
    ) -> Self {
        let columns = header.positions.iter().map(|&position| (names[position].clone(), position)).collect();
        let layout = RowLayout { cell_count: names.len(), delimiter, columns };
        let row = vec![0.0; layout.columns.len()];
        let (cells, previous, warnings) = (Vec::new(), Vec::new(), Vec::new());
        Self { lines, path, format, header, layout, clock, warnings, dropped_repeats: 0, cells, row, previous }
    }

    /// The next row that is new, time in seconds first; `None` at the end of the file.
    pub fn advance(&mut self) -> Result<Option<&[f64]>, LogError> {
        loop {
            if !self.lines.advance()? {
                return Ok(None);
            }
            self.layout.read(&self.lines, &mut self.cells, &mut self.row)?;
            let Some(stamp_s) = self.clock.seconds(self.row[0]) else {
                let column = &self.layout.columns[0].0;
                return Err(self.lines.bad_line(format!("column {column}: {} is no sample index", self.row[0])));
            };
            self.row[0] = stamp_s;
            match self.previous.first() {
                Some(&previous_s) if stamp_s <= previous_s => {
                    if self.row != self.previous {
                        let (path, line) = (self.path.to_path_buf(), self.lines.number);
                        return Err(LogError::TimeStepsBack { path, line, previous_s, value_s: stamp_s });
                    }
                    self.dropped_repeats += 1;
                }
                _ => {
                    self.previous.clone_from(&self.row);
                    return Ok(Some(&self.previous));
                }
            }
        }
    }

    /// Appends up to `most` rows to the columns; the number of rows appended.
    pub fn append_to(&mut self, columns: &mut [Vec<f64>], most: usize) -> Result<usize, LogError> {
        for count in 0..most {
            let Some(row) = self.advance()? else { return Ok(count) };
            columns.iter_mut().zip(row).for_each(|(column, &value)| column.push(value));
        }
        Ok(most)
    }

    /// All rows left, or evenly spread stretches of them where there are more than `most_rows`, by columns in the order of the header.
    pub fn into_columns(mut self, most_rows: Option<usize>) -> Result<(LogColumns, CsvEnd), LogError> {
        let mut columns = vec![Vec::new(); self.layout.columns.len()];
        let mut stretches = Stretches::of(most_rows);
        while self.append_to(&mut columns, ROWS_PER_GROUP)? == ROWS_PER_GROUP {
            stretches.thin(&mut columns);
        }
        stretches.thin(&mut columns);
        columns.iter_mut().for_each(Vec::shrink_to_fit);
        self.warnings.extend(stretches.remark());
        Ok((self.header.assemble(columns), self.end()))
    }

    /// The log, whole or in stretches.
    pub fn into_log(self, most_rows: Option<usize>) -> Result<(RobotLog, LogSummary), LogError> {
        let (path, format) = (self.path, self.format);
        let (mut columns, mut end) = self.into_columns(most_rows)?;
        if columns.dq_rad_s.is_empty() {
            end.warnings.push(differentiate(&mut columns));
        }
        let log = columns.validate().map_err(|error| error.in_file(path))?;
        let mut summary = LogSummary::new(format, &log, end.dropped_repeats, end.unknown);
        summary.warnings.extend(end.warnings);
        Ok((log, summary))
    }

    /// What to say about the file once it is read.
    pub fn end(self) -> CsvEnd {
        let mut warnings = self.warnings;
        warnings.extend(self.lines.cut_off());
        CsvEnd { dropped_repeats: self.dropped_repeats, unknown: self.header.unknown, warnings }
    }
}

/// What there is to say about a CSV file besides its rows.
pub(crate) struct CsvEnd {
    pub dropped_repeats: usize,
    pub unknown: Vec<String>,
    pub warnings: Vec<String>,
}
