//! Conversion in batches of rows: the same file, the same summary and the same errors as by way of the whole log.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::cell::RefCell;
use std::fs;
use std::path::Path;
use std::rc::Rc;

use tribo_files::LogError;
use tribo_logs::{ColumnNames, LogTarget, convert, detect, read_log, read_log_watched, write_csv, write_log};

use crate::common::{bits, libfranka_csv, pack, relative, synthetic_log};

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
    fs::write(&path, crate::common::kinova_csv(20)).unwrap();
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
        let heard = Rc::new(RefCell::new(Vec::new()));
        let parts = Rc::clone(&heard);
        convert(&log, &out, LogTarget::Parquet, move |part| {
            parts.borrow_mut().push(part);
            true
        })
        .unwrap();
        let parts = heard.take();
        assert_eq!(parts.len(), 5, "one for each batch");
        assert!(parts.windows(2).all(|pair| pair[0] < pair[1] || pair[1] == 1.0), "{parts:?}");
        assert!((0.1..0.4).contains(&parts[0]) && parts.last() == Some(&1.0), "{parts:?}");
        fs::remove_file(&out).unwrap();
        let stopped = convert(&log, &out, LogTarget::Parquet, |part| part < 0.3).unwrap_err();
        assert!(matches!(&stopped, LogError::Stopped { path } if *path == out), "{stopped}");
        assert!(!out.exists());
    }
}

/// Every format tells how far it has come while it is read as a whole, and can be stopped.
#[test]
fn reading_tells_how_far_it_has_come_and_can_stop() {
    let directory = tempfile::tempdir().unwrap();
    let log = synthetic_log(2, 60_000, false);
    for name in ["log.csv", "log.csv.gz", "log.parquet", "log.mcap"] {
        let path = directory.path().join(name);
        let target = match name.rsplit('.').next() {
            Some("parquet") => LogTarget::Parquet,
            Some("mcap") => LogTarget::Mcap,
            _ => LogTarget::Csv(ColumnNames::Canonical),
        };
        write_log(&path, &log, target).unwrap();
        let heard = Rc::new(RefCell::new(Vec::new()));
        let parts = Rc::clone(&heard);
        let (read, _) = read_log_watched(&path, move |part| {
            parts.borrow_mut().push(part);
            true
        })
        .unwrap();
        assert_eq!(read, log, "{name}");
        let parts = heard.take();
        assert!(parts.len() >= 2 && parts.windows(2).all(|pair| pair[0] <= pair[1]), "{name}: {parts:?}");
        assert!(
            parts.iter().all(|part| (0.0..=1.0).contains(part)) && *parts.last().unwrap() > 0.5,
            "{name}: {parts:?}"
        );
        let stopped = read_log_watched(&path, |part| part < 0.3).unwrap_err();
        assert!(matches!(&stopped, LogError::Stopped { path: named } if *named == path), "{name}: {stopped}");
    }
}

/// Gzip holds a thousand times its size: 260 MB of blank lines in 1.2 MB are not unpacked to their end.
#[test]
fn a_packed_text_has_a_limit() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.csv.gz");
    let mut encoder = flate2::write::GzEncoder::new(fs::File::create(&path).unwrap(), flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, b"time,q_0,dq_0,tau_J_0\n0,1,2,3\n1,1,2,4\n").unwrap();
    for _ in 0..260 {
        std::io::Write::write_all(&mut encoder, &[b'\n'; 1 << 20]).unwrap();
    }
    encoder.finish().unwrap();
    let error = read_log(&path).unwrap_err().to_string();
    assert!(error.contains("log.csv.gz: damaged or cut off: unpacks to more than 268435456 bytes from "), "{error}");
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

/// An encoder that freezes after the first batch of rows is as frozen as one that does before.
#[test]
fn what_is_wrong_with_a_later_batch_is_said() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.csv");
    let mut columns = synthetic_log(1, 1 << 17, false).into_columns();
    let rate = 2.0 * std::f64::consts::PI * 0.5;
    for (k, time_s) in columns.time_s.iter().enumerate() {
        columns.q_rad[0][k] = 0.5 * (rate * time_s.min(90.0)).sin();
        columns.dq_rad_s[0][k] = 0.5 * rate * (rate * time_s).cos();
    }
    write_csv(&path, &columns.validate().unwrap()).unwrap();
    let said = convert(&path, directory.path().join("out.parquet"), LogTarget::Parquet, |_| true).unwrap().remarks;
    assert!(said.iter().any(|remark| remark.fault == tribo_logs::recognise::Fault::FrozenEncoder), "{said:?}");
}
