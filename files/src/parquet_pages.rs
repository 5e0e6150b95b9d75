//! What the pages of a Parquet column ask for, before the decoder gives it to them.
//!
//! ```text
//! header (Thrift, compact): 1 kind, 2 bytes unpacked, 3 bytes packed, 5 | 7 | 8 {1 values, ..}, others skipped; then the page
//! ```
//!
//! The decoder makes room for as many bytes and values as a header claims, 2 GB and 17 GB at most. A page of a column of numbers has
//! no more values than the file has rows, and each takes 8 bytes and its levels.
//!
//! Source: `parquet.thrift` of apache/parquet-format, and the compact protocol of Apache Thrift.

use std::io::Read;

use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::ChunkReader;

use crate::parquet_bytes::ParquetBytes;

/// Bytes of a value unpacked, levels and the overhead of any encoding included.
const BYTES_PER_VALUE: u64 = 16;
/// Bytes of a page that holds next to nothing.
const LEAST_PAGE_BYTES: u64 = 1 << 16;
/// Deepest nesting of a header that is skipped; headers have three.
const DEEPEST: usize = 8;
/// Longest header (bytes): statistics of numbers are short.
const LONGEST_HEADER: u64 = 1 << 16;

/// Checks codec and pages of one column of one row group of a file of `rows` rows.
///
/// # Errors
/// A codec that is not read, with its name; a page that asks for more than `rows` values could need; a broken header.
pub(crate) fn check(file: &ParquetBytes, chunk: &ColumnChunkMetaData, rows: u64) -> Result<(), ParquetError> {
    check_sized(file, chunk, rows, 0)
}

/// As `check`, of values that take up to `bytes` unpacked, such as names.
pub fn check_sized(
    file: &ParquetBytes,
    chunk: &ColumnChunkMetaData,
    rows: u64,
    bytes: u64,
) -> Result<(), ParquetError> {
    let name = chunk.column_descr().name();
    match chunk.compression() {
        Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_) => {}
        other => {
            let codec = format!("{other:?}");
            let codec = codec.split('(').next().unwrap_or_default();
            return Err(ParquetError::NYI(format!(
                "column {name} is packed with {codec}; read are files without compression, SNAPPY and ZSTD (pandas: compression=\"zstd\")"
            )));
        }
    }
    let start = chunk.dictionary_page_offset().unwrap_or_else(|| chunk.data_page_offset());
    let (Ok(mut at), Ok(mut left)) = (u64::try_from(start), u64::try_from(chunk.compressed_size())) else {
        return Err(ParquetError::General(format!("column {name} begins or ends below 0")));
    };
    let most_bytes = rows.saturating_mul(BYTES_PER_VALUE.max(bytes)).saturating_add(LEAST_PAGE_BYTES);
    while left > 0 {
        let mut header = Compact { bytes: file.get_read(at)?, taken: 0 };
        let page =
            header.page().ok_or_else(|| ParquetError::General(format!("column {name}: a broken page header")))?;
        if page.unpacked > most_bytes || page.values > rows {
            return Err(ParquetError::General(format!(
                "column {name}: a page of {} values in {} bytes, in a file of {rows} rows",
                page.values, page.unpacked
            )));
        }
        let whole = header.taken.saturating_add(page.packed);
        at = at.saturating_add(whole);
        left = left.saturating_sub(whole);
    }
    Ok(())
}

/// What the header of a page claims.
#[derive(Default)]
struct Page {
    unpacked: u64,
    packed: u64,
    values: u64,
}

/// The compact protocol.
struct Compact<R> {
    bytes: R,
    /// Bytes read so far.
    taken: u64,
}

/// Kinds of fields.
const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const STRUCT: u8 = 12;

impl<R: Read> Compact<R> {
    /// A header; `None` where it is broken.
    fn page(&mut self) -> Option<Page> {
        let mut page = Page::default();
        let mut id = 0;
        while let Some((field, kind)) = self.field(&mut id)? {
            match field {
                2 => page.unpacked = self.whole()?,
                3 => page.packed = self.whole()?,
                // Data pages of both versions, and dictionaries: values are their first field.
                5 | 7 | 8 if kind == STRUCT => {
                    let mut id = 0;
                    while let Some((field, kind)) = self.field(&mut id)? {
                        if field == 1 {
                            page.values = self.whole()?;
                        } else {
                            self.skip(kind, 0)?;
                        }
                    }
                }
                _ => self.skip(kind, 0)?,
            }
        }
        Some(page)
    }

    fn byte(&mut self) -> Option<u8> {
        let mut byte = [0];
        self.bytes.read_exact(&mut byte).ok()?;
        self.taken += 1;
        (self.taken <= LONGEST_HEADER).then_some(byte[0])
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    /// A zigzag number that is not below zero.
    fn whole(&mut self) -> Option<u64> {
        let number = self.varint()?;
        (number & 1 == 0).then_some(number >> 1)
    }

    /// Number and kind of the next field after `id`; the inner `None` ends the struct.
    fn field(&mut self, id: &mut u64) -> Option<Option<(u64, u8)>> {
        let byte = self.byte()?;
        if byte == 0 {
            return Some(None);
        }
        *id = match byte >> 4 {
            0 => self.whole()?,
            step => *id + u64::from(step),
        };
        Some(Some((*id, byte & 0x0f)))
    }

    fn skip(&mut self, kind: u8, depth: usize) -> Option<()> {
        if depth > DEEPEST {
            return None;
        }
        match kind {
            TRUE | FALSE => {}
            BYTE => drop(self.byte()?),
            4..=6 => drop(self.varint()?),
            DOUBLE => (0..8).try_for_each(|_| self.byte().map(drop))?,
            BINARY => {
                let length = self.varint()?;
                (0..length).try_for_each(|_| self.byte().map(drop))?;
            }
            LIST | SET => {
                let byte = self.byte()?;
                let length = if byte >> 4 == 15 { self.varint()? } else { u64::from(byte >> 4) };
                let kind = byte & 0x0f;
                // A truth in a list takes a byte.
                let kind = if kind == TRUE || kind == FALSE { BYTE } else { kind };
                (0..length).try_for_each(|_| self.skip(kind, depth + 1))?;
            }
            STRUCT => {
                let mut id = 0;
                while let Some((_, kind)) = self.field(&mut id)? {
                    self.skip(kind, depth + 1)?;
                }
            }
            _ => return None,
        }
        Some(())
    }
}
