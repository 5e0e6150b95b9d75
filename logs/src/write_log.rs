//! A log into a file of ours.

use std::io::{Seek, Write};
use std::path::Path;

use tribo_files::{CsvWriter, LogError, Output, TableWriter, failed, replace};

use crate::log::RobotLog;
use crate::mcap_write::McapWriter;
use crate::parquet_log::table_metadata;
use crate::quantity::Quantity;

/// What the columns of a CSV file are called.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ColumnNames {
    /// `q_0`, `O_F_ext_3`: what every command of ours and libfranka call them.
    #[default]
    Canonical,
    /// `/joint_0/q`, `/O_F_ext/moment/x`: viewers such as PlotJuggler make a tree of them.
    Tree,
}

/// The formats that can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogTarget {
    /// CSV, packed where the name ends in `.gz`.
    Csv(ColumnNames),
    /// Parquet.
    Parquet,
    /// MCAP.
    Mcap,
}

impl LogTarget {
    /// The endings that [`LogTarget::of_path`] knows.
    pub const ENDINGS: [&str; 4] = [".csv", ".csv.gz", ".parquet", ".mcap"];

    /// The format that follows from the ending of a file's name.
    #[must_use]
    pub fn of_path(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        match Self::ENDINGS.into_iter().find(|ending| name.ends_with(ending))? {
            ".parquet" => Some(Self::Parquet),
            ".mcap" => Some(Self::Mcap),
            _ => Some(Self::Csv(ColumnNames::Canonical)),
        }
    }
}

/// Writes a log. The file appears whole or not at all.
///
/// # Errors
/// Those of [`write_atomic`](tribo_files::write_atomic).
pub fn write_log(path: impl AsRef<Path>, log: &RobotLog, target: LogTarget) -> Result<(), LogError> {
    let path = path.as_ref();
    replace(path, |file| write_whole(file, path, log, target))
}

/// Writes a log to `out`, the same bytes as [`write_log`] to a file called `name`.
///
/// # Errors
/// What `out` refuses.
pub fn write_log_to(
    mut out: impl Write + Seek + Send,
    name: &Path,
    log: &RobotLog,
    target: LogTarget,
) -> Result<(), LogError> {
    write_whole(&mut out, name, log, target)
}

fn write_whole(out: &mut dyn Output, name: &Path, log: &RobotLog, target: LogTarget) -> Result<(), LogError> {
    let columns = log.named();
    let names: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
    let columns: Vec<&[f64]> = columns.iter().map(|&(_, column)| column).collect();
    let mut sink = Sink::new(out, name, &names, target)?;
    sink.write(&columns)?;
    sink.finish()
}

/// Writes a log as canonical CSV, gzip if the name ends in `.gz`. The file appears whole or not at all.
///
/// # Errors
/// Those of [`write_atomic`](tribo_files::write_atomic).
pub fn write_csv(path: impl AsRef<Path>, log: &RobotLog) -> Result<(), LogError> {
    write_log(path, log, LogTarget::Csv(ColumnNames::Canonical))
}

/// Writes a log as Parquet. The file appears whole or not at all.
///
/// # Errors
/// Those of [`write_atomic`](tribo_files::write_atomic).
pub fn write_parquet(path: impl AsRef<Path>, log: &RobotLog) -> Result<(), LogError> {
    write_log(path, log, LogTarget::Parquet)
}

/// Writes a log as MCAP. The file appears whole or not at all.
///
/// # Errors
/// Those of [`write_atomic`](tribo_files::write_atomic).
pub fn write_mcap(path: impl AsRef<Path>, log: &RobotLog) -> Result<(), LogError> {
    write_log(path, log, LogTarget::Mcap)
}

/// A file that takes batches of rows in canonical order.
pub(crate) struct Sink<'o, 'p> {
    format: SinkFormat<'o>,
    /// The name that errors show.
    path: &'p Path,
}

enum SinkFormat<'o> {
    Csv(CsvWriter<'o>),
    Parquet(TableWriter<'o>),
    Mcap(Box<McapWriter<'o>>),
}

impl<'o, 'p> Sink<'o, 'p> {
    /// Begins a file with these columns.
    pub fn new(out: &'o mut dyn Output, path: &'p Path, names: &[String], target: LogTarget) -> Result<Self, LogError> {
        let csv = |names: &[String], out| {
            CsvWriter::new(out, path, names).map(SinkFormat::Csv).map_err(|error| failed(path, "write", error))
        };
        let format = match target {
            LogTarget::Csv(ColumnNames::Canonical) => csv(names, out)?,
            LogTarget::Csv(ColumnNames::Tree) => {
                csv(&names.iter().map(|name| Quantity::tree_name(name)).collect::<Vec<_>>(), out)?
            }
            LogTarget::Parquet => SinkFormat::Parquet(TableWriter::new(out, path, names, &table_metadata())?),
            LogTarget::Mcap => SinkFormat::Mcap(Box::new(McapWriter::new(out, path, names)?)),
        };
        Ok(Self { format, path })
    }

    /// Appends rows, however many.
    pub fn write(&mut self, columns: &[&[f64]]) -> Result<(), LogError> {
        match &mut self.format {
            SinkFormat::Csv(csv) => csv.write(columns).map_err(|error| failed(self.path, "write", error)),
            SinkFormat::Parquet(table) => table.write(columns, self.path),
            SinkFormat::Mcap(mcap) => mcap.write(columns, self.path),
        }
    }

    /// Ends it.
    pub fn finish(self) -> Result<(), LogError> {
        match self.format {
            SinkFormat::Csv(csv) => csv.finish().map_err(|error| failed(self.path, "write", error)),
            SinkFormat::Parquet(table) => table.finish(self.path),
            SinkFormat::Mcap(mcap) => mcap.finish(self.path),
        }
    }
}
