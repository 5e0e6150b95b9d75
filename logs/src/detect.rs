//! Which format a path holds, from its content; the extension plays no part.
//!
//! | content | format |
//! |---|---|
//! | directory with the four `exciting_traj_*.txt` | [`LogFormat::PandaGaz`] |
//! | MCAP magic, or a directory with one `.mcap` file (rosbag2) | [`LogFormat::Mcap`] |
//! | `PAR1` | [`LogFormat::Parquet`] |
//! | text, or gzip of text, whose first line names `state.q[0]`, or `sent commands` | [`LogFormat::Libfranka`] |
//! | text whose first line names at least one canonical column | [`LogFormat::Csv`] |
//! | gzip of such text | [`LogFormat::CsvGz`] |
//! | text, or gzip of text, whose first line names `Time`, `Position1`, `TorqueSm1` and `TorqueCur1` | [`LogFormat::KinovaGen3`] |

use std::path::{Path, PathBuf};

use bytes::Bytes;

use crate::canonical_csv::canonical;
use crate::csv_lines::{BYTE_ORDER_MARK, header_names};
use crate::error::{LogError, shown};
use crate::format::LogFormat;
use crate::kinova_gen3::{is_kinova_gen3, kinova_gen3};
use crate::libfranka::{is_libfranka, libfranka_rows};
use crate::log::RobotLog;
use crate::mcap_log::{MCAP_MAGIC, mcap};
use crate::panda_gaz::{is_panda_gaz, read_panda_gaz};
use crate::parquet_log::parquet;
use crate::quantity::Quantity;
use crate::source::{LogFile, peek};
use crate::summary::LogSummary;

/// Tells the format of a file or directory.
///
/// # Errors
/// [`LogError::NotFound`], [`LogError::Io`], [`LogError::Empty`], [`LogError::Corrupt`] for damaged gzip,
/// [`LogError::UnknownFormat`].
pub fn detect(path: impl AsRef<Path>) -> Result<LogFormat, LogError> {
    let path = path.as_ref();
    if path.is_dir() {
        if is_panda_gaz(path) {
            return Ok(LogFormat::PandaGaz);
        }
        return bag_file(path)?
            .map(|_| LogFormat::Mcap)
            .ok_or_else(|| unknown(path, "a directory without exciting_traj_time.txt and without .mcap".to_owned()));
    }
    format_of(&LogFile::new(path))
}

/// The format of one file.
fn format_of(file: &LogFile) -> Result<LogFormat, LogError> {
    let path = file.path;
    let (mut reader, packed) = file.open_text("log")?;
    let start = peek(path, &mut *reader)?;
    match start {
        [] => Err(LogError::Empty { path: path.to_path_buf() }),
        [b'P', b'A', b'R', b'1', ..] if !packed => Ok(LogFormat::Parquet),
        start if start.starts_with(&MCAP_MAGIC) && !packed => Ok(LogFormat::Mcap),
        start if start.starts_with(b"SQLite format 3") => {
            Err(unknown(path, "an SQLite database; `ros2 bag convert` makes MCAP of a bag".to_owned()))
        }
        _ => match header_of(start) {
            Some(names) if is_libfranka(&names) => Ok(LogFormat::Libfranka),
            Some(names) if names.iter().any(|name| Quantity::from_column_name(name).is_some()) => {
                Ok(if packed { LogFormat::CsvGz } else { LogFormat::Csv })
            }
            Some(names) if is_kinova_gen3(&names) => Ok(LogFormat::KinovaGen3),
            _ => Err(unknown(path, format!("starts with `{}`", shown(start)))),
        },
    }
}

/// Reads a log of any known format.
///
/// # Errors
/// Those of [`detect`] and of the reader of the format.
pub fn read_log(path: impl AsRef<Path>) -> Result<(RobotLog, LogSummary), LogError> {
    read_log_watched(path, |_| true)
}

/// Reads a log of any known format. `hear` is told the part that has been read, 0 to 1, after each megabyte (Parquet: each column), and
/// stops by saying false.
///
/// # Errors
/// Those of [`read_log`]; [`LogError::Stopped`].
pub fn read_log_watched(
    path: impl AsRef<Path>,
    hear: impl Fn(f64) -> bool + 'static,
) -> Result<(RobotLog, LogSummary), LogError> {
    let path = path.as_ref();
    let format = detect(path)?;
    let bag = if format == LogFormat::Mcap { bag_file(path)? } else { None };
    let file = LogFile::new(bag.as_deref().unwrap_or(path)).watched(hear);
    let read = read_as(&file, format);
    if file.stopped() { Err(LogError::Stopped { path: path.to_path_buf() }) } else { read }
}

/// Reads a log that is in memory, in any known format of one file; `name` is what errors call it.
///
/// # Errors
/// As [`read_log`].
pub fn read_log_from(bytes: impl Into<Bytes>, name: &Path) -> Result<(RobotLog, LogSummary), LogError> {
    let file = LogFile::in_memory(bytes.into(), name);
    read_as(&file, format_of(&file)?)
}

fn read_as(file: &LogFile, format: LogFormat) -> Result<(RobotLog, LogSummary), LogError> {
    match format {
        LogFormat::Csv | LogFormat::CsvGz => canonical(file),
        LogFormat::Parquet => parquet(file),
        LogFormat::PandaGaz => read_panda_gaz(file.path),
        LogFormat::KinovaGen3 => kinova_gen3(file),
        LogFormat::Libfranka => libfranka_rows(file)?.into_log(),
        LogFormat::Mcap => mcap(file),
    }
}

/// The one MCAP file of a rosbag2 directory.
fn bag_file(directory: &Path) -> Result<Option<PathBuf>, LogError> {
    if !directory.is_dir() {
        return Ok(None);
    }
    let entries = std::fs::read_dir(directory).map_err(|source| LogError::io(directory, "open", source))?;
    let is_mcap = |path: &PathBuf| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"));
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_mcap).collect();
    if files.len() > 1 {
        return Err(unknown(directory, format!("a directory with {} MCAP files; name one of them", files.len())));
    }
    Ok(files.pop())
}

/// The cells of the first line with content, if it can be a header.
fn header_of(start: &[u8]) -> Option<Vec<String>> {
    let start = start.strip_prefix(BYTE_ORDER_MARK).unwrap_or(start);
    let first_line = start.split(|&b| b == b'\n').find(|line| !line.trim_ascii().is_empty())?;
    header_names(first_line.trim_ascii()).map(|(names, _)| names)
}

fn unknown(path: &Path, found: String) -> LogError {
    LogError::UnknownFormat { path: path.to_path_buf(), found }
}
