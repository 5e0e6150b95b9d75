//! What is written reads back to the same bits, through every format, and the same log gives the same bytes.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::fs;

use tribo_files::{Table, read_table, write_table};
use tribo_logs::{LogFormat, Quantity, ReadOptions, log_of_table, read, read_log, write_csv, write_parquet};

use crate::common::{bits, synthetic_log};

#[test]
fn logs_survive_csv_gzip_and_parquet_bit_for_bit() {
    let directory = tempfile::tempdir().unwrap();
    for (joints, full) in [(1, false), (6, true), (7, true)] {
        let log = synthetic_log(joints, 500, full);
        for (name, format) in
            [("a.csv", LogFormat::Csv), ("a.csv.gz", LogFormat::CsvGz), ("a.parquet", LogFormat::Parquet)]
        {
            let path = directory.path().join(name);
            let write =
                || if format == LogFormat::Parquet { write_parquet(&path, &log) } else { write_csv(&path, &log) };
            write().unwrap();
            let (read, summary) = read_log(&path).unwrap();
            assert_eq!(bits(&read), bits(&log), "{name}");
            assert_eq!((summary.format, summary.rows, summary.joints), (format, 500, joints));
            assert_eq!((summary.dropped_repeats, summary.bursts), (0, 1));
            assert_eq!(summary.missing.is_empty(), full);
            assert!(summary.unknown_columns.is_empty() && summary.warnings.is_empty());
            let first = fs::read(&path).unwrap();
            write().unwrap();
            assert_eq!(fs::read(&path).unwrap(), first, "{name} is deterministic");
        }
    }
}

/// Whether rows are left out while a file is read, or after it: the same stretches stand for it.
#[test]
fn a_long_log_is_read_in_stretches_whatever_its_format() {
    let directory = tempfile::tempdir().unwrap();
    let mut columns = synthetic_log(2, 70_000, false).into_columns();
    columns.time_s = (0..70_000).map(|k| 3.0 + 1e-3 * f64::from(k)).collect();
    let log = columns.validate().unwrap();
    let (csv, parquet) = (directory.path().join("a.csv"), directory.path().join("a.parquet"));
    write_csv(&csv, &log).unwrap();
    write_parquet(&parquet, &log).unwrap();
    let some = ReadOptions { most_rows: Some(30_000), ..ReadOptions::default() };
    for path in [csv, parquet] {
        let (few, summary) = read(&path, &some).unwrap();
        // Of seven stretches the first and the fifth.
        assert_eq!(few.rows(), 20_000);
        for (at, from) in [(0, 0), (10_000, 40_000)] {
            assert_eq!(bits(&few.slice(at..at + 10_000).unwrap()), bits(&log.slice(from..from + 10_000).unwrap()));
        }
        assert!(summary.warnings.iter().any(|warning| warning.starts_with("one of every 4 stretches of 10 s")));
        let (whole, summary) = read(&path, &ReadOptions { most_rows: Some(70_000), ..ReadOptions::default() }).unwrap();
        assert_eq!((whole, summary.warnings), (log.clone(), Vec::new()));
    }
}

#[test]
fn the_format_is_known_by_content_not_by_name() {
    let directory = tempfile::tempdir().unwrap();
    let log = synthetic_log(2, 10, false);
    let (packed, plain) = (directory.path().join("a.gz"), directory.path().join("a.parquet"));
    write_csv(&packed, &log).unwrap();
    write_csv(directory.path().join("b"), &log).unwrap();
    fs::rename(directory.path().join("b"), &plain).unwrap();
    assert_eq!(read_log(&packed).unwrap().1.format, LogFormat::CsvGz);
    assert_eq!(read_log(&plain).unwrap().1.format, LogFormat::Csv);
}

#[test]
fn tables_keep_every_bit_and_their_notes() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("trial.parquet");
    let odd = vec![f64::from_bits(0x7ff8_dead_beef_0001), -0.0, f64::NEG_INFINITY, 5e-324];
    let table = Table {
        columns: vec![("t.s".into(), vec![1.0; 4]), ("größe [Nm]".into(), odd.clone())],
        metadata: vec![("seed".into(), "42".into()), ("empty".into(), String::new())],
        ..Table::default()
    };
    write_table(&path, &table).unwrap();
    let read = read_table(&path).unwrap();
    assert_eq!(read.metadata, table.metadata);
    assert_eq!(read.column("t.s"), table.column("t.s"));
    let read_bits: Vec<u64> = read.column("größe [Nm]").unwrap().iter().map(|v| v.to_bits()).collect();
    assert_eq!(read_bits, odd.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
    // Longer than one batch and one page; and no rows at all.
    for rows in [0, 1, 100_000] {
        let table = Table { columns: vec![("x".into(), (0..rows).map(f64::from).collect())], ..Table::default() };
        write_table(&path, &table).unwrap();
        assert_eq!(read_table(&path).unwrap(), table);
    }
}

#[test]
fn a_log_in_a_table_tells_its_schema_and_its_columns() {
    let log = synthetic_log(2, 5, false);
    let table = Table::from(&log);
    assert_eq!(table.metadata_value("schema"), Some("tribo.log/1"));
    assert!(log.has(Quantity::Torque) && !log.has(Quantity::ExternalWrench));
    let (read, unknown) = log_of_table(table).unwrap();
    assert_eq!((read, unknown), (log, Vec::new()));
}
