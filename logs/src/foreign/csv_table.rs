//! Text tables of other programs: commas, semicolons, tabulators or spaces; with or without a header.
//!
//! ```text
//! # comment lines           before the header; the last of them is the header where numbers follow (numpy.savetxt)
//! names                     where the first line has a number, there are none: column_1, column_2, …
//! units                     a second line of units alone
//! rows                      an empty cell, `nan`, `NaN` and `null` are not there; decimal commas where the comma is no separator
//! ```
//!
//! A line of `ros2 topic echo --csv` of a `sensor_msgs/JointState` has no header and is known by its shape: two stamps, a frame, N names,
//! 3 N numbers. Leaves out: dates, and decimal commas between commas, where nobody knows which is which.

use std::ops::Range;

use tribo_files::csv_lines::{Lines, split_cells};
use tribo_files::{LogError, LogFile};

use super::table::{Cells, Column, ForeignTable, Kind, LARGE, Loaded};
use super::unit::spelled;
use crate::format::LogFormat;

/// Separators, in the order in which they are tried.
const DELIMITERS: [u8; 4] = [b';', b'\t', b',', b' '];

/// The most columns of a table.
const MOST_COLUMNS: usize = 1 << 12;

/// Lines before the header that are looked over.
const MOST_COMMENTS: u64 = 1000;

/// A text table, header read.
pub(crate) struct CsvTable<'f, 'p> {
    file: &'f LogFile<'p>,
    columns: Vec<Column>,
    left_out: Vec<String>,
    delimiter: u8,
    /// Line of the first row, from 1.
    first_row: u64,
    /// Whether it is packed with gzip.
    packed: bool,
}

impl<'f, 'p> CsvTable<'f, 'p> {
    /// Reads the beginning of a file; `None` where it is no table of numbers.
    pub fn open(file: &'f LogFile<'p>) -> Result<Option<Self>, LogError> {
        let (reader, packed) = file.open_text("log")?;
        let mut lines = Lines::new(reader, file.path);
        let (mut comment, mut head): (Option<String>, Option<(String, u64)>) = (None, None);
        while head.is_none() {
            if !lines.advance()? || lines.number > MOST_COMMENTS {
                return Ok(None);
            }
            let Ok(text) = std::str::from_utf8(lines.text()) else { return Ok(None) };
            match text.strip_prefix('#') {
                Some(rest) => comment = Some(rest.trim().to_owned()),
                None => head = Some((text.to_owned(), lines.number)),
            }
        }
        let Some((first, mut first_row)) = head else { return Ok(None) };
        let mut after = Vec::new();
        while after.len() < 2 && lines.advance()? {
            let Ok(text) = std::str::from_utf8(lines.text()) else { break };
            after.push((text.to_owned(), lines.number));
        }

        // The separator is the one by which the lines have as many cells.
        let count = |text: &str, delimiter: u8| cells_of(text, delimiter).map_or(0, |cells| cells.len());
        let second = after.first().map(|(text, _)| text.as_str());
        let fits = |&&delimiter: &&u8| {
            let cells = count(&first, delimiter);
            cells >= 2 && second.is_none_or(|second| count(second, delimiter) == cells)
        };
        let loose = |&&delimiter: &&u8| delimiter != b' ' && count(&first, delimiter) >= 2;
        let Some(&delimiter) = DELIMITERS.iter().find(fits).or_else(|| DELIMITERS.iter().find(loose)) else {
            return Ok(None);
        };
        let Some(cells) = cells_of(&first, delimiter) else { return Ok(None) };
        if cells.len() > MOST_COLUMNS {
            return Ok(None);
        }

        // Which line names the columns.
        let numeric = |cell: &String| is_missing(cell) || number(cell, delimiter).is_some();
        let bare = cells.iter().any(|cell| number(cell, delimiter).is_some());
        let mut names = cells.clone();
        let mut sample = after.first().and_then(|(text, _)| cells_of(text, delimiter));
        let mut units = None;
        if bare {
            sample = Some(cells.clone());
            let comment = comment.as_deref().and_then(|text| cells_of(text, delimiter));
            names = match (comment.filter(|names| names.len() == cells.len()), joint_state(&cells, delimiter)) {
                (Some(names), _) => names,
                (None, Some(names)) => names,
                (None, None) => (1..=cells.len()).map(|column| format!("column_{column}")).collect(),
            };
        } else {
            first_row = after.first().map_or(first_row + 1, |(_, line)| *line);
            let all_units = |cells: &Vec<String>| {
                let known = |cell: &String| cell.is_empty() || spelled(bracketless(cell)).is_some();
                cells.iter().all(known) && cells.iter().any(|cell| !cell.is_empty())
            };
            if let (Some(row), Some((text, line))) = (sample.as_ref().filter(|row| all_units(row)), after.get(1)) {
                units = Some(row.clone());
                first_row = *line;
                sample = cells_of(text, delimiter);
            }
        }
        let Some(sample) = sample else { return Ok(None) };
        let decimal_commas = delimiter == b','
            && sample.len() > names.len()
            && sample.iter().all(|cell| numeric(cell) && !cell.contains('.'));
        if decimal_commas {
            let detail = format!(
                "{} cells under {} names: decimal commas between commas cannot be told apart; export with semicolons or decimal points",
                sample.len(),
                names.len()
            );
            return Err(LogError::BadLine { path: file.path.to_path_buf(), line: first_row, detail });
        }
        if !sample.iter().any(|cell| number(cell, delimiter).is_some()) {
            return Ok(None);
        }
        let mut columns = Vec::new();
        for (index, name) in names.iter().enumerate() {
            let name = name.trim().trim_start_matches('#').trim();
            let kind = if sample.get(index).is_none_or(numeric) { Kind::Number } else { Kind::Text };
            let unit = units.as_ref().and_then(|units| spelled(bracketless(units.get(index)?))).map(|(unit, _)| unit);
            columns.push(Column { unit, ..Column::new(name, kind) });
        }
        Ok(Some(Self { file, columns, left_out: Vec::new(), delimiter, first_row, packed }))
    }
}

