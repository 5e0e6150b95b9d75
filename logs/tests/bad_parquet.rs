//! Damaged, cut and foreign Parquet files: an error that names the file, or the right data.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::fs;
use std::sync::Arc;

use common::{file, synthetic_log};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use tribo_logs::{LogError, Table, read_log, read_parquet, read_table, write_parquet, write_table};

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
    assert!(
        text.contains("foreign.parquet: missing columns: time, q_0, dq_0, tau_J_0 (not understood: a, b"),
        "{text}"
    );
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
        let expected = format!(
            "bomb.parquet: damaged or cut off: Parquet error: {rows} rows of {columns} columns in {length} bytes"
        );
        assert!(text.ends_with(&expected), "{text}");
    }
}
