//! Every text format in every shape that people's files come in: either the same log to the bit, or an error that names
//! file, line and column.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::fs;

use crate::common::{bits, file, kinova_csv, libfranka_csv, pack, relative, synthetic_log};
use tribo_logs::{ColumnNames, LogSummary, LogTarget, RobotLog, read_log, write_log};

const ROWS: usize = 9;

/// Name, text of nine rows 1 ms apart, name of the first column of torque.
fn formats() -> Vec<(&'static str, String, &'static str)> {
    let written = |names| {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("log.csv");
        let mut columns = synthetic_log(2, ROWS, true).into_columns();
        columns.time_s = (0..ROWS).map(|k| k as f64 / 1e3).collect();
        // Cells without exponents: some programs do not write them.
        columns.tau_j_nm[0] = vec![0.25; ROWS];
        write_log(&path, &columns.validate().unwrap(), LogTarget::Csv(names)).unwrap();
        fs::read_to_string(path).unwrap()
    };
    vec![
        ("canonical", written(ColumnNames::Canonical), "tau_J_0"),
        ("tree", written(ColumnNames::Tree), "/joint_0/tau_J"),
        ("libfranka current", libfranka_csv("current", ROWS), "state.tau_J[0]"),
        ("libfranka spaced", libfranka_csv("spaced", ROWS), "state.tau_J[0]"),
        ("libfranka legacy", libfranka_csv("legacy", ROWS), "tau_J[0]"),
        ("kinova", kinova_csv(ROWS), "TorqueCur1"),
    ]
}

fn read(content: impl AsRef<[u8]>) -> (RobotLog, LogSummary) {
    let (_directory, path) = file("log.csv", content);
    read_log(path).unwrap()
}

fn error(content: impl AsRef<[u8]>) -> String {
    let (_directory, path) = file("log.csv", content);
    relative(&read_log(&path).unwrap_err().to_string(), &path)
}

/// The text with the lines after the header changed.
fn rows(text: &str, edit: impl Fn(usize, &str) -> Option<String>) -> String {
    let line = |(k, line): (usize, &str)| if k == 0 { Some(line.to_owned()) } else { edit(k, line) };
    text.lines().enumerate().filter_map(line).map(|line| line + "\n").collect()
}

/// The text with one cell changed; lines from 1, columns by name.
fn cell(text: &str, at: usize, column: &str, edit: impl Fn(&str) -> String) -> String {
    let place = text.lines().next().unwrap().split(',').position(|name| name.trim() == column).unwrap();
    let changed = |line: &str| -> String {
        let cells = line.split(',').enumerate().map(|(k, old)| if k == place { edit(old) } else { old.to_owned() });
        cells.collect::<Vec<_>>().join(",")
    };
    rows(text, |k, line| Some(if k + 1 == at { changed(line) } else { line.to_owned() }))
}

#[test]
fn shapes_that_say_the_same_are_read_the_same() {
    for (format, text, _) in formats() {
        let expected = bits(&read(&text).0);
        assert_eq!(expected[0].1.len(), ROWS, "{format}");
        let with = |delimiter: &str| text.replace(',', delimiter);
        let comma = rows(&with(";"), |_, line| Some(line.replace('.', ",")));
        for (shape, bytes) in [
            ("byte-order mark", format!("\u{feff}{text}").into_bytes()),
            ("CRLF", text.replace('\n', "\r\n").into_bytes()),
            ("semicolons", with(";").into_bytes()),
            ("semicolons and spaces", with(" ; ").into_bytes()),
            ("tabulators", with("\t").into_bytes()),
            ("decimal commas", comma.clone().into_bytes()),
            ("all of a spreadsheet", format!("\u{feff}{}", comma.replace('\n', "\r\n")).into_bytes()),
            ("no last line ending", text.trim_end().as_bytes().to_vec()),
            ("blank lines", text.replace('\n', "\n\n").into_bytes()),
            ("quotes", rows(&text, |_, line| Some(format!("\"{}\"", line.replace(',', "\",\"")))).into_bytes()),
            ("repeated rows", rows(&text, |_, line| Some(format!("{line}\n{line}"))).into_bytes()),
            ("gzip", pack(&text)),
        ] {
            let (log, summary) = read(bytes);
            assert_eq!(bits(&log), expected, "{format}, {shape}");
            let (repeats, cut) = (if shape == "repeated rows" { ROWS } else { 0 }, shape == "no last line ending");
            assert_eq!(
                (summary.dropped_repeats, summary.warnings.len()),
                (repeats, usize::from(cut)),
                "{format}, {shape}"
            );
        }
    }
}

