//! Which format a path holds, from its content; the extension plays no part.
//!
//! | content | format |
//! |---|---|
//! | directory with the four `exciting_traj_*.txt` | [`LogFormat::PandaGaz`] |
//! | MCAP magic, or a directory with one `.mcap` file (rosbag2) | [`LogFormat::Mcap`] |
//! | SQLite magic, or a directory with one `.db3` file (rosbag2) | [`LogFormat::Bag`] |
//! | zip with arrays of NumPy, or one structured array | [`LogFormat::Numpy`] |
//! | `PAR1` | [`LogFormat::Parquet`] |
//! | text, or gzip of text, whose first line names `state.q[0]`, or `sent commands` | [`LogFormat::Libfranka`] |
//! | text whose first line names at least one canonical column | [`LogFormat::Csv`] |
//! | gzip of such text | [`LogFormat::CsvGz`] |
//! | text, or gzip of text, whose first line names `Time`, `Position1`, `TorqueSm1` and `TorqueCur1` | [`LogFormat::KinovaGen3`] |
//! | other text of lines with equally many cells, one of them a number | [`LogFormat::Table`], [`LogFormat::TableGz`] |

use std::path::{Path, PathBuf};
use std::rc::Rc;

use bytes::Bytes;
use tribo_files::csv_lines::{BYTE_ORDER_MARK, header_names};
use tribo_files::{LogError, LogFile, peek, shown};

use crate::arm_rows::Wanted;
use crate::bag_log::{SQLITE_MAGIC, bag};
use crate::canonical_csv::canonical;
use crate::foreign::{ColumnMap, NPY_MAGIC, ZIP_MAGIC, foreign, instead, is_text_table};
use crate::format::LogFormat;
use crate::kinova_gen3::{is_kinova_gen3, kinova_gen3};
use crate::libfranka::{is_libfranka, libfranka_rows};
use crate::log::RobotLog;
use crate::mcap_log::{MCAP_MAGIC, mcap};
use crate::panda_gaz::{is_panda_gaz, read_panda_gaz};
use crate::parquet_log::parquet;
use crate::quantity::Quantity;
use crate::read_options::ReadOptions;
use crate::stretches::Stretches;
use crate::summary::LogSummary;

/// Tells the format of a file or directory.
///
/// # Errors
/// [`LogError::NotFound`], [`LogError::Io`], [`LogError::Empty`], [`LogError::Corrupt`] for damaged gzip,
/// [`LogError::UnknownFormat`].
pub fn detect(path: impl AsRef<Path>) -> Result<LogFormat, LogError> {
    detect_at(path.as_ref())
}

fn detect_at(path: &Path) -> Result<LogFormat, LogError> {
    if path.is_dir() {
        if is_panda_gaz(path) {
            return Ok(LogFormat::PandaGaz);
        }
        return match bag_file(path)? {
            Some(bag) if is_of(&bag, SQLITE_ENDING) => Ok(LogFormat::Bag),
            Some(_) => Ok(LogFormat::Mcap),
            None => {
                let found = "a directory without exciting_traj_time.txt and without .mcap or .db3".to_owned();
                Err(unknown(path, found))
            }
        };
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
        start if start.starts_with(SQLITE_MAGIC) && !packed => Ok(LogFormat::Bag),
        start if (start.starts_with(ZIP_MAGIC) || start.starts_with(NPY_MAGIC)) && !packed => Ok(LogFormat::Numpy),
        _ => match header_of(start) {
            Some(names) if is_libfranka(&names) => Ok(LogFormat::Libfranka),
            Some(names) if names.iter().any(|name| Quantity::from_column_name(name).is_some()) => {
                Ok(if packed { LogFormat::CsvGz } else { LogFormat::Csv })
            }
            Some(names) if is_kinova_gen3(&names) => Ok(LogFormat::KinovaGen3),
            _ => {
                let found = format!("starts with `{}`", shown(start));
                if is_text_table(file)? {
                    Ok(if packed { LogFormat::TableGz } else { LogFormat::Table })
                } else {
                    Err(unknown(path, found))
                }
            }
        },
    }
}

/// Reads a log of any known format.
///
/// # Errors
/// Those of [`detect`] and of the reader of the format.
pub fn read_log(path: impl AsRef<Path>) -> Result<(RobotLog, LogSummary), LogError> {
    read(path, &ReadOptions::default())
}

/// Reads a log of any known format, or of another program by a map of its columns; without one, by what their names say
/// ([`LogSummary::mapping`] tells).
///
/// # Errors
/// Those of [`detect`] and of the reader of the format; [`LogError::NotRead`] where a map does not fit the file, or where its names leave open what
/// is what, with its columns and a map that would do.
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<(RobotLog, LogSummary), LogError> {
    read_watched(path, options, |_| true)
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
    read_watched(path, &ReadOptions::default(), hear)
}