impl ForeignTable for CsvTable<'_, '_> {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn left_out(&self) -> &[String] {
        &self.left_out
    }

    fn format(&self) -> LogFormat {
        if self.packed { LogFormat::TableGz } else { LogFormat::Table }
    }

    fn load(&self, wanted: &[usize]) -> Result<Loaded, LogError> {
        let (reader, _) = self.file.open_text("CSV")?;
        let mut lines = Lines::new(reader, self.file.path);
        let mut loaded = Loaded {
            cells: wanted
                .iter()
                .map(|&column| if self.columns[column].kind == Kind::Text { Cells::text() } else { Cells::numbers() })
                .collect(),
            ..Loaded::default()
        };
        let mut cells = Vec::new();
        let (mut point, mut comma) = (None, None);
        let mut begun = vec![false; wanted.len()];
        while lines.advance()? {
            if lines.number < self.first_row || lines.text().starts_with(b"#") {
                continue;
            }
            if !split_line(lines.text(), self.delimiter, &mut cells) {
                return Err(lines.bad_line("a quote is not closed"));
            }
            if cells.len() != self.columns.len() {
                let (path, line) = (self.file.path.to_path_buf(), lines.number);
                return Err(LogError::CellCount { path, line, got: cells.len(), expected: self.columns.len() });
            }
            for ((&column, into), begun) in wanted.iter().zip(&mut loaded.cells).zip(&mut begun) {
                let cell = &lines.text()[cells[column].clone()];
                let bad = || lines.bad_cell(&self.columns[column].name, cell);
                let text = std::str::from_utf8(cell).map_err(|_| bad())?;
                match into {
                    Cells::Numbers { base, values } => {
                        let value = if is_missing(text) {
                            f64::NAN
                        } else {
                            if self.delimiter != b',' {
                                point = point.or(text.contains('.').then_some(lines.number));
                                comma = comma.or(text.contains(',').then_some(lines.number));
                            }
                            exact(text, self.delimiter, base, !std::mem::replace(begun, true)).ok_or_else(bad)?
                        };
                        values.push(value);
                    }
                    Cells::Text { .. } => {
                        if !into.push_label(text) {
                            return Err(
                                lines.bad_line(format!("column {} names too many joints", self.columns[column].name))
                            );
                        }
                    }
                }
            }
            loaded.lines.push(u32::try_from(lines.number).unwrap_or(u32::MAX));
        }
        if let (Some(point), Some(comma)) = (point, comma) {
            let detail = format!(
                "a decimal point in line {point} and a comma in line {comma}: thousands or decimals? Export with decimal points alone"
            );
            return Err(LogError::BadLine { path: self.file.path.to_path_buf(), line: point.max(comma), detail });
        }
        loaded.warnings.extend(lines.cut_off());
        Ok(loaded)
    }
}

