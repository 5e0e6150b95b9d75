//! Conversion in batches of rows: the same file, the same summary and the same errors as by way of the whole log.

#![allow(clippy::unwrap_used, reason = "tests")]

mod common;

use std::fs;
use std::path::Path;

use common::{bits, libfranka_csv, pack, relative, synthetic_log};
use tribo_logs::{ColumnNames, LogError, LogTarget, convert, detect, read_log, write_csv, write_log};

const TARGETS: [(&str, LogTarget); 5] = [
    ("out.csv", LogTarget::Csv(ColumnNames::Canonical)),
    ("out.csv.gz", LogTarget::Csv(ColumnNames::Canonical)),
    ("tree.csv", LogTarget::Csv(ColumnNames::Tree)),
    ("out.parquet", LogTarget::Parquet),
    ("out.mcap", LogTarget::Mcap),
];

/// Converts in batches and by way of the whole log, and compares bytes and summaries.
fn same_both_ways(directory: &Path, log: &Path) {
    for (name, target) in TARGETS {
        let (batches, whole) = (directory.join(name), directory.join(format!("whole_{name}")));
        let summary = convert(log, &batches, target, |_| true).unwrap();
        let (read, expected) = read_log(log).unwrap();
        write_log(&whole, &read, target).unwrap();
        assert_eq!(fs::read(&batches).unwrap(), fs::read(&whole).unwrap(), "{name} of {}", log.display());
        assert_eq!(summary, expected, "{name} of {}", log.display());
        assert_eq!(bits(&read_log(&batches).unwrap().0), bits(&read), "{name} of {}", log.display());
    }
}

#[test]
fn batches_give_the_bytes_of_the_whole() {
    let directory = tempfile::tempdir().unwrap();
    // A few rows, one row group exactly and one row more; with repeated rows, unknown columns and no last line ending.
    for rows in [3, 1 << 16, (1 << 16) + 1] {
        let log = synthetic_log(1, rows, rows < 10);
        let path = directory.path().join("log.csv");
        write_csv(&path, &log).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        let mut lines: Vec<String> = text.lines().map(|line| format!("{line},7")).collect();
        lines[0] = lines[0].replace(",7", ",note");
        lines.insert(2, lines[1].clone());
        fs::write(&path, lines.join("\r\n")).unwrap();
        same_both_ways(directory.path(), &path);
        assert_eq!(read_log(&path).unwrap().1.dropped_repeats, 1);
    }
}

#[test]
fn every_text_format_and_header_goes_both_ways() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log");
    for header in ["current", "spaced", "legacy"] {
        let text = libfranka_csv(header, 40);
        let zeros = text.lines().enumerate().map(|(k, line)| {
            if k == 0 {
                format!("{line}\n")
            } else {
                format!("{},0,0,0,0,0,0,0\n", line.rsplitn(8, ',').last().unwrap())
            }
        });
        for bytes in [text.clone().into_bytes(), pack(&text), zeros.collect::<String>().into_bytes()] {
            fs::write(&path, bytes).unwrap();
            same_both_ways(directory.path(), &path);
        }
    }
    fs::write(&path, common::kinova_csv(20)).unwrap();
    same_both_ways(directory.path(), &path);
}

#[test]
fn errors_are_those_of_the_reader_and_leave_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let (log, out) = (directory.path().join("log.csv"), directory.path().join("out.parquet"));
    let good = "time,q_0,dq_0,tau_J_0\n0,1,2,3\n0.1,1,2,3\n";
    for text in [
        "".to_owned(),
        good.replace("0.1", "-1"),
        good.replace("0.1,1", "0.1,nan"),
        good[..22].to_owned(),
        format!("{good}1,2"),
    ] {
        fs::write(&log, text).unwrap();
        let batches = convert(&log, &out, LogTarget::Parquet, |_| true).unwrap_err().to_string();
        assert_eq!(relative(&batches, &log), relative(&read_log(&log).unwrap_err().to_string(), &log));
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1, "{batches}");
    }
}

#[test]
fn progress_runs_from_nought_to_one_and_can_stop() {
    let directory = tempfile::tempdir().unwrap();
    for name in ["log.csv", "log.csv.gz"] {
        let (log, out) = (directory.path().join(name), directory.path().join("out.parquet"));
        write_csv(&log, &synthetic_log(1, 300_000, false)).unwrap();
        let mut parts = Vec::new();
        convert(&log, &out, LogTarget::Parquet, |part| {
            parts.push(part);
            true
        })
        .unwrap();
        assert_eq!(parts.len(), 5, "one for each batch");
        assert!(parts.windows(2).all(|pair| pair[0] < pair[1] || pair[1] == 1.0), "{parts:?}");
        assert!((0.1..0.4).contains(&parts[0]) && parts.last() == Some(&1.0), "{parts:?}");
        fs::remove_file(&out).unwrap();
        let stopped = convert(&log, &out, LogTarget::Parquet, |part| part < 0.3).unwrap_err();
        assert!(matches!(&stopped, LogError::Stopped { path } if *path == out), "{stopped}");
        assert!(!out.exists());
    }
}

#[test]
fn trees_for_viewers_have_unique_names_and_read_back() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("tree.csv");
    let log = synthetic_log(2, 10, true);
    write_log(&path, &log, LogTarget::Csv(ColumnNames::Tree)).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    let header = text.lines().next().unwrap();
    assert!(header.starts_with("time,/joint_0/q,/joint_1/q,/joint_0/dq,"), "{header}");
    assert!(header.ends_with("/temperature_ambient,/O_F_ext/force/x,/O_F_ext/force/y,/O_F_ext/force/z,/O_F_ext/moment/x,/O_F_ext/moment/y,/O_F_ext/moment/z"));
    let mut names: Vec<&str> = header.split(',').collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), log.named().len());
    assert_eq!(bits(&read_log(&path).unwrap().0), bits(&log));
    // Both forms of one column.
    fs::write(&path, text.replacen("/joint_1/q,", "q_0,", 1)).unwrap();
    let error = relative(&read_log(&path).unwrap_err().to_string(), &path);
    assert_eq!(error, "tree.csv: column `q_0` occurs twice, as columns 2 and 3");
    assert_eq!(detect(&path).unwrap().to_string(), "canonical CSV");
}