/// As [`read()`], heard by `hear` as in [`read_log_watched`].
///
/// # Errors
/// Those of [`read()`]; [`LogError::Stopped`].
pub fn read_watched(
    path: impl AsRef<Path>,
    options: &ReadOptions,
    hear: impl Fn(f64) -> bool + 'static,
) -> Result<(RobotLog, LogSummary), LogError> {
    read_heard(path.as_ref(), options, Rc::new(hear))
}

/// As [`read_watched`], compiled once.
pub(crate) fn read_heard(
    path: &Path,
    options: &ReadOptions,
    hear: Rc<dyn Fn(f64) -> bool>,
) -> Result<(RobotLog, LogSummary), LogError> {
    let format = detect(path)?;
    let bag = if matches!(format, LogFormat::Mcap | LogFormat::Bag) { bag_file(path)? } else { None };
    let file = LogFile::new(bag.as_deref().unwrap_or(path)).watched(hear);
    let read = read_as(&file, format, options);
    if file.stopped() { Err(LogError::Stopped { path: path.to_path_buf() }) } else { read }
}

/// Reads a log that is in memory, in any known format of one file; `name` is what errors call it.
///
/// # Errors
/// As [`read_log`].
pub fn read_log_from(bytes: impl Into<Bytes>, name: &Path) -> Result<(RobotLog, LogSummary), LogError> {
    read_from(bytes, name, &ReadOptions::default())
}

/// As [`read()`], of a log in memory; `name` is what errors call it.
///
/// # Errors
/// As [`read()`].
pub fn read_from(
    bytes: impl Into<Bytes>,
    name: &Path,
    options: &ReadOptions,
) -> Result<(RobotLog, LogSummary), LogError> {
    let file = LogFile::in_memory(bytes.into(), name);
    read_as(&file, format_of(&file)?, options)
}

fn read_as(file: &LogFile, format: LogFormat, options: &ReadOptions) -> Result<(RobotLog, LogSummary), LogError> {
    let ReadOptions { map, joints, most_rows } = options;
    let (log, mut summary) = match (format, map.as_ref()) {
        (LogFormat::Mcap | LogFormat::Bag, map) => {
            let wanted = wanted_of_bag(file, map, joints)?;
            if format == LogFormat::Mcap { mcap(file, wanted) } else { bag(file, wanted) }
        }
        (LogFormat::Table | LogFormat::TableGz | LogFormat::Numpy, map) => foreign(file, format, map, joints),
        (LogFormat::PandaGaz, Some(_)) => {
            let detail = "its files have no names of columns for a map".to_owned();
            Err(LogError::NotRead { path: file.path.to_path_buf(), detail })
        }
        (_, Some(map)) => foreign(file, format, Some(map), joints),
        (LogFormat::Csv | LogFormat::CsvGz, None) => {
            canonical(file, *most_rows).or_else(|error| instead(file, format, joints, error))
        }
        (LogFormat::Parquet, None) => parquet(file).or_else(|error| instead(file, format, joints, error)),
        (LogFormat::PandaGaz, None) => read_panda_gaz(file.path),
        (LogFormat::KinovaGen3, None) => kinova_gen3(file),
        (LogFormat::Libfranka, None) => libfranka_rows(file)?.into_log(*most_rows),
    }?;
    let mut stretches = Stretches::of(*most_rows);
    let Some(kept) = stretches.kept(&log.time_s) else { return Ok((log, summary)) };
    summary.warnings.extend(stretches.remark());
    let few = log.rows_where(&kept).map_err(|error| error.in_file(file.path))?;
    Ok((few, summary))
}

/// What a map says of a bag: the topic and the joints; its fields are known.
fn wanted_of_bag<'o>(file: &LogFile, map: Option<&'o ColumnMap>, joints: &'o [String]) -> Result<Wanted<'o>, LogError> {
    let Some(map) = map else { return Ok(Wanted { topic: None, joints }) };
    match map.of_bag() {
        Some((topic, named)) => Ok(Wanted { topic, joints: if named.is_empty() { joints } else { named } }),
        None => {
            let detail = "is a bag, whose messages name their fields: a map may say topic and joints alone".to_owned();
            Err(LogError::NotRead { path: file.path.to_path_buf(), detail })
        }
    }
}

/// The ending of a bag in SQLite.
const SQLITE_ENDING: &str = "db3";

fn is_of(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

/// The one file of a rosbag2 directory: MCAP, else SQLite.
fn bag_file(directory: &Path) -> Result<Option<PathBuf>, LogError> {
    if !directory.is_dir() {
        return Ok(None);
    }
    let entries = std::fs::read_dir(directory).map_err(|source| LogError::io(directory, "open", source))?;
    let all: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    for (ending, name) in [("mcap", "MCAP"), (SQLITE_ENDING, "SQLite")] {
        let mut files: Vec<&PathBuf> = all.iter().filter(|path| is_of(path, ending)).collect();
        if files.len() > 1 {
            return Err(unknown(directory, format!("a directory with {} {name} files; name one of them", files.len())));
        }
        if let Some(file) = files.pop() {
            return Ok(Some(file.clone()));
        }
    }
    Ok(None)
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
