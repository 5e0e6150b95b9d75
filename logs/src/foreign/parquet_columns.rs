//! Columns of a Parquet file of another program: numbers, lists of numbers, names, stamps.
//!
//! ```text
//! FLOAT DOUBLE INT32 INT64              numbers; TIMESTAMP says its unit; large integers keep their last digit (a base is taken out)
//! LIST or fixed-size list of numbers    one column per entry, name[0], name[1], …; as many in every row
//! STRING                                names of joints
//! ```
//!
//! Memory stays in proportion to the file, as in `parquet_table`; panics of the decoder are caught. Leaves out: lists of lists, structs in
//! lists, dates without time.

use parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type as PhysicalType};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, Length, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;
use tribo_files::{LogError, LogFile, ParquetBytes, guarded, most_cells, parquet_pages};

use super::table::{Cells, Column, ForeignTable, Kind, LARGE, Loaded};
use crate::format::LogFormat;

/// The most entries of a list column, and columns of a file.
const MOST_ENTRIES: usize = 1 << 8;
const MOST_COLUMNS: usize = 1 << 12;

/// Values decoded at once.
const BATCH_ROWS: usize = 1 << 14;

/// Bytes of a name unpacked.
const BYTES_PER_NAME: u64 = 256;

/// Which leaf of the file, and which entry of its list, a column is.
#[derive(Debug, Clone, Copy)]
struct Place {
    leaf: usize,
    entry: usize,
    /// Entries of the list; 1 where it is none.
    width: usize,
}

/// A Parquet file, schema read.
pub(crate) struct ParquetColumns<'f, 'p> {
    file: &'f LogFile<'p>,
    columns: Vec<Column>,
    places: Vec<Place>,
    left_out: Vec<String>,
}

impl<'f, 'p> ParquetColumns<'f, 'p> {
    /// Reads the schema, and the first row of every list.
    pub fn open(file: &'f LogFile<'p>) -> Result<Self, LogError> {
        let (mut columns, mut places, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
        decoded(file, &mut |reader, chunks| {
            let schema = reader.metadata().file_metadata().schema_descr();
            if schema.num_columns() > MOST_COLUMNS {
                return Err(general(format!("{} columns; read are up to {MOST_COLUMNS}", schema.num_columns())));
            }
            for (leaf, column) in schema.columns().iter().enumerate() {
                let parts = column.path().parts();
                let Some((kind, unit)) = kind_of(column) else {
                    left_out.push(parts.join("."));
                    continue;
                };
                if column.max_rep_level() == 0 {
                    columns.push(Column { unit, ..Column::new(parts.join("."), kind) });
                    places.push(Place { leaf, entry: 0, width: 1 });
                    continue;
                }
                let name = parts.first().cloned().unwrap_or_default();
                let width = if kind == Kind::Number { first_width(reader, chunks, leaf)? } else { 0 };
                if !(1..=MOST_ENTRIES).contains(&width) || columns.len() + width > MOST_COLUMNS {
                    left_out.push(name);
                    continue;
                }
                for entry in 0..width {
                    columns.push(Column { unit, ..Column::entry(&name, entry) });
                    places.push(Place { leaf, entry, width });
                }
            }
            Ok(())
        })?;
        Ok(Self { file, columns, places, left_out })
    }
}

impl ForeignTable for ParquetColumns<'_, '_> {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn left_out(&self) -> &[String] {
        &self.left_out
    }

    fn format(&self) -> LogFormat {
        LogFormat::Parquet
    }

