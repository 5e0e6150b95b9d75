//! A table of named `f64` columns in a Parquet file.
//!
//! ```text
//! row groups of 65 536 rows; per column REQUIRED DOUBLE, BYTE_STREAM_SPLIT + zstd; metadata as key-value pairs of the footer
//! ```
//!
//! What is written reads back to the same bits, NaN payloads and signed zeros included, and one table always gives the
//! same bytes. Files of other programs are read too: float and signed integer columns become `f64` where that is exact,
//! nulls become NaN; other columns (text, dates, lists) are named in [`Table::skipped_columns`].
//! A damaged file is an error, never a panic: our own files carry a checksum (see `seal`), for others panics of the
//! decoder are caught. Memory stays in proportion to the file: cells (`most_cells`) and pages (`parquet_pages`) are bounded
//! before they are decoded. Leaves out: codecs other than zstd and snappy, which errors name.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as PhysicalType, ZstdLevel};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::{FileReader, Length, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnDescriptor, Type};

use crate::atomic::{Output, failed, replace};
use crate::decoder::guarded;
use crate::error::LogError;
use crate::parquet_bytes::ParquetBytes;
use crate::parquet_pages;
use crate::seal::{self, OPEN_SEAL, SEAL_KEY, SEAL_VALUE, Seal, Sealer};
use crate::source::LogFile;

/// Who wrote a file, in its footer.
const PROGRAM: &str = "tribo-logs";

/// Rows of a group: a minute at 1 kHz, 31 MB in 60 columns. Trials and most logs are one group.
pub const ROWS_PER_GROUP: usize = 1 << 16;

/// The most cells believed per byte of a file: a log of an arm that stands still, all constant but for its stamps, has 140.
const CELLS_PER_BYTE: u64 = 1 << 10;

/// The most cells believed per byte beyond [`LARGE_CELLS`]: what is measured has less than one. Memory is up to 128 times the file.
const CELLS_PER_BYTE_OF_LARGE: u64 = 16;

/// Cells of a large table, 512 MB: a quarter of an hour at 1 kHz in 71 columns.
const LARGE_CELLS: u64 = 1 << 26;

/// The most cells believed of a small file.
const LEAST_CELLS: u64 = 1 << 20;

/// The most cells that a file of so many bytes may ask memory for.
pub fn most_cells(bytes: u64) -> u64 {
    let large = bytes.saturating_mul(CELLS_PER_BYTE_OF_LARGE).max(LARGE_CELLS);
    bytes.saturating_mul(CELLS_PER_BYTE).min(large).max(LEAST_CELLS)
}

/// Values decoded at once.
const BATCH_ROWS: usize = 1 << 14;

/// Largest integer up to which every integer is an `f64`: 2^53.
const LARGEST_EXACT_INTEGER: u64 = 1 << 53;

/// Named columns of equal length, and notes about them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// Name and values of each column; names are unique, lengths equal.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Key-value pairs, in order.
    pub metadata: Vec<(String, String)>,
    /// Columns of a file read that hold no numbers, in order; not written.
    pub skipped_columns: Vec<String>,
}

impl Table {
    /// Values of the column called `name`.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|(column, _)| column == name).map(|(_, values)| values.as_slice())
    }

    /// First metadata value under `key`.
    #[must_use]
    pub fn metadata_value(&self, key: &str) -> Option<&str> {
        self.metadata.iter().find(|(k, _)| k == key).map(|(_, value)| value.as_str())
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, values)| values.len())
    }

    /// Unique names, equal lengths, at least one column.
    fn check(&self) -> Result<(), LogError> {
        let rows = self.rows();
        if self.columns.is_empty() {
            return Err(LogError::MissingColumns { missing: vec!["(any)".to_owned()], unknown: Vec::new() });
        }
        for (position, (name, values)) in self.columns.iter().enumerate() {
            if let Some(first) = self.columns[..position].iter().position(|(earlier, _)| earlier == name) {
                let column = name.clone();
                return Err(LogError::DuplicateColumn { column, first: first + 1, second: position + 1 });
            }
            if values.len() != rows {
                return Err(LogError::ColumnLength { column: name.clone(), got: values.len(), expected: rows });
            }
        }
        Ok(())
    }
}