/// The unit of a line of units: `[deg]`, `(ms)` or bare.
fn bracketless(text: &str) -> &str {
    text.trim_matches(['[', ']', '(', ')', ' '])
}

fn is_missing(cell: &str) -> bool {
    matches!(cell, "" | "nan" | "NaN" | "NAN" | "null" | "-nan")
}

/// A finite number.
fn number(cell: &str, delimiter: u8) -> Option<f64> {
    tribo_files::csv_lines::parse_number(cell.as_bytes(), delimiter)
}

/// A cell less the base of its column; the first cell decides whether there is one.
fn exact(text: &str, delimiter: u8, base: &mut i64, first: bool) -> Option<f64> {
    let value = number(text, delimiter)?;
    let (whole, fraction) = match text.split_once(['.', ',']) {
        Some((whole, fraction)) => (whole, fraction),
        None => (text, ""),
    };
    let digits = fraction.bytes().all(|byte| byte.is_ascii_digit());
    let whole: Option<i64> = whole.parse().ok().filter(|_| digits);
    if let (true, Some(whole)) = (first, whole.filter(|whole| whole.unsigned_abs() >= LARGE)) {
        *base = whole;
    }
    if *base == 0 {
        return Some(value);
    }
    let Some(difference) = whole.and_then(|whole| whole.checked_sub(*base)) else {
        return Some(value - *base as f64);
    };
    let fraction: f64 = if fraction.is_empty() { 0.0 } else { format!("0.{fraction}").parse().ok()? };
    Some(difference as f64 + if text.starts_with('-') { -fraction } else { fraction })
}

/// The names of a line of `ros2 topic echo --csv` of a JointState.
fn joint_state(cells: &[String], delimiter: u8) -> Option<Vec<String>> {
    let joints = cells.len().checked_sub(3).filter(|rest| rest % 4 == 0).map(|rest| rest / 4)?;
    let is_number = |cell: &String| number(cell, delimiter).is_some();
    let (stamps, named) = (&cells[..2], &cells[3..3 + joints]);
    let shaped = stamps.iter().all(is_number) && named.iter().all(|cell| !cell.is_empty() && !is_number(cell));
    if !shaped || joints == 0 || !cells[3 + joints..].iter().all(is_number) {
        return None;
    }
    let mut names: Vec<String> =
        ["header.stamp.sec", "header.stamp.nanosec", "header.frame_id"].map(str::to_owned).into();
    for array in ["name", "position", "velocity", "effort"] {
        names.extend((0..joints).map(|joint| format!("{array}[{joint}]")));
    }
    Some(names)
}

fn cells_of(text: &str, delimiter: u8) -> Option<Vec<String>> {
    let mut cells = Vec::new();
    split_line(text.as_bytes(), delimiter, &mut cells)
        .then(|| cells.into_iter().map(|cell| text[cell].to_owned()).collect())
}

/// Splits at the separator; spaces count as one however many there are.
fn split_line(line: &[u8], delimiter: u8, cells: &mut Vec<Range<usize>>) -> bool {
    if delimiter != b' ' {
        return split_cells(line, delimiter, cells);
    }
    cells.clear();
    let mut start = None;
    for (at, byte) in line.iter().enumerate() {
        match (byte.is_ascii_whitespace(), start) {
            (true, Some(begun)) => {
                cells.push(begun..at);
                start = None;
            }
            (false, None) => start = Some(at),
            _ => {}
        }
    }
    cells.extend(start.map(|begun| begun..line.len()));
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_stamps_keep_their_last_digit() {
        let mut base = 0;
        assert_eq!(exact("1700000000123456789", b',', &mut base, true), Some(0.0));
        assert_eq!(exact("1700000000123456790", b',', &mut base, false), Some(1.0));
        let mut base = 0;
        let first = exact("1700000000.123456789", b',', &mut base, true).unwrap();
        let second = exact("1700000000.123456790", b',', &mut base, false).unwrap();
        assert!((second - first - 1e-9).abs() < 1e-15);
        let mut base = 0;
        assert_eq!(exact("0,5", b';', &mut base, true), Some(0.5));
        assert_eq!((exact("-1.5", b',', &mut base, false), base), (Some(-1.5), 0));
    }
}
