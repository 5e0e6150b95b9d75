//! NumPy arrays: `.npz` with arrays under names, `.npy` with a structured array.
//!
//! ```text
//! (n)         a column                        time, t
//! (n, N)      one column per entry, name[k]   q, dq, tau; (N, n) is turned
//! structured  one column per field            np.array(…, dtype=[("time", "f8"), ("q", "f8", 7)])
//! ```
//!
//! n is the length of the arrays of one dimension, where a table has that many rows or columns; without such, the longer side. Floats and
//! integers of any width and byte order. Leaves out: objects (pickle), text, complex numbers, more dimensions.

use std::io::{Cursor, Read, Seek, SeekFrom};

use npyz::{DType, NpyHeader, Order};
use tribo_files::{Limited, LogError, LogFile, guarded};
use zip::ZipArchive;

use super::table::{Cells, Column, ForeignTable, Kind, LARGE, Loaded};
use crate::format::LogFormat;

/// First bytes of an array, and of an archive of arrays.
pub(crate) const NPY_MAGIC: &[u8] = b"\x93NUMPY";
pub(crate) const ZIP_MAGIC: &[u8] = b"PK\x03\x04";

/// Longest header of an array (bytes), and the most arrays and columns.
const LONGEST_HEADER: u64 = 1 << 16;
const DEEPEST_HEADER: usize = 8;
const MOST_ARRAYS: usize = 1 << 10;
const MOST_ENTRIES: u64 = 1 << 8;
const MOST_COLUMNS: usize = 1 << 12;

/// One number in a row of bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Field {
    offset: usize,
    kind: char,
    size: usize,
    big_endian: bool,
}

/// An array that columns are made of.
struct Array {
    /// Number of the file in the archive; none of a lone array.
    member: Option<usize>,
    name: String,
    shape: Vec<u64>,
    fortran: bool,
    /// Name (empty for a plain array) and number.
    fields: Vec<(String, Field)>,
    /// Bytes of an element.
    stride: usize,
}

/// Where a column lies.
#[derive(Debug, Clone, Copy)]
struct Place {
    array: usize,
    field: usize,
    /// Bytes of the first element, and from row to row.
    start: usize,
    step: usize,
}

/// A file of arrays, headers read.
pub(crate) struct NumpyFile<'f, 'p> {
    file: &'f LogFile<'p>,
    arrays: Vec<Array>,
    columns: Vec<Column>,
    places: Vec<Place>,
    left_out: Vec<String>,
    rows: usize,
}

impl<'f, 'p> NumpyFile<'f, 'p> {
    /// Reads all headers.
    pub fn open(file: &'f LogFile<'p>) -> Result<Self, LogError> {
        guarded(|| Self::headers(file)).unwrap_or_else(|| Err(corrupt(file, "the decoder gave up on it".to_owned())))
    }

    fn headers(file: &'f LogFile<'p>) -> Result<Self, LogError> {
        let mut found =
            Self { file, arrays: Vec::new(), columns: Vec::new(), places: Vec::new(), left_out: Vec::new(), rows: 0 };
        let mut raw = file.open("NumPy")?;
        let mut magic = [0; 6];
        raw.read_exact(&mut magic).map_err(|source| LogError::io(file.path, "read", source))?;
        raw.seek(SeekFrom::Start(0)).map_err(|source| LogError::io(file.path, "read", source))?;
        if magic == NPY_MAGIC {
            let header = header(&mut raw).map_err(|detail| corrupt(file, detail))?;
            found.take(None, "array".to_owned(), &header);
        } else {
            let mut archive = ZipArchive::new(raw).map_err(|error| corrupt(file, error.to_string()))?;
            if archive.len() > MOST_ARRAYS {
                return Err(corrupt(file, format!("{} arrays; read are up to {MOST_ARRAYS}", archive.len())));
            }
            for member in 0..archive.len() {
                let mut entry = archive.by_index(member).map_err(|error| corrupt(file, error.to_string()))?;
                let name = entry.name().map_err(|error| corrupt(file, error.to_string()))?.into_owned();
                let Some(stem) = name.strip_suffix(".npy") else {
                    found.left_out.push(name);
                    continue;
                };
                let header = header(&mut entry).map_err(|detail| corrupt(file, format!("array {stem}: {detail}")))?;
                found.take(Some(member), stem.to_owned(), &header);
            }
        }
        found.lay_out();
        Ok(found)
    }

    /// Keeps an array that is understood.
    fn take(&mut self, member: Option<usize>, name: String, header: &NpyHeader) {
        let mut fields = Vec::new();
        let stride = fields_of(&header.dtype(), String::new(), 0, &mut fields);
        let structured = matches!(header.dtype(), DType::Record(_));
        let shape = header.shape().to_vec();
        let dimensions = if structured { 1..=1 } else { 1..=2 };
        match stride {
            Some(stride) if stride > 0 && dimensions.contains(&shape.len()) && !fields.is_empty() => {
                let fortran = header.order() == Order::Fortran;
                self.arrays.push(Array { member, name, shape, fortran, fields, stride });
            }
            _ => self.left_out.push(name),
        }
    }

