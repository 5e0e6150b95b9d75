//! Damaged, cut and foreign Parquet files: an error that names the file, or the right data.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::fs;
use std::sync::Arc;

use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use tribo_files::{LogError, Table, read_table, write_table};
use tribo_logs::{read_log, read_parquet, write_parquet};

use crate::common::{file, synthetic_log};

fn log_bytes() -> Vec<u8> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.parquet");
    write_parquet(&path, &synthetic_log(2, 50, false)).unwrap();
    fs::read(path).unwrap()
}

/// A file as pandas might write it: snappy, nulls, integers, text, dates.
fn foreign_bytes() -> Vec<u8> {
    let schema = "message m { REQUIRED DOUBLE a; OPTIONAL DOUBLE b; REQUIRED FLOAT c; REQUIRED INT64 d;
                  REQUIRED BYTE_ARRAY e (UTF8); REQUIRED INT64 f (TIMESTAMP_MICROS); }";
    let properties = WriterProperties::builder().set_compression(parquet::basic::Compression::SNAPPY).build();
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties)).unwrap();
    for group in 0..2 {
        let mut rows = writer.next_row_group().unwrap();
        for index in 0..6 {
            let mut column = rows.next_column().unwrap().unwrap();
            let x = f64::from(group);
            match index {
                0 => column.typed::<DoubleType>().write_batch(&[x, x], None, None),
                1 => column.typed::<DoubleType>().write_batch(&[x], Some(&[0, 1]), None),
                2 => column.typed::<FloatType>().write_batch(&[0.5, 1.5], None, None),
                3 | 5 => column.typed::<Int64Type>().write_batch(&[-3, 1 << 53], None, None),
                _ => column.typed::<ByteArrayType>().write_batch(&[ByteArray::from("x"), "y".into()], None, None),
            }
            .unwrap();
            column.close().unwrap();
        }
        rows.close().unwrap();
    }
    writer.into_inner().unwrap()
}

#[test]
fn every_single_byte_of_our_files_is_guarded() {
    let whole = log_bytes();
    for place in 0..whole.len() {
        let mut torn = whole.clone();
        torn[place] ^= 0x10;
        let (_directory, path) = file("log.parquet", torn);
        let error = read_parquet(&path).unwrap_err();
        assert!(matches!(&error, LogError::Corrupt { path: named, .. } if *named == path), "byte {place}: {error}");
    }
}

#[test]
fn cut_files_are_errors_of_the_file() {
    let whole = log_bytes();
    for length in 1..whole.len() {
        let (_directory, path) = file("log.parquet", &whole[..length]);
        assert!(matches!(read_parquet(&path), Err(LogError::Corrupt { .. })), "{length} bytes");
    }
    let (_directory, path) = file("log.parquet", "");
    assert!(read_parquet(&path).unwrap_err().to_string().ends_with("log.parquet: is empty"));
    let (_directory, path) = file("log.parquet", "PAR1");
    assert!(read_log(&path).unwrap_err().to_string().contains("log.parquet: damaged or cut off"));
    let directory = tempfile::tempdir().unwrap();
    assert!(read_parquet(directory.path()).unwrap_err().to_string().contains("expected a Parquet file"));
    assert!(matches!(read_parquet(directory.path().join("x")), Err(LogError::NotFound { .. })));
}

#[test]
fn files_of_other_programs_are_read_as_far_as_they_are_numbers() {
    let (_directory, path) = file("foreign.parquet", foreign_bytes());
    let table = read_table(&path).unwrap();
    assert_eq!(table.column("a"), Some(&[0.0, 0.0, 1.0, 1.0][..]));
    assert_eq!(table.column("c"), Some(&[0.5, 1.5, 0.5, 1.5][..]));
    assert_eq!(table.column("d"), Some(&[-3.0, 9_007_199_254_740_992.0, -3.0, 9_007_199_254_740_992.0][..]));
    let b = table.column("b").unwrap();
    assert!(b[0].is_nan() && b[1] == 0.0 && b[2].is_nan() && b[3] == 1.0);
    assert_eq!(table.skipped_columns, ["e", "f"]);
    let text = read_log(&path).unwrap_err().to_string();
    assert!(text.contains("; columns: a, b, c, d, e, f; say which is which: --map"), "{text}");
}