    fn load(&self, wanted: &[usize]) -> Result<Loaded, LogError> {
        let mut loaded = Loaded::default();
        decoded(self.file, &mut |reader, chunks| {
            let rows =
                usize::try_from(reader.metadata().file_metadata().num_rows()).map_err(|e| general(e.to_string()))?;
            let cells = (rows as u64).saturating_mul(wanted.len() as u64);
            if cells > most_cells(chunks.len()) {
                return Err(general(format!("{rows} rows of {} columns in {} bytes", wanted.len(), chunks.len())));
            }
            let mut lists: Vec<(usize, Cells)> = Vec::new();
            for (done, &column) in wanted.iter().enumerate() {
                self.file.done(done as f64 / wanted.len() as f64)?;
                let Place { leaf, entry, width } = self.places[column];
                if width > 1 && !lists.iter().any(|(known, _)| *known == leaf) {
                    lists.push((leaf, whole(reader, chunks, leaf, rows, width, &self.columns[column])?));
                }
                let cells = match lists.iter().find(|(known, _)| *known == leaf) {
                    Some((_, Cells::Numbers { base, values })) => Cells::Numbers {
                        base: *base,
                        values: values.iter().skip(entry).step_by(width).copied().collect(),
                    },
                    _ => whole(reader, chunks, leaf, rows, width, &self.columns[column])?,
                };
                loaded.cells.push(cells);
            }
            Ok(())
        })?;
        Ok(loaded)
    }
}

/// Lets `take` look at an open file and its bytes; panics of the decoder become errors.
fn decoded(
    file: &LogFile,
    take: &mut dyn FnMut(&dyn FileReader, &ParquetBytes) -> Result<(), ParquetError>,
) -> Result<(), LogError> {
    let path = file.path;
    let corrupt = |detail: String| LogError::Corrupt { path: path.to_path_buf(), detail };
    let bytes = file.open("Parquet")?;
    let outcome = guarded(|| {
        let chunks = ParquetBytes::of(bytes);
        take(&SerializedFileReader::new(chunks.clone())?, &chunks)
    });
    match outcome {
        Some(Ok(())) => Ok(()),
        Some(Err(ParquetError::NYI(detail))) => Err(LogError::NotRead { path: path.to_path_buf(), detail }),
        Some(Err(ParquetError::General(detail))) => Err(corrupt(detail)),
        Some(Err(error)) => Err(corrupt(error.to_string())),
        None => Err(corrupt("the Parquet decoder gave up on it".to_owned())),
    }
}

fn general(detail: String) -> ParquetError {
    ParquetError::General(detail)
}

/// Numbers or names, and the unit of stamps; `None` for what is neither.
fn kind_of(column: &ColumnDescriptor) -> Option<(Kind, Option<&'static str>)> {
    if column.max_rep_level() > 1 {
        return None;
    }
    let unit = match column.logical_type_ref() {
        Some(LogicalType::Timestamp(stamp)) => Some(match stamp.unit {
            TimeUnit::MILLIS => "ms",
            TimeUnit::MICROS => "us",
            TimeUnit::NANOS => "ns",
        }),
        Some(LogicalType::Integer(_)) | None => match column.converted_type() {
            ConvertedType::TIMESTAMP_MILLIS => Some("ms"),
            ConvertedType::TIMESTAMP_MICROS => Some("us"),
            ConvertedType::DECIMAL | ConvertedType::DATE => return None,
            _ => None,
        },
        Some(LogicalType::String) => None,
        Some(_) => return None,
    };
    match column.physical_type() {
        PhysicalType::DOUBLE | PhysicalType::FLOAT | PhysicalType::INT32 | PhysicalType::INT64 => {
            Some((Kind::Number, unit))
        }
        PhysicalType::BYTE_ARRAY if matches!(column.converted_type(), ConvertedType::UTF8 | ConvertedType::NONE) => {
            Some((Kind::Text, None))
        }
        _ => None,
    }
}

/// Entries of the first list of a column; 0 where it has none.
fn first_width(reader: &dyn FileReader, chunks: &ParquetBytes, leaf: usize) -> Result<usize, ParquetError> {
    if reader.num_row_groups() == 0 {
        return Ok(0);
    }
    let group = reader.metadata().row_group(0);
    let most = u64::try_from(group.column(leaf).num_values()).unwrap_or(0);
    if most > most_cells(chunks.len()) {
        return Err(general(format!("a list column of {most} values in {} bytes", chunks.len())));
    }
    parquet_pages::check_sized(chunks, reader.metadata().row_group(0).column(leaf), most, 0)?;
    let column = reader.get_row_group(0)?.get_column_reader(leaf)?;
    let mut levels = Vec::new();
    let read = match column {
        ColumnReader::DoubleColumnReader(mut typed) => {
            typed.read_records(1, Some(&mut Vec::new()), Some(&mut levels), &mut Vec::new())
        }
        ColumnReader::FloatColumnReader(mut typed) => {
            typed.read_records(1, Some(&mut Vec::new()), Some(&mut levels), &mut Vec::new())
        }
        ColumnReader::Int32ColumnReader(mut typed) => {
            typed.read_records(1, Some(&mut Vec::new()), Some(&mut levels), &mut Vec::new())
        }
        ColumnReader::Int64ColumnReader(mut typed) => {
            typed.read_records(1, Some(&mut Vec::new()), Some(&mut levels), &mut Vec::new())
        }
        _ => return Ok(0),
    };
    read?;
    Ok(levels.len())
}

/// All cells of a leaf, `width` per row.
fn whole(
    reader: &dyn FileReader,
    chunks: &ParquetBytes,
    leaf: usize,
    rows: usize,
    width: usize,
    column: &Column,
) -> Result<Cells, ParquetError> {
    let mut cells = if column.kind == Kind::Text { Cells::text() } else { Cells::numbers() };
    let descriptor = reader.metadata().file_metadata().schema_descr().column(leaf);
    let expected = rows.saturating_mul(width);
    if expected as u64 > most_cells(chunks.len()) {
        return Err(general(format!("{rows} rows of {width} entries in {} bytes", chunks.len())));
    }
    let bytes = if column.kind == Kind::Text { BYTES_PER_NAME } else { 0 };
    for group in 0..reader.num_row_groups() {
        parquet_pages::check_sized(chunks, reader.metadata().row_group(group).column(leaf), expected as u64, bytes)?;
        let chunk = reader.get_row_group(group)?.get_column_reader(leaf)?;
        let into = Into { cells: &mut cells, descriptor: &descriptor, expected, width, name: &column.name };
        match chunk {
            ColumnReader::DoubleColumnReader(typed) => into.read(typed, |value, _| Ok(*value)),
            ColumnReader::FloatColumnReader(typed) => into.read(typed, |value, _| Ok(f64::from(*value))),
            ColumnReader::Int32ColumnReader(typed) => into.read(typed, |value, _| Ok(f64::from(*value))),
            ColumnReader::Int64ColumnReader(typed) => into.read(typed, |value, base| {
                let base = *base.get_or_insert(if value.unsigned_abs() >= LARGE { *value } else { 0 });
                value
                    .checked_sub(base)
                    .map(|value| value as f64)
                    .ok_or_else(|| general("integers too far apart".to_owned()))
            }),
            ColumnReader::ByteArrayColumnReader(typed) => into.read_labels(typed),
            _ => Err(general(format!("column {} holds no numbers", column.name))),
        }?;
    }
    let got = match &cells {
        Cells::Numbers { values, .. } => values.len(),
        Cells::Text { of_row, .. } => of_row.len(),
    };
    if got != expected {
        return Err(general(format!("column {}: {got} values, expected {expected}", column.name)));
    }
    Ok(cells)
}

/// Where the values of one column go.
struct Into<'c> {
    cells: &'c mut Cells,
    descriptor: &'c ColumnDescriptor,
    expected: usize,
    width: usize,
    name: &'c str,
}

