//! Tables of other programs: columns under any names, in any of the usual units.
//!
//! ```text
//! file --open--> columns by name --map, or a proposal from the names--> plan --load--> cells --> log, and what became of which column
//! ```

mod assemble;
mod column_map;
mod csv_table;
mod map_yaml;
mod mapping;
mod npz;
mod parquet_columns;
mod plan;
mod propose;
mod select;
mod table;
mod unit;
mod words;

pub use column_map::ColumnMap;
pub use mapping::{MappedColumn, Mapping};
pub use unit::Unit;

pub(crate) use npz::{NPY_MAGIC, ZIP_MAGIC};

use csv_table::CsvTable;
use npz::NumpyFile;
use parquet_columns::ParquetColumns;
use propose::{Undecided, propose};
use select::listed;
use table::ForeignTable;
use tribo_files::{LogError, LogFile};

use crate::format::LogFormat;
use crate::log::RobotLog;
use crate::quantity::Quantity;
use crate::summary::LogSummary;

/// Whether a text file begins as a table of numbers.
pub(crate) fn is_text_table(file: &LogFile) -> Result<bool, LogError> {
    Ok(CsvTable::open(file)?.is_some())
}

/// Reads a table by a map, or by what its names say where there is none.
pub(crate) fn foreign(
    file: &LogFile,
    format: LogFormat,
    map: Option<&ColumnMap>,
    known: &[String],
) -> Result<(RobotLog, LogSummary), LogError> {
    let table = open(file, format)?;
    let given = map.cloned().unwrap_or_default();
    if given.is_complete() {
        return assemble::assemble(&*table, &given, false, known, file.path);
    }
    let known = if given.joints.is_empty() { known } else { &given.joints };
    let proposal = propose(table.columns(), known, &given).map_err(|undecided| refused(file, &*table, &undecided))?;
    assemble::assemble(&*table, &proposal.and(given.clone())?, true, known, file.path)
}

/// What the names of a file say where a reader of canonical columns gave up; its error where they say nothing either, or where columns of
/// the missing quantity are there in part.
pub(crate) fn instead(
    file: &LogFile,
    format: LogFormat,
    known: &[String],
    error: LogError,
) -> Result<(RobotLog, LogSummary), LogError> {
    let LogError::InFile { source, .. } = &error else { return Err(error) };
    let LogError::MissingColumns { missing, .. } = &**source else { return Err(error) };
    let table = open(file, format)?;
    let there: Vec<(Quantity, usize)> =
        table.columns().iter().filter_map(|column| Quantity::from_column_name(&column.name)).collect();
    let of_missing = |name: &String| Quantity::from_column_name(name).map(|(quantity, _)| quantity);
    let in_part = |quantity: Quantity| there.iter().any(|(found, _)| *found == quantity);
    // Columns counted from 1 are those of another program; counted from 0 they are ours, and some are missing.
    let from_one = !there.iter().any(|&(quantity, index)| quantity.is_per_joint() && index == 0);
    if !from_one && missing.iter().filter_map(of_missing).any(in_part) {
        return Err(error);
    }
    match propose(table.columns(), known, &ColumnMap::default()) {
        Ok(map) => assemble::assemble(&*table, &map, true, known, file.path),
        Err(_) if !from_one => Err(error),
        Err(undecided) => Err(refused(file, &*table, &undecided)),
    }
}

fn open<'f>(file: &'f LogFile, format: LogFormat) -> Result<Box<dyn ForeignTable + 'f>, LogError> {
    Ok(match format {
        LogFormat::Parquet => Box::new(ParquetColumns::open(file)?),
        LogFormat::Numpy => {
            let arrays = NumpyFile::open(file)?;
            if arrays.columns().is_empty() {
                let detail = "a zip without arrays of numbers that are as long as each other".to_owned();
                return Err(LogError::NotRead { path: file.path.to_path_buf(), detail });
            }
            Box::new(arrays)
        }
        _ => {
            let not_read = || LogError::NotRead {
                path: file.path.to_path_buf(),
                detail: "is no table that a column map could be held against (CSV, Parquet, npz)".to_owned(),
            };
            Box::new(CsvTable::open(file)?.ok_or_else(not_read)?)
        }
    })
}

/// The sentence that helps.
fn refused(file: &LogFile, table: &dyn ForeignTable, undecided: &Undecided) -> LogError {
    let detail = format!(
        "{}; columns: {}; say which is which: --map '{}'",
        undecided.why,
        listed(table.columns()),
        undecided.map
    );
    LogError::NotRead { path: file.path.to_path_buf(), detail }
}
