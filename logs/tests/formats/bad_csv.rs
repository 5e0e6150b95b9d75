//! Every way a CSV log is strange or wrong, and what the reader says about it.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::fs;

use crate::common::{bits, file, pack, relative, synthetic_log};
use tribo_logs::{LogSummary, RobotLog, detect, read_csv, read_log, write_csv};

const GOOD: &str = "time,q_0,dq_0,tau_J_0\n0,1,2,3\n0.001,1.5,2.5,-3.5e-1\n";

fn read(content: impl AsRef<[u8]>) -> (RobotLog, LogSummary) {
    let (_directory, path) = file("log.csv", content);
    read_log(path).unwrap()
}

fn error(content: impl AsRef<[u8]>) -> String {
    let (_directory, path) = file("log.csv", content);
    relative(&read_csv(&path).unwrap_err().to_string(), &path)
}

#[test]
fn dialects_give_the_same_log() {
    let expected = bits(&read(GOOD).0);
    let semicolon = GOOD.replace(',', ";");
    for (name, text) in [
        ("byte-order mark", format!("\u{feff}{GOOD}")),
        ("CRLF", GOOD.replace('\n', "\r\n")),
        ("semicolon", semicolon.clone()),
        ("decimal comma", semicolon.replace('.', ",")),
        ("both, mark and CRLF", format!("\u{feff}{}", semicolon.replace('.', ",").replace('\n', "\r\n"))),
        ("tabulators", GOOD.replace(',', "\t")),
        ("quotes", GOOD.replace(",q_0", ",\"q_0\"").replace("1.5", "\"1.5\"")),
        ("spaces", GOOD.replace(',', " , ")),
        ("blank lines", GOOD.replace('\n', "\n\n")),
        ("no last line ending", GOOD.trim_end().to_owned()),
        ("other order", "tau_J_0,time,dq_0,q_0\n3,0,2,1\n-0.35,0.001,2.5,1.5\n".to_owned()),
        ("repeated row", GOOD.replace("0,1,2,3\n", "0,1,2,3\n0,1,2,3\n")),
    ] {
        assert_eq!(bits(&read(&text).0), expected, "{name}");
    }
}

#[test]
fn what_is_odd_but_legal_is_in_the_summary() {
    let (_, summary) = read("time,q_0,note,dq_0,tau_J_0,\n0,1,\"a, b\",2,3,\n0,1,c,2,3,\n0.5,1,,2,3,");
    assert_eq!(summary.unknown_columns, ["note", "(unnamed)"]);
    assert_eq!((summary.rows, summary.dropped_repeats, summary.rows_read()), (2, 1, 3));
    assert_eq!(summary.warnings, ["line 4 has no line ending: the file may be cut off"]);
    let table = summary.to_string();
    assert!(table.contains("rows         2 (1 repeated rows dropped)"), "{table}");
    assert!(table.contains("not known    note, (unnamed)"), "{table}");
    assert!(table.contains("absent       tau_J_d_i, tau_friction_i, tau_link_i, theta_i"), "{table}");
}

#[test]
fn stamps_that_look_like_milliseconds_are_suspected() {
    let (_, summary) = read(GOOD.replace("\n0.001", "\n1"));
    let said: Vec<String> = summary.remarks.iter().map(ToString::to_string).collect();
    let expected =
        "the stamps are 1 apart: as seconds that is no robot, as milliseconds it is 1000 Hz; divide column time by 1e3";
    assert_eq!(said, [expected]);
    assert!(summary.to_string().ends_with(&format!("warning      {expected}")), "{summary}");
    assert!(read(GOOD).1.warnings.is_empty());
}

#[test]
fn bad_cells_name_line_column_and_value() {
    for bad in ["NaN", "inf", "-Infinity", "", "abc", "1e999", "0x10", "1.2.3", "--1"] {
        let text = error(GOOD.replace("2.5", bad));
        assert_eq!(text, format!("log.csv:3: column dq_0: `{bad}` is not a finite decimal number"));
    }
    // Blank lines and CRLF do not shift the line numbers.
    let text = error(GOOD.replace('\n', "\r\n\r\n").replace("2.5", "x"));
    assert_eq!(text, "log.csv:5: column dq_0: `x` is not a finite decimal number");
    let text = error([GOOD.as_bytes(), b"0.002,\xff\x00,1,1\n"].concat());
    assert!(text.starts_with("log.csv:4: column q_0: `"), "{text}");
    // A decimal comma needs semicolons.
    assert_eq!(error(GOOD.replace("2.5", "2,5")), "log.csv:3: 5 cells, the header has 4");
}

