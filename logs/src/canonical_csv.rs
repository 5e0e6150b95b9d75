//! The canonical CSV log: its reader.
//!
//! ```text
//! time,q_0,…,dq_0,…,tau_J_0,…[,optional columns]      one header line, one line per row
//! ```
//!
//! Units as in [`Quantity`](crate::Quantity). Numbers are written in the shortest form that reads back to the same
//! bits, so a log written and read again is the same log. Reading accepts columns in any order, gzip, a byte-order
//! mark, CRLF, quotes, and semicolons with decimal point or comma; it refuses everything else with file and line.
//! Leaves out: repair. A row with an old stamp is an error, unless it repeats the row before exactly: then it is
//! dropped and counted.

use std::io::BufRead;
use std::path::Path;

use tribo_files::csv_lines::Lines;
use tribo_files::{LogError, LogFile};

use crate::csv_rows::{Clock, CsvRows};
use crate::format::LogFormat;
use crate::header::Header;
use crate::log::RobotLog;
use crate::summary::LogSummary;

/// Reads a canonical CSV file, plain or gzip.
///
/// # Errors
/// [`LogError`] naming the file and, where there is one, line, column and value.
pub fn read_csv(path: impl AsRef<Path>) -> Result<(RobotLog, LogSummary), LogError> {
    canonical(&LogFile::new(path.as_ref()), None)
}

/// Reads canonical CSV, plain or gzip; stretches of it where it has more than `most_rows`.
pub(crate) fn canonical(file: &LogFile, most_rows: Option<usize>) -> Result<(RobotLog, LogSummary), LogError> {
    let (reader, packed) = file.open_text("CSV")?;
    canonical_rows(reader, file.path, if packed { LogFormat::CsvGz } else { LogFormat::Csv })?.into_log(most_rows)
}

/// The rows of canonical CSV text, header read.
pub(crate) fn canonical_rows<R: BufRead>(
    reader: R,
    path: &Path,
    format: LogFormat,
) -> Result<CsvRows<'_, R>, LogError> {
    let mut lines = Lines::new(reader, path);
    let (names, delimiter) = lines.header()?;
    let header = Header::from_names(&names).map_err(|error| error.in_file(path))?;
    Ok(CsvRows::new(lines, path, format, &names, delimiter, header, Clock::Seconds))
}
