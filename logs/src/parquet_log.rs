//! A robot log as a Parquet table: the canonical columns by name, `schema = tribo.log/1` in the metadata.

use std::path::Path;

use tribo_files::{LogError, LogFile, Table, table_of};

use crate::differentiated::{differentiate, lacks_velocity};
use crate::format::LogFormat;
use crate::header::Header;
use crate::log::RobotLog;
use crate::quantity::Quantity;
use crate::summary::LogSummary;

/// Value of the metadata key `schema`.
const SCHEMA: &str = "tribo.log/1";

/// Reads a log from Parquet: columns in any order, unknown ones reported.
///
/// # Errors
/// Those of [`read_table`](tribo_files::read_table), and errors of the content with the file name.
pub fn read_parquet(path: impl AsRef<Path>) -> Result<(RobotLog, LogSummary), LogError> {
    parquet(&LogFile::new(path.as_ref()))
}

/// Reads a log from Parquet.
pub(crate) fn parquet(file: &LogFile) -> Result<(RobotLog, LogSummary), LogError> {
    let path = file.path;
    let canonical = |name: &str| Quantity::from_column_name(name).is_some();
    let mut table = table_of(file, &canonical)?;
    let skipped = std::mem::take(&mut table.skipped_columns);
    let names: Vec<String> = table.columns.iter().map(|(name, _)| name.clone()).collect();
    let (log, mut unknown) = log_of_table(table).map_err(|error| error.in_file(path))?;
    unknown.extend(skipped);
    let mut summary = LogSummary::new(LogFormat::Parquet, &log, 0, unknown);
    if !names.iter().any(|name| name == &Quantity::Velocity.column_name(0)) {
        summary.warnings.push("no dq_i: worked out from q_i".to_owned());
    }
    Ok((log, summary))
}

/// What the footer says of a log.
pub(crate) fn table_metadata() -> Vec<(String, String)> {
    vec![("schema".to_owned(), SCHEMA.to_owned())]
}

impl From<&RobotLog> for Table {
    fn from(log: &RobotLog) -> Self {
        let columns = log.named().into_iter().map(|(name, values)| (name, values.to_vec())).collect();
        Self { columns, metadata: table_metadata(), ..Self::default() }
    }
}

/// The log in a table, and the names of the columns that are not canonical.
///
/// # Errors
/// [`LogError::DuplicateColumn`], [`LogError::MissingColumns`], and those of
/// [`LogColumns::validate`](crate::LogColumns::validate).
pub fn log_of_table(mut table: Table) -> Result<(RobotLog, Vec<String>), LogError> {
    let names: Vec<String> = table.columns.iter().map(|(name, _)| name.clone()).collect();
    let header = Header::from_names(&names)?;
    let take = |&position: &usize| std::mem::take(&mut table.columns[position].1);
    let columns = header.positions.iter().map(take).collect();
    let mut columns = header.assemble(columns);
    if lacks_velocity(&header.quantities) && columns.q_rad.iter().all(|q| q.len() == columns.rows()) {
        differentiate(&mut columns);
    }
    Ok((columns.validate()?, header.unknown))
}