#[test]
fn torn_rows_name_the_line() {
    assert_eq!(error(format!("{GOOD}0.002,1")), "log.csv:4: 2 cells, the header has 4");
    assert_eq!(error(format!("{GOOD}0.002,1,2,3,4\n")), "log.csv:4: 5 cells, the header has 4");
    assert_eq!(error(format!("{GOOD}0.002,\"1,2,3\n")), "log.csv:4: a quote is not closed");
    assert_eq!(error(format!("{GOOD}{}", "1".repeat(1 << 20))), "log.csv:4: longer than 1048576 bytes");
}

#[test]
fn time_that_does_not_increase_names_the_line() {
    let text = error(format!("{GOOD}0.0005,1,1,1\n"));
    assert_eq!(text, "log.csv:4: column time: 0.0005 s does not exceed the stamp before, 0.001 s");
    let text = error(format!("{GOOD}0.001,1.5,2.5,-0.36\n"));
    assert_eq!(text, "log.csv:4: column time: 0.001 s does not exceed the stamp before, 0.001 s");
}

#[test]
fn headers_name_what_is_missing_or_double() {
    let text = error(GOOD.replace("tau_J_0", "tau_J_1"));
    assert_eq!(text, "log.csv: missing columns: q_1, dq_1, tau_J_0");
    assert_eq!(error(GOOD.replace("time", "t")), "log.csv: missing column: time (not understood: t)");
    assert_eq!(error(GOOD.replace("dq_0", "q_0")), "log.csv: column `q_0` occurs twice, as columns 2 and 3");
    let text = error("time,q_0,dq_0,tau_J_0,O_F_ext_0,O_F_ext_1\n");
    assert_eq!(text, "log.csv: missing columns: O_F_ext_2, O_F_ext_3, O_F_ext_4, O_F_ext_5");
    assert_eq!(error("time,q_0,dq_0,tau_J_0\n0,1,2,3\n"), "log.csv: 1 rows, expected at least 2");
    assert_eq!(error("time,q_0,dq_0,\"tau_J_0\n"), "log.csv:1: the header has an unclosed quote or is not UTF-8");
}

#[test]
fn empty_and_foreign_files_are_told_apart() {
    for content in ["", "\n\r\n  \n"] {
        assert_eq!(error(content), "log.csv: is empty");
    }
    for (content, found) in [
        (&b"hello world\n1 2 3\n"[..], "starts with `hello world\\n1 2 3\\n`"),
        (b"\x7fELF\x02\x01", "starts with `\\u{7f}ELF"),
    ] {
        let (_directory, path) = file("x", content);
        let text = read_log(&path).unwrap_err().to_string();
        assert!(text.contains(&format!("x: unknown format ({found}")), "{text}");
    }
    let (_directory, path) = file("x", "");
    assert!(read_log(&path).unwrap_err().to_string().ends_with("x: is empty"));
}

#[test]
fn cut_gzip_is_an_error_of_the_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.csv.gz");
    write_csv(&path, &synthetic_log(2, 2000, false)).unwrap();
    let whole = fs::read(&path).unwrap();
    for length in [3, 15, whole.len() / 2, whole.len() - 4] {
        fs::write(&path, &whole[..length]).unwrap();
        let text = read_log(&path).unwrap_err().to_string();
        assert!(text.contains("log.csv.gz: damaged or cut off"), "{length}: {text}");
    }
    // Two gzip members in one file are one text.
    fs::write(&path, [pack(GOOD), pack("0.002,1,1,1\n")].concat()).unwrap();
    assert_eq!(read_log(&path).unwrap().0.rows(), 3);
}

#[test]
fn paths_that_are_no_files_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let missing = directory.path().join("none.csv");
    for text in [read_log(&missing).unwrap_err().to_string(), read_csv(&missing).unwrap_err().to_string()] {
        assert_eq!(text, format!("{}: no such file or directory", missing.display()));
    }
    let text = read_csv(directory.path()).unwrap_err().to_string();
    assert_eq!(text, format!("{}: is a directory, expected a CSV file", directory.path().display()));
    let text = detect(directory.path()).unwrap_err().to_string();
    assert!(text.contains("a directory without exciting_traj_time.txt and without .mcap"), "{text}");
    let log = synthetic_log(1, 3, false);
    assert!(write_csv(directory.path(), &log).unwrap_err().to_string().contains("is a directory"));
}

#[cfg(unix)]
#[test]
fn a_directory_that_takes_no_files_is_named() {
    use std::os::unix::fs::PermissionsExt;
    let directory = tempfile::tempdir().unwrap();
    fs::set_permissions(directory.path(), fs::Permissions::from_mode(0o500)).unwrap();
    // Root may write anywhere but into the kernel's own file systems.
    let is_root = fs::write(directory.path().join("probe"), "").is_ok();
    let closed = if is_root { std::path::Path::new("/proc") } else { directory.path() };
    let text = write_csv(closed.join("tribo.csv"), &synthetic_log(1, 3, false)).unwrap_err().to_string();
    assert!(text.starts_with(&format!("{}: cannot create a file in this directory", closed.display())), "{text}");
}