/// Writes a table. The file appears whole or not at all.
///
/// # Errors
/// [`LogError::DuplicateColumn`], [`LogError::ColumnLength`], [`LogError::MissingColumns`] for a table without columns,
/// and those of [`write_atomic`](crate::write_atomic).
pub fn write_table(path: impl AsRef<Path>, table: &Table) -> Result<(), LogError> {
    write_table_to(path.as_ref(), table)
}

fn write_table_to(path: &Path, table: &Table) -> Result<(), LogError> {
    table.check().map_err(|error| error.in_file(path))?;
    let names: Vec<String> = table.columns.iter().map(|(name, _)| name.clone()).collect();
    let columns: Vec<&[f64]> = table.columns.iter().map(|(_, values)| values.as_slice()).collect();
    replace(path, |file| {
        let mut writer = TableWriter::new(file, path, &names, &table.metadata)?;
        writer.write(&columns, path)?;
        writer.finish(path)
    })
}

/// A table being written, group by group.
pub struct TableWriter<'o> {
    writer: SerializedFileWriter<Sealer<'o>>,
}

impl<'o> TableWriter<'o> {
    /// Begins a file; names are unique.
    pub fn new(
        out: &'o mut dyn Output,
        path: &Path,
        names: &[String],
        metadata: &[(String, String)],
    ) -> Result<Self, LogError> {
        Self::begin(out, names, metadata).map_err(|error| told(path, error))
    }

    fn begin(out: &'o mut dyn Output, names: &[String], metadata: &[(String, String)]) -> Result<Self, ParquetError> {
        let field = |name: &String| {
            let column = Type::primitive_type_builder(name, PhysicalType::DOUBLE);
            column.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
        };
        let fields = names.iter().map(field).collect::<Result<Vec<_>, _>>()?;
        let schema = Type::group_type_builder("tribo").with_fields(fields).build()?;
        let mut writer = SerializedFileWriter::new(Sealer::new(out), Arc::new(schema), Arc::new(properties(metadata)))?;
        writer.write_all(OPEN_SEAL)?;
        Ok(Self { writer })
    }

    /// Appends rows, given by columns of one length, in groups of [`ROWS_PER_GROUP`].
    pub fn write(&mut self, columns: &[&[f64]], path: &Path) -> Result<(), LogError> {
        let rows = columns.first().map_or(0, |column| column.len());
        for start in (0..rows.max(1)).step_by(ROWS_PER_GROUP) {
            self.write_group(columns, start..rows.min(start + ROWS_PER_GROUP)).map_err(|error| told(path, error))?;
        }
        Ok(())
    }

    fn write_group(&mut self, columns: &[&[f64]], rows: Range<usize>) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for values in columns {
            let Some(mut column) = group.next_column()? else { break };
            column.typed::<DoubleType>().write_batch(&values[rows.clone()], None, None)?;
            column.close()?;
        }
        group.close().map(|_| ())
    }

    /// Ends the file and seals it.
    pub fn finish(self, path: &Path) -> Result<(), LogError> {
        let sealer = self.writer.into_inner().map_err(|error| told(path, error))?;
        sealer.close().map_err(|source| failed(path, "write", source))
    }
}

/// Reads a table.
///
/// # Errors
/// [`LogError::NotFound`], [`LogError::IsDirectory`], [`LogError::Io`], [`LogError::Empty`], and
/// [`LogError::Corrupt`] for anything the decoder or the checksum refuses.
pub fn read_table(path: impl AsRef<Path>) -> Result<Table, LogError> {
    read_table_of(path.as_ref())
}

fn read_table_of(path: &Path) -> Result<Table, LogError> {
    let table = table_of(&LogFile::new(path), &|_| true)?;
    table.check().map_err(|error| corrupt(path, error.to_string()))?;
    Ok(table)
}

