//! What reading a log found: size, rate, gaps, columns, and everything that was dropped or not understood.

use std::fmt;

use tribo_files::{ROWS_PER_GROUP, visible};

use crate::bursts::{GAP_TOLERANCE, bursts, median_period_s};
use crate::foreign::{MappedColumn, Mapping};
use crate::format::LogFormat;
use crate::log::RobotLog;
use crate::quantity::Quantity;
use crate::recognise::{Remark, recognise};

/// Evidence about a log that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct LogSummary {
    /// Format of the file.
    pub format: LogFormat,
    /// Number of joints.
    pub joints: usize,
    /// Rows of the log.
    pub rows: usize,
    /// Rows of the file that repeated the row before and are not in the log.
    pub dropped_repeats: usize,
    /// Rows of the file that lack a measurement the other rows have, and are not in the log.
    pub dropped_incomplete: usize,
    /// First to last stamp (s).
    pub duration_s: f64,
    /// One over the median period (Hz).
    pub rate_hz: f64,
    /// Number of bursts at the default tolerance of [`GAP_TOLERANCE`] median periods.
    pub bursts: usize,
    /// Longest time between neighbouring rows (s).
    pub longest_gap_s: f64,
    /// Quantities the log has.
    pub present: Vec<Quantity>,
    /// Optional quantities it lacks.
    pub missing: Vec<Quantity>,
    /// Jumps of a whole turn that were taken out of joint positions.
    pub unwrapped_jumps: usize,
    /// Columns of the file that are not canonical and were ignored.
    pub unknown_columns: Vec<String>,
    /// Where the rows come from inside the file, where it holds several things: topic, joints, clock, alternatives.
    pub source: Option<String>,
    /// Which columns of a table of another program became which; `None` where the file has our names or those of a known format.
    pub mapping: Option<Mapping>,
    /// Suspicions, in words, such as a last line without line ending.
    pub warnings: Vec<String>,
    /// What the first 65 536 rows say is wrong with the log: what one that is read in batches is judged by.
    pub remarks: Vec<Remark>,
}

impl LogSummary {
    /// Describes a log just read.
    pub(crate) fn new(format: LogFormat, log: &RobotLog, dropped_repeats: usize, unknown_columns: Vec<String>) -> Self {
        let present = Quantity::ALL.into_iter().filter(|&quantity| log.has(quantity)).collect();
        let summary = Self::of_rows(format, log.joints(), &log.time_s, present, dropped_repeats, unknown_columns);
        let beginning = (log.rows() > ROWS_PER_GROUP).then(|| log.slice(0..ROWS_PER_GROUP).ok()).flatten();
        Self { remarks: recognise(beginning.as_ref().unwrap_or(log)), ..summary }
    }

    /// Describes a log of which only the stamps are at hand.
    pub(crate) fn of_rows(
        format: LogFormat,
        joints: usize,
        time_s: &[f64],
        present: Vec<Quantity>,
        dropped_repeats: usize,
        unknown_columns: Vec<String>,
    ) -> Self {
        let duration_s = time_s.last().zip(time_s.first()).map_or(0.0, |(last, first)| last - first);
        let rate_hz = median_period_s(time_s).map_or(0.0, f64::recip);
        Self {
            format,
            joints,
            rows: time_s.len(),
            dropped_repeats,
            dropped_incomplete: 0,
            duration_s,
            rate_hz,
            bursts: bursts(time_s, GAP_TOLERANCE).len(),
            longest_gap_s: time_s.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max),
            missing: Quantity::ALL.into_iter().filter(|quantity| !present.contains(quantity)).collect(),
            present,
            unwrapped_jumps: 0,
            unknown_columns,
            source: None,
            mapping: None,
            warnings: Vec::new(),
            remarks: Vec::new(),
        }
    }

    /// Rows of the file, dropped ones included.
    #[must_use]
    pub fn rows_read(&self) -> usize {
        self.rows + self.dropped_repeats + self.dropped_incomplete
    }
}

impl fmt::Display for LogSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |quantities: &[Quantity]| quantities.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        writeln!(f, "format       {}", self.format)?;
        if let Some(source) = &self.source {
            writeln!(f, "source       {source}")?;
        }
        if let Some(mapping) = &self.mapping {
            writeln!(f, "read as      {mapping}")?;
            for quantity in self.present.iter() {
                let of = |column: &&MappedColumn| {
                    Quantity::from_column_name(&column.column).is_some_and(|(q, _)| q == *quantity)
                };
                let from: Vec<&str> = mapping.columns.iter().filter(of).map(|column| column.from.as_str()).collect();
                if let (Some(first), false) = (mapping.columns.iter().find(of), from.is_empty()) {
                    writeln!(f, "  {:<10} {} [{}]", quantity.label(), from.join(", "), first.unit)?;
                }
            }
        }
        writeln!(f, "joints       {}", self.joints)?;
        write!(f, "rows         {} ({} repeated rows dropped", self.rows, self.dropped_repeats)?;
        if self.dropped_incomplete > 0 {
            write!(f, ", {} incomplete", self.dropped_incomplete)?;
        }
        writeln!(f, ")")?;
        writeln!(f, "duration     {:.3} s at {:.1} Hz", self.duration_s, self.rate_hz)?;
        writeln!(f, "bursts       {} (longest gap {:.2} ms)", self.bursts, 1e3 * self.longest_gap_s)?;
        write!(f, "columns      {}", list(&self.present))?;
        if !self.missing.is_empty() {
            write!(f, "\nabsent       {}", list(&self.missing))?;
        }
        if self.unwrapped_jumps > 0 {
            write!(f, "\nunwrapped    {} jumps of a turn in q_i", self.unwrapped_jumps)?;
        }
        if !self.unknown_columns.is_empty() {
            write!(
                f,
                "\nnot known    {}",
                self.unknown_columns.iter().map(|name| visible(name)).collect::<Vec<_>>().join(", ")
            )?;
        }
        for warning in &self.warnings {
            write!(f, "\nwarning      {warning}")?;
        }
        for remark in &self.remarks {
            write!(f, "\nwarning      {remark}")?;
        }
        Ok(())
    }
}
