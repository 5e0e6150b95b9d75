//! Twenty thousand random damages to a small file of each format: never a panic, and an error names the file.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::fs;

use common::{XorShift, bits, kinova_csv, mutated, scratch, synthetic_log};
use tribo_logs::{read_csv_from, read_log, write_csv, write_parquet};

const MUTATIONS: usize = 20_000;

#[test]
fn damaged_csv_is_an_error_or_a_valid_log() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("small.csv");
    write_csv(&path, &synthetic_log(2, 6, true)).unwrap();
    let whole = fs::read(&path).unwrap();
    let mut random = XorShift(0x5eed_0001);
    let mut refused = 0;
    for _ in 0..MUTATIONS {
        match read_csv_from(&mutated(&whole, &mut random)[..], &path) {
            Ok((log, _)) => assert!(log.into_columns().validate().is_ok()),
            Err(error) => {
                refused += 1;
                assert!(error.to_string().contains("small.csv"), "{error}");
            }
        }
    }
    assert!(
        (MUTATIONS / 10..MUTATIONS).contains(&refused),
        "{refused} refused: the mutations bite and some are harmless"
    );
}

#[test]
fn damaged_files_of_every_format_are_an_error_or_a_valid_log() {
    let directory = scratch();
    let log = synthetic_log(2, 6, false);
    for (name, seed) in [("small.csv.gz", 0x5eed_0002), ("small.parquet", 0x5eed_0004)] {
        let path = directory.path().join(name);
        let parquet = name.ends_with("parquet");
        if parquet {
            write_parquet(&path, &log).unwrap()
        } else {
            write_csv(&path, &log).unwrap()
        }
        let whole = fs::read(&path).unwrap();
        let mut random = XorShift(seed);
        for _ in 0..MUTATIONS {
            let torn = mutated(&whole, &mut random);
            fs::write(&path, &torn).unwrap();
            match read_log(&path) {
                Ok((read, _)) if parquet => assert!(torn == whole && bits(&read) == bits(&log), "damage went unseen"),
                Ok((read, _)) => assert!(read.into_columns().validate().is_ok()),
                Err(error) => assert!(error.to_string().contains(name), "{error}"),
            }
        }
    }
}

#[test]
fn damaged_kinova_files_are_an_error_or_a_valid_log() {
    let directory = scratch();
    let path = directory.path().join("small.csv");
    let whole = kinova_csv(4);
    let mut random = XorShift(0x5eed_0005);
    for _ in 0..MUTATIONS {
        fs::write(&path, mutated(whole.as_bytes(), &mut random)).unwrap();
        match read_log(&path) {
            Ok((read, _)) => assert!(read.into_columns().validate().is_ok()),
            Err(error) => assert!(error.to_string().contains("small.csv"), "{error}"),
        }
    }
}