#[test]
fn a_log_with_a_hole_names_column_and_row() {
    let mut table = Table::from(&synthetic_log(1, 5, false));
    table.columns[2].1[3] = f64::NAN;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.parquet");
    write_table(&path, &table).unwrap();
    let text = read_parquet(&path).unwrap_err().to_string();
    assert!(text.ends_with("log.parquet: column dq_0, row 3: NaN is not finite"), "{text}");
}

#[test]
fn tables_that_are_no_tables_are_not_written() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("t.parquet");
    let write = |columns: Vec<(String, Vec<f64>)>| write_table(&path, &Table { columns, ..Table::default() });
    let column = |name: &str, rows: usize| (name.to_owned(), vec![0.0; rows]);
    let text = |result: Result<(), LogError>| result.unwrap_err().to_string();
    assert!(text(write(vec![column("a", 2), column("a", 2)])).contains("t.parquet: column `a` occurs twice"));
    assert!(text(write(vec![column("a", 2), column("b", 3)])).contains("column b: 3 rows, expected 2"));
    assert!(text(write(Vec::new())).contains("missing column"));
    assert!(!path.exists());
}

/// Equal values take no bytes: a file must not ask for more memory than a log of its size could need, in one column or in many.
#[test]
fn a_small_file_cannot_ask_for_large_memory() {
    for (columns, rows) in [(1, 4_000_000), (20, 500_000)] {
        let fields: String = (0..columns).map(|k| format!("REQUIRED DOUBLE c{k};")).collect();
        let schema = Arc::new(parse_message_type(&format!("message m {{ {fields} }}")).unwrap());
        let one_page =
            WriterProperties::builder().set_data_page_row_count_limit(rows).set_write_batch_size(rows).build();
        let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(one_page)).unwrap();
        let mut group = writer.next_row_group().unwrap();
        while let Some(mut column) = group.next_column().unwrap() {
            column.typed::<DoubleType>().write_batch(&vec![1.0; rows], None, None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
        let bytes = writer.into_inner().unwrap();
        let length = bytes.len();
        let (_directory, path) = file("bomb.parquet", bytes);
        let text = read_table(&path).unwrap_err().to_string();
        let expected = format!("bomb.parquet: damaged or cut off: {rows} rows of {columns} columns in {length} bytes");
        assert!(text.ends_with(&expected), "{text}");
    }
}

/// Writes one column of the first page's header anew: where the bytes of `from` stand, `to` stands afterwards.
fn with_bytes(whole: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let places: Vec<usize> = (0..whole.len() - from.len()).filter(|&k| whole[k..].starts_with(from)).collect();
    assert_eq!(places.len(), 1, "{places:?}");
    [&whole[..places[0]], to, &whole[places[0] + from.len()..]].concat()
}

/// A file of one column of `rows` values 1 in a dictionary, by another program.
fn in_a_dictionary(rows: usize) -> Vec<u8> {
    let schema = Arc::new(parse_message_type("message m { REQUIRED DOUBLE a; }").unwrap());
    let properties = WriterProperties::builder().set_compression(parquet::basic::Compression::SNAPPY).build();
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties)).unwrap();
    let mut group = writer.next_row_group().unwrap();
    let mut column = group.next_column().unwrap().unwrap();
    column.typed::<DoubleType>().write_batch(&vec![1.0; rows], None, None).unwrap();
    column.close().unwrap();
    group.close().unwrap();
    writer.into_inner().unwrap()
}

/// A page of 300 bytes that claims a dictionary of 2^31 − 1 numbers (17 GB), or to unpack to 2^31 − 1 bytes: refused before anybody makes
/// room for it.
#[test]
fn a_page_cannot_ask_for_more_than_its_rows() {
    let whole = in_a_dictionary(100);
    let (_directory, path) = file("good.parquet", &whole);
    assert_eq!(read_table(&path).unwrap().column("a"), Some(&[1.0; 100][..]));
    // Kind 2, 8 bytes unpacked, packed; field 7 with one value: zigzag in the compact protocol.
    let packed = whole[4 + 5];
    let header = [0x15, 0x04, 0x15, 0x10, 0x15, packed, 0x4c, 0x15, 0x02];
    assert!(whole[4..].starts_with(&header), "{:x?}", &whole[..40]);
    let most = [0xfe, 0xff, 0xff, 0xff, 0x0f];
    let values = [&header[..8], &most].concat();
    let unpacked = [&header[..3], &most[..], &header[4..]].concat();
    for (claim, expected) in
        [(values, "a page of 2147483647 values in 8 bytes"), (unpacked, "a page of 1 values in 2147483647 bytes")]
    {
        // Four bytes more before the data: the column begins where it did, and its length in the footer covers the page still.
        let (_directory, path) = file("page.parquet", with_bytes(&whole, &header, &claim));
        let text = read_table(&path).unwrap_err().to_string();
        assert!(
            text.ends_with(&format!("page.parquet: damaged or cut off: column a: {expected}, in a file of 100 rows")),
            "{text}"
        );
    }
}