    /// Tells rows from joints, and lists the columns.
    fn lay_out(&mut self) {
        let flat: Vec<u64> = self.arrays.iter().filter(|a| a.shape.len() == 1).map(|a| a.shape[0]).collect();
        let tables: Vec<&Vec<u64>> = self.arrays.iter().map(|a| &a.shape).filter(|shape| shape.len() == 2).collect();
        let of_flat = flat
            .iter()
            .copied()
            .filter(|rows| tables.is_empty() || tables.iter().any(|shape| shape.contains(rows)))
            .max();
        let longer = tables.iter().filter_map(|shape| shape.iter().copied().max()).max();
        let rows = of_flat.or(longer).unwrap_or(0);
        self.rows = usize::try_from(rows).unwrap_or(usize::MAX);
        for (array, it) in self.arrays.iter().enumerate() {
            let (entries, turned) = match *it.shape.as_slice() {
                [n] if n == rows => (1, false),
                [n, entries] if n == rows && entries <= MOST_ENTRIES => (entries, false),
                [entries, n] if n == rows && entries <= MOST_ENTRIES => (entries, true),
                _ => {
                    self.left_out.push(it.name.clone());
                    continue;
                }
            };
            if self.columns.len() + entries as usize * it.fields.len() > MOST_COLUMNS {
                self.left_out.push(it.name.clone());
                continue;
            }
            // Element (row, entry) lies at row·a + entry·b in an array whose last index runs fastest, or its first.
            let contiguous_rows = turned != it.fortran;
            for entry in 0..entries as usize {
                let (start, step) =
                    if contiguous_rows { (entry.saturating_mul(self.rows), 1) } else { (entry, entries as usize) };
                for (field, (name, _)) in it.fields.iter().enumerate() {
                    let name = if name.is_empty() { it.name.clone() } else { name.clone() };
                    let column = match (it.shape.len(), name.strip_suffix(']').and_then(|start| start.rsplit_once('[')))
                    {
                        (2, _) => Column::entry(&name, entry),
                        (_, Some((list, _))) => {
                            Column { list: Some(list.to_owned()), ..Column::new(name, Kind::Number) }
                        }
                        _ => Column::new(name, Kind::Number),
                    };
                    self.columns.push(column);
                    let (start, step) = (start.saturating_mul(it.stride), step.saturating_mul(it.stride));
                    self.places.push(Place { array, field, start, step });
                }
            }
        }
    }

    /// The bytes of an array without its header.
    fn bytes(&self, array: &Array) -> Result<Vec<u8>, LogError> {
        let mut raw = self.file.open("NumPy")?;
        let packed = self.file.length().unwrap_or(0);
        let elements =
            array.shape.iter().try_fold(1_usize, |product, &side| product.checked_mul(usize::try_from(side).ok()?));
        let expected = elements.and_then(|elements| elements.checked_mul(array.stride));
        let mut bytes = Vec::new();
        let io = |source| LogError::io(self.file.path, "read", source);
        let Some(member) = array.member else {
            header(&mut raw).map_err(|detail| corrupt(self.file, detail))?;
            raw.read_to_end(&mut bytes).map_err(io)?;
            return self.checked(array, bytes, expected);
        };
        let mut archive = ZipArchive::new(raw).map_err(|error| corrupt(self.file, error.to_string()))?;
        let entry = archive.by_index(member).map_err(|error| corrupt(self.file, error.to_string()))?;
        let mut entry = Limited::new(entry, packed);
        header(&mut entry).map_err(|detail| corrupt(self.file, detail))?;
        entry.read_to_end(&mut bytes).map_err(io)?;
        self.checked(array, bytes, expected)
    }

    fn checked(&self, array: &Array, bytes: Vec<u8>, expected: Option<usize>) -> Result<Vec<u8>, LogError> {
        if Some(bytes.len()) == expected {
            return Ok(bytes);
        }
        let detail = format!("array {}: {} bytes for the shape {:?}", array.name, bytes.len(), array.shape);
        Err(corrupt(self.file, detail))
    }
}

impl ForeignTable for NumpyFile<'_, '_> {
    fn columns(&self) -> &[Column] {
        &self.columns
    }

    fn left_out(&self) -> &[String] {
        &self.left_out
    }

    fn format(&self) -> LogFormat {
        LogFormat::Numpy
    }

    fn load(&self, wanted: &[usize]) -> Result<Loaded, LogError> {
        let mut cells: Vec<Option<Cells>> = vec![None; wanted.len()];
        for (index, array) in self.arrays.iter().enumerate() {
            let here: Vec<usize> = (0..wanted.len()).filter(|&k| self.places[wanted[k]].array == index).collect();
            if here.is_empty() {
                continue;
            }
            let bytes = guarded(|| self.bytes(array))
                .unwrap_or_else(|| Err(corrupt(self.file, "the decoder gave up on it".to_owned())))?;
            for k in here {
                let place = self.places[wanted[k]];
                let field = array.fields[place.field].1;
                let at = |row: usize| {
                    let start = row.checked_mul(place.step)?.checked_add(place.start)?.checked_add(field.offset)?;
                    bytes.get(start..start.checked_add(field.size)?)
                };
                cells[k] = Some(column(field, (0..self.rows).map_while(at)));
            }
        }
        let missing = || corrupt(self.file, "its arrays change".to_owned());
        let cells = cells.into_iter().collect::<Option<Vec<Cells>>>().ok_or_else(missing)?;
        Ok(Loaded { cells, ..Loaded::default() })
    }
}