/// Reads the columns of a table whose name is `wanted`. The other columns of numbers are there and empty; names may be there twice.
pub fn table_of(file: &LogFile, wanted: &dyn Fn(&str) -> bool) -> Result<Table, LogError> {
    let path = file.path;
    let io = |source| LogError::io(path, "read", source);
    let mut bytes = file.open("Parquet")?;
    if file.length().map_err(io)? == 0 {
        return Err(LogError::Empty { path: path.to_path_buf() });
    }
    let seal = seal::check(&mut bytes).map_err(io)?;
    if seal == Seal::Broken {
        return Err(corrupt(path, "the checksum of the file does not match its content".to_owned()));
    }

    // The decoder indexes by numbers it read from the file and panics on some damaged inputs. Our own files are checked above;
    // for files of other programs the panic stops here. Nothing shared is left half changed: what the closure touches is dropped.
    let decoded = guarded(|| decode(ParquetBytes::of(bytes), file, wanted));
    let (mut table, promises_seal) = match decoded {
        Some(Ok(decoded)) => decoded,
        Some(Err(ParquetError::NYI(detail))) => return Err(LogError::NotRead { path: path.to_path_buf(), detail }),
        Some(Err(error)) => return Err(corrupt(path, told_plainly(error))),
        None => return Err(corrupt(path, "the Parquet decoder gave up on it".to_owned())),
    };
    if seal == Seal::Absent && promises_seal {
        return Err(corrupt(path, "the checksum that its footer promises is not there".to_owned()));
    }
    table.metadata.retain(|(key, _)| key != SEAL_KEY);
    Ok(table)
}

fn properties(metadata: &[(String, String)]) -> WriterProperties {
    let pair = |(key, value): &(String, String)| KeyValue::new(key.clone(), value.clone());
    let sealed = KeyValue::new(SEAL_KEY.to_owned(), SEAL_VALUE.to_owned());
    WriterProperties::builder()
        .set_created_by(format!("{PROGRAM} {}", env!("CARGO_PKG_VERSION")))
        .set_key_value_metadata(Some(metadata.iter().map(pair).chain([sealed]).collect()))
        .set_dictionary_enabled(false)
        .set_encoding(Encoding::BYTE_STREAM_SPLIT)
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .build()
}

/// The wanted columns of a Parquet file, told to whoever watches it, and whether its footer says in one of two places that we sealed it.
fn decode(file: ParquetBytes, heard: &LogFile, wanted: &dyn Fn(&str) -> bool) -> Result<(Table, bool), ParquetError> {
    let bytes = file.len();
    let reader = SerializedFileReader::new(file.clone())?;
    let metadata = reader.metadata().file_metadata();
    let rows = usize::try_from(metadata.num_rows()).map_err(|e| ParquetError::General(e.to_string()))?;
    let numeric = metadata.schema_descr().columns().iter();
    let numeric = numeric.filter(|column| is_number(column) && wanted(column.name())).count().max(1) as u64;
    if (rows as u64).saturating_mul(numeric) > most_cells(bytes) {
        return Err(ParquetError::General(format!("{rows} rows of {numeric} columns in {bytes} bytes")));
    }
    let mut table = Table::default();
    for pair in metadata.key_value_metadata().into_iter().flatten() {
        table.metadata.push((pair.key.clone(), pair.value.clone().unwrap_or_default()));
    }
    let ours = metadata.created_by().is_some_and(|program| program.starts_with(PROGRAM));
    let promises_seal = ours || table.metadata_value(SEAL_KEY).is_some();
    for (index, column) in metadata.schema_descr().columns().iter().enumerate() {
        heard.done(index as f64 / metadata.schema_descr().num_columns() as f64)?;
        let name = column.path().parts().join(".");
        if !is_number(column) {
            table.skipped_columns.push(name);
            continue;
        }
        let mut values = Vec::new();
        if !wanted(&name) {
            table.columns.push((name, values));
            continue;
        }
        for group in 0..reader.num_row_groups() {
            parquet_pages::check(&file, reader.metadata().row_group(group).column(index), rows as u64)?;
            let chunk = reader.get_row_group(group)?.get_column_reader(index)?;
            read_chunk(chunk, column, rows, &mut values)?;
        }
        if values.len() != rows {
            return Err(ParquetError::General(format!("column {name}: {} rows, expected {rows}", values.len())));
        }
        table.columns.push((name, values));
    }
    Ok((table, promises_seal))
}