#[test]
fn lost_rows_are_gaps_and_stamps_may_jitter() {
    for (format, text, _) in formats() {
        let (log, summary) = read(rows(&text, |k, line| (k != 4 && k != 5).then(|| line.to_owned())));
        assert_eq!((log.rows(), summary.bursts), (ROWS - 2, 2), "{format}");
        assert!((summary.longest_gap_s - 3e-3).abs() < 1e-12, "{format}");
        let time = text.lines().next().unwrap().split(',').next().unwrap().to_owned();
        let late = |old: &str| format!("{}", old.parse::<f64>().unwrap() * (1.0 + 1e-5) + 1e-5);
        let jittered = cell(&text, 5, &time, late);
        if format == "kinova" {
            assert!(error(jittered).contains("log.csv:5: column Time: "), "an index is whole");
        } else {
            let (log, summary) = read(jittered);
            assert_eq!((log.rows(), summary.bursts), (ROWS, 1), "{format}");
        }
    }
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    for (format, text, torque) in formats() {
        let width = text.lines().next().unwrap().split(',').count();
        for bad in ["NaN", "-inf", "", "1e999", "1.2.3", "0,5x"] {
            let found = error(cell(&text, 4, torque, |_| format!("\"{bad}\"")));
            assert_eq!(
                found,
                format!("log.csv:4: column {torque}: `{bad}` is not a finite decimal number"),
                "{format}"
            );
        }
        let torn =
            rows(&text, |k, line| Some(if k == 6 { line[..line.len() / 2].to_owned() } else { line.to_owned() }));
        let found = error(torn);
        assert!(
            found.starts_with("log.csv:7: ") && found.ends_with(&format!("cells, the header has {width}")),
            "{format}: {found}"
        );
        let cut = &text[..text.len() - text.lines().last().unwrap().len() / 2];
        let found = error(cut);
        assert!(found.starts_with("log.csv:10: ") && found.contains("cells"), "{format}: {found}");
        let packed = pack(&text);
        assert!(error(&packed[..packed.len() - 9]).starts_with("log.csv: damaged or cut off"), "{format}");
        let found = error(rows(&text, |k, line| {
            Some(if k == 3 { text.lines().nth(1).unwrap().to_owned() } else { line.to_owned() })
        }));
        assert!(
            found.starts_with("log.csv:4: column time: ") && found.contains("does not exceed the stamp before"),
            "{format}: {found}"
        );
        assert_eq!(
            error(text.lines().take(2).collect::<Vec<_>>().join("\n")),
            "log.csv: 1 rows, expected at least 2",
            "{format}"
        );

        // The torque of joint 0 named a second time, in the place of joint 1.
        let (names, rest) = text.split_once('\n').unwrap();
        let second = torque.replacen('0', "1", 1).replace("Cur1", "Cur2");
        let doubled = names
            .split(',')
            .map(|name| if name.trim() == second { torque } else { name })
            .collect::<Vec<_>>()
            .join(",");
        let found = error(format!("{doubled}\n{rest}"));
        assert!(
            found.starts_with("log.csv: column `") && found.contains("occurs twice, as columns "),
            "{format}: {found}"
        );
    }
}
