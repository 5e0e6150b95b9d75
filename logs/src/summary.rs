//! What reading a log found: size, rate, gaps, columns, and everything that was dropped or not understood.

use std::fmt;

use crate::bursts::{GAP_TOLERANCE, bursts, median_period_s};
use crate::format::LogFormat;
use crate::log::RobotLog;
use crate::quantity::Quantity;

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
    /// Columns of the file that are not canonical and were ignored.
    pub unknown_columns: Vec<String>,
    /// Suspicions, in words, such as a last line without line ending.
    pub warnings: Vec<String>,
}

impl LogSummary {
    /// Describes a log just read.
    pub(crate) fn new(format: LogFormat, log: &RobotLog, dropped_repeats: usize, unknown_columns: Vec<String>) -> Self {
        let (present, missing) = Quantity::ALL.into_iter().partition(|&quantity| log.has(quantity));
        Self {
            format,
            joints: log.joints(),
            rows: log.rows(),
            dropped_repeats,
            dropped_incomplete: 0,
            duration_s: log.duration_s(),
            rate_hz: median_period_s(&log.time_s).map_or(0.0, f64::recip),
            bursts: bursts(&log.time_s, GAP_TOLERANCE).len(),
            longest_gap_s: log.time_s.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max),
            present,
            missing,
            unknown_columns,
            warnings: Vec::new(),
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
        if !self.unknown_columns.is_empty() {
            write!(f, "\nnot known    {}", self.unknown_columns.join(", "))?;
        }
        for warning in &self.warnings {
            write!(f, "\nwarning      {warning}")?;
        }
        Ok(())
    }
}