/// A flat column of floats or plain signed integers. Integers that mean a date or a scaled decimal are none.
fn is_number(column: &ColumnDescriptor) -> bool {
    use parquet::basic::ConvertedType::{INT_8, INT_16, INT_32, INT_64, NONE};
    let signed = match column.logical_type_ref() {
        Some(LogicalType::Integer(integer)) => integer.is_signed,
        Some(_) => false,
        None => matches!(column.converted_type(), NONE | INT_8 | INT_16 | INT_32 | INT_64),
    };
    let number = match column.physical_type() {
        PhysicalType::DOUBLE | PhysicalType::FLOAT => true,
        PhysicalType::INT32 | PhysicalType::INT64 => signed,
        _ => false,
    };
    number && column.path().parts().len() == 1 && column.max_rep_level() == 0
}

/// Appends the values of one column of one row group, up to one more than there are `rows`.
fn read_chunk(
    chunk: ColumnReader,
    column: &ColumnDescriptor,
    rows: usize,
    values: &mut Vec<f64>,
) -> Result<(), ParquetError> {
    let nullable = column.max_def_level() > 0;
    match chunk {
        ColumnReader::DoubleColumnReader(chunk) => read_as(chunk, nullable, Some, rows, values),
        ColumnReader::FloatColumnReader(chunk) => read_as(chunk, nullable, |v| Some(f64::from(v)), rows, values),
        ColumnReader::Int32ColumnReader(chunk) => read_as(chunk, nullable, |v| Some(f64::from(v)), rows, values),
        ColumnReader::Int64ColumnReader(chunk) => {
            let exact = |v: i64| (v.unsigned_abs() <= LARGEST_EXACT_INTEGER).then_some(v as f64);
            read_as(chunk, nullable, exact, rows, values)
        }
        _ => Err(ParquetError::General(format!("column {} holds no numbers", column.name()))),
    }
}

fn read_as<T: DataType>(
    mut chunk: ColumnReaderImpl<T>,
    nullable: bool,
    number: impl Fn(T::T) -> Option<f64>,
    rows: usize,
    values: &mut Vec<f64>,
) -> Result<(), ParquetError> {
    let (mut batch, mut levels) = (Vec::new(), Vec::new());
    loop {
        batch.clear();
        levels.clear();
        let (records, _, _) = chunk.read_records(BATCH_ROWS, nullable.then_some(&mut levels), None, &mut batch)?;
        if records == 0 || values.len() > rows {
            return Ok(());
        }
        if !nullable {
            levels.resize(batch.len(), 1);
        }
        // Only values that are there are in the batch: level 1 takes one, level 0 is a null.
        let mut found = batch.drain(..);
        for &level in &levels {
            let value = if level == 0 { Some(f64::NAN) } else { found.next().and_then(&number) };
            values
                .push(value.ok_or_else(|| ParquetError::General("an integer beyond 2^53 is no exact f64".to_owned()))?);
        }
    }
}

/// An error of the writer: of the disk, or of the encoder.
fn told(path: &Path, error: ParquetError) -> LogError {
    match error {
        ParquetError::External(cause) => match cause.downcast::<std::io::Error>() {
            Ok(source) => failed(path, "write", *source),
            Err(cause) => corrupt(path, cause.to_string()),
        },
        other => corrupt(path, other.to_string()),
    }
}

/// An error of the decoder; ours without the decoder's name before them.
fn told_plainly(error: ParquetError) -> String {
    match error {
        ParquetError::General(ours) => ours,
        other => other.to_string(),
    }
}

fn corrupt(path: &Path, detail: String) -> LogError {
    LogError::Corrupt { path: path.to_path_buf(), detail }
}