#[test]
fn a_codec_that_is_not_read_is_named() {
    let whole = in_a_dictionary(3);
    // Field 4 of the column's metadata in the footer: SNAPPY, 1, becomes GZIP, 2, LZO, 3, and BROTLI, 4. The names before it are `a`.
    let before = [0x18, 0x01, b'a', 0x15];
    for (codec, name) in [(2_u8, "GZIP"), (4, "BROTLI"), (5, "LZ4"), (7, "LZ4_RAW")] {
        let mut other = whole.clone();
        let at = (0..whole.len()).rev().find(|&k| whole[k..].starts_with(&before)).or_else(|| {
            let list = [0x19, 0x18, 0x01, b'a', 0x15];
            (0..whole.len()).rev().find(|&k| whole[k..].starts_with(&list)).map(|k| k + 1)
        });
        let at = at.unwrap() + before.len();
        assert_eq!(other[at], 2, "SNAPPY");
        other[at] = 2 * codec;
        let (_directory, path) = file("codec.parquet", other);
        let error = read_table(&path).unwrap_err();
        let text = error.to_string();
        let expected = format!(
            "codec.parquet: column a is packed with {name}; read are files without compression, SNAPPY and ZSTD"
        );
        assert!(matches!(error, LogError::NotRead { .. }) && text.contains(&expected), "{text}");
    }
}

/// The columns of a log are decoded, no others: what a file holds besides takes no memory.
#[test]
fn columns_that_are_no_part_of_a_log_are_named_and_not_decoded() {
    let mut table = Table::from(&synthetic_log(1, 5, false));
    table.columns.push(("voltage".to_owned(), vec![48.0; 5]));
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.parquet");
    write_table(&path, &table).unwrap();
    let (_, summary) = read_log(&path).unwrap();
    assert_eq!(summary.unknown_columns, ["voltage"]);
    assert_eq!(read_table(&path).unwrap().column("voltage"), Some(&[48.0; 5][..]));
}

/// The longest log of an arm that stands still, all constant but for its stamps, is as small as a log can be; it is read.
#[test]
fn a_log_of_an_arm_that_stands_still_is_read() {
    let rows = 200_000;
    let log = synthetic_log(7, 2, true);
    let mut table = Table::from(&log);
    for (name, values) in &mut table.columns {
        *values = vec![0.125; rows];
        if name == "time" {
            *values = (0..rows).map(|k| k as f64 * 1e-3).collect();
        }
    }
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("still.parquet");
    write_table(&path, &table).unwrap();
    let bytes = fs::metadata(&path).unwrap().len();
    println!("{} cells per byte", (rows * table.columns.len()) as f64 / bytes as f64);
    assert_eq!(read_log(&path).unwrap().1.rows, rows);
}

/// A file of 5 MB, most of it a note, whose columns of equal values would take 720 MB: more than 128 times the file.
#[test]
fn a_larger_file_cannot_ask_for_a_thousand_times_its_size() {
    let (columns, rows) = (4, 22_500_000);
    let fields: String = (0..columns).map(|k| format!("REQUIRED DOUBLE c{k};")).collect();
    let schema = Arc::new(parse_message_type(&format!("message m {{ {fields} }}")).unwrap());
    let note = parquet::file::metadata::KeyValue::new("note".to_owned(), "x".repeat(5 << 20));
    let properties = WriterProperties::builder().set_key_value_metadata(Some(vec![note])).build();
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties)).unwrap();
    let mut group = writer.next_row_group().unwrap();
    let values = vec![1.0; rows];
    while let Some(mut column) = group.next_column().unwrap() {
        column.typed::<DoubleType>().write_batch(&values, None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    let bytes = writer.into_inner().unwrap();
    assert!((5_000_000..5_600_000).contains(&bytes.len()), "{} bytes", bytes.len());
    let (_directory, path) = file("large.parquet", bytes);
    let text = read_table(&path).unwrap_err().to_string();
    assert!(text.contains("large.parquet: damaged or cut off: 22500000 rows of 4 columns in 5"), "{text}");
}