impl Into<'_> {
    fn read<T: DataType>(
        self,
        mut chunk: ColumnReaderImpl<T>,
        number: impl Fn(&T::T, &mut Option<i64>) -> Result<f64, ParquetError>,
    ) -> Result<(), ParquetError> {
        let Cells::Numbers { base, values } = self.cells else {
            return Err(general(format!("column {} changes its kind", self.name)));
        };
        let mut known = (!values.is_empty()).then_some(*base);
        let (most_def, lists) = (self.descriptor.max_def_level(), self.descriptor.max_rep_level() > 0);
        let (mut batch, mut defs, mut reps) = (Vec::new(), Vec::new(), Vec::new());
        loop {
            batch.clear();
            defs.clear();
            reps.clear();
            let (records, _, _) = chunk.read_records(
                BATCH_ROWS,
                (most_def > 0).then_some(&mut defs),
                lists.then_some(&mut reps),
                &mut batch,
            )?;
            if records == 0 || values.len() > self.expected {
                break;
            }
            let count = if most_def > 0 { defs.len() } else { batch.len() };
            let mut found = batch.iter();
            for at in 0..count {
                if lists && reps.get(at) == Some(&0) && values.len() % self.width != 0 {
                    let row = values.len() / self.width;
                    let entries = values.len() % self.width;
                    let list = format!("column {}, row {row}: {entries} entries, expected {}", self.name, self.width);
                    return Err(general(list));
                }
                let there = most_def == 0 || defs.get(at) == Some(&most_def);
                let value = match if there { found.next() } else { None } {
                    Some(value) => number(value, &mut known)?,
                    _ => f64::NAN,
                };
                values.push(value);
            }
        }
        *base = known.unwrap_or(0);
        Ok(())
    }

    fn read_labels(self, mut chunk: ColumnReaderImpl<parquet::data_type::ByteArrayType>) -> Result<(), ParquetError> {
        let most_def = self.descriptor.max_def_level();
        let (mut batch, mut defs, mut count) = (Vec::new(), Vec::new(), 0_usize);
        loop {
            batch.clear();
            defs.clear();
            let (records, _, _) =
                chunk.read_records(BATCH_ROWS, (most_def > 0).then_some(&mut defs), None, &mut batch)?;
            if records == 0 || count > self.expected {
                return Ok(());
            }
            count += records;
            if most_def == 0 {
                defs.resize(batch.len(), 0);
            }
            let mut found = batch.iter();
            for &def in &defs {
                let label = if def == most_def { found.next() } else { None };
                let label = label.map_or(Ok(""), |label| label.as_utf8())?;
                if !self.cells.push_label(label) {
                    return Err(general(format!("column {} names too many joints", self.name)));
                }
            }
        }
    }
}