/// The header of an array; the reader stands at its data afterwards.
fn header(reader: &mut impl Read) -> Result<NpyHeader, String> {
    // Looked at first: the decoder makes room for as many bytes as the header claims.
    let mut start = [0; 8];
    reader.read_exact(&mut start).map_err(|error| error.to_string())?;
    let width = if start[6] == 1 { 2 } else { 4 };
    let mut length = [0; 4];
    reader.read_exact(&mut length[..width]).map_err(|error| error.to_string())?;
    if u64::from(u32::from_le_bytes(length)) > LONGEST_HEADER {
        return Err(format!("a header of {} bytes", u32::from_le_bytes(length)));
    }
    let mut text = vec![0; u32::from_le_bytes(length) as usize];
    reader.read_exact(&mut text).map_err(|error| error.to_string())?;
    // The decoder needs twice as long for each level of brackets; a structure of arrays in a structure has six.
    let depths = text.iter().scan(0_usize, |depth, byte| {
        match byte {
            b'(' | b'[' | b'{' => *depth += 1,
            b')' | b']' | b'}' => *depth = depth.saturating_sub(1),
            _ => {}
        }
        Some(*depth)
    });
    if depths.max().unwrap_or(0) > DEEPEST_HEADER {
        return Err(format!("a header with more than {DEEPEST_HEADER} brackets in one another"));
    }
    let whole = [&start[..], &length[..width], &text].concat();
    NpyHeader::from_reader(Cursor::new(whole)).map_err(|error| error.to_string())
}

/// The numbers of an element, and its bytes; `None` for what is not known.
fn fields_of(dtype: &DType, name: String, offset: usize, fields: &mut Vec<(String, Field)>) -> Option<usize> {
    if fields.len() > MOST_ENTRIES as usize {
        return None;
    }
    match dtype {
        DType::Plain(_) => {
            let text = dtype.descr();
            let text = text.trim_matches('\'');
            let (order, rest) = text.split_at_checked(1)?;
            let (kind, size) = rest.split_at_checked(1)?;
            let (kind, size) = (kind.chars().next()?, size.parse::<usize>().ok()?);
            let known = matches!((kind, size), ('f', 4 | 8) | ('i' | 'u', 1 | 2 | 4 | 8) | ('b', 1));
            if known {
                fields.push((name, Field { offset, kind, size, big_endian: order == ">" }));
                return Some(size);
            }
            // Text and the like are passed over; objects have no bytes here.
            dtype.num_bytes().filter(|_| !dtype.uses_pickled_array())
        }
        DType::Array(count, inner) => {
            let mut end = offset;
            for entry in 0..(*count).min(MOST_ENTRIES) {
                end = end.checked_add(fields_of(inner, format!("{name}[{entry}]"), end, fields)?)?;
            }
            (*count <= MOST_ENTRIES).then_some(end - offset)
        }
        DType::Record(parts) => {
            let mut end = offset;
            for part in parts {
                let name = if name.is_empty() { part.name.clone() } else { format!("{name}.{}", part.name) };
                end = end.checked_add(fields_of(&part.dtype, name, end, fields)?)?;
            }
            Some(end - offset)
        }
    }
}

/// The numbers of a column.
fn column<'b>(field: Field, cells: impl Iterator<Item = &'b [u8]>) -> Cells {
    let mut values = Vec::new();
    let mut base = None;
    for bytes in cells {
        let mut raw = [0; 8];
        for (k, byte) in bytes.iter().enumerate() {
            raw[if field.big_endian { field.size - 1 - k } else { k }] = *byte;
        }
        let unsigned = u64::from_le_bytes(raw);
        let shift = 64 - 8 * field.size as u32;
        let value = match (field.kind, field.size) {
            ('f', 8) => f64::from_bits(unsigned),
            ('f', _) => f64::from(f32::from_bits(unsigned as u32)),
            ('i', _) => {
                let whole = ((unsigned << shift) as i64) >> shift;
                let base = *base.get_or_insert(if whole.unsigned_abs() >= LARGE { whole } else { 0 });
                whole.checked_sub(base).map_or(f64::NAN, |value| value as f64)
            }
            _ => {
                let base =
                    *base.get_or_insert(if unsigned >= LARGE { i64::try_from(unsigned).unwrap_or(0) } else { 0 });
                i64::try_from(unsigned)
                    .ok()
                    .and_then(|whole| whole.checked_sub(base))
                    .map_or(unsigned as f64, |value| value as f64)
            }
        };
        values.push(value);
    }
    Cells::Numbers { base: base.unwrap_or(0), values }
}

fn corrupt(file: &LogFile, detail: String) -> LogError {
    LogError::Corrupt { path: file.path.to_path_buf(), detail }
}
