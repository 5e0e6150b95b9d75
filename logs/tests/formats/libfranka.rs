//! The three headers of libfranka's `logToCSV`, written here as the library writes them, and every way they go wrong.

#![allow(clippy::unwrap_used, reason = "tests")]

use crate::common::{bits, file, libfranka_csv, pack, relative};
use tribo_logs::{LogFormat, LogSummary, Quantity, RobotLog, read_log};

const HEADERS: [&str; 3] = ["current", "spaced", "legacy"];

fn read(content: impl AsRef<[u8]>) -> (RobotLog, LogSummary) {
    let (_directory, path) = file("panda.csv", content);
    read_log(path).unwrap()
}

fn error(content: impl AsRef<[u8]>) -> String {
    let (_directory, path) = file("panda.csv", content);
    relative(&read_log(&path).unwrap_err().to_string(), &path)
}

#[test]
fn the_generator_writes_the_column_counts_of_the_library() {
    for (header, count) in HEADERS.into_iter().zip([87, 87, 88]) {
        let text = libfranka_csv(header, 3);
        assert!(text.lines().all(|line| line.split(',').count() == count), "{header}");
    }
    assert!(libfranka_csv("legacy", 2).starts_with("duration, success rate, q[0], q[1]"));
    assert!(libfranka_csv("spaced", 2).starts_with("time, success_rate, state.q[0], state.q[1]"));
    assert!(libfranka_csv("current", 2).starts_with("time,success_rate,state.q[0],state.q[1]"));
}

/// In `libfranka_csv`, entry j of block b in row k reads `100 b + j + k / 8`; blocks: 0 q, 1 q_d, 2 dq, 3 dq_d, 4 tau_J,
/// 5 tau_ext, 6 cmd.q_d, 7 cmd.dq_d, 8 pose, 9 twist, 10 cmd.tau_J_d.
#[test]
fn every_header_puts_every_column_in_its_place() {
    for header in HEADERS {
        let (log, summary) = read(libfranka_csv(header, 4));
        assert_eq!((summary.format, summary.rows, summary.joints), (LogFormat::Libfranka, 4, 7), "{header}");
        assert_eq!(log.time_s, [5.001, 5.002, 5.003, 5.004], "{header}");
        for joint in 0..7 {
            let expected =
                |block: f64| -> Vec<f64> { (0..4).map(|k| 100.0 * block + joint as f64 + k as f64 / 8.0).collect() };
            assert_eq!(log.q_rad[joint], expected(0.0), "{header}");
            assert_eq!(log.dq_rad_s[joint], expected(2.0), "{header}");
            assert_eq!(log.tau_j_nm[joint], expected(4.0), "{header}");
            assert_eq!(log.tau_j_d_nm.as_ref().unwrap()[joint], expected(10.0), "{header}");
        }
        assert!(summary.unknown_columns.is_empty() && summary.warnings.is_empty(), "{summary}");
        assert!(!log.has(Quantity::MotorPosition) && !log.has(Quantity::ExternalWrench));
    }
}

#[test]
fn dialects_give_the_same_log() {
    for header in HEADERS {
        let plain = libfranka_csv(header, 5);
        let expected = bits(&read(&plain).0);
        let semicolon = plain.replace(',', ";");
        for (name, text) in [
            ("byte-order mark", format!("\u{feff}{plain}")),
            ("CRLF", plain.replace('\n', "\r\n")),
            ("semicolon", semicolon.clone()),
            (
                "decimal comma, mark, CRLF",
                format!(
                    "\u{feff}{}",
                    semicolon
                        .replace('\n', "\r\n")
                        .replace('.', ",")
                        .replace("state,", "state.")
                        .replace("cmd,", "cmd.")
                ),
            ),
            ("no last line ending", plain.trim_end().to_owned()),
            ("blank lines", plain.replace('\n', "\n\n")),
            ("repeated row", plain.lines().chain(plain.lines().last()).map(|line| format!("{line}\n")).collect()),
        ] {
            assert_eq!(bits(&read(&text).0), expected, "{header}, {name}");
        }
        assert_eq!(bits(&read(pack(&plain)).0), expected, "{header}, gzip");
    }
}

#[test]
fn what_users_add_is_read_and_what_nobody_commanded_is_not() {
    // A program after the same example that also logs theta, dtheta, the state's tau_J_d and the wrench.
    let mut names = vec!["time".to_owned(), "note".to_owned()];
    for (stem, count) in
        [("q", 2), ("dq", 2), ("tau_J", 2), ("tau_J_d", 2), ("theta", 2), ("dtheta", 2), ("O_F_ext_hat_K", 6)]
    {
        names.extend((0..count).map(|i| format!("state.{stem}[{i}]")));
    }
    names.extend((0..2).map(|i| format!("cmd.tau_J_d[{i}]")));
    let row = |ms: usize| {
        (0..names.len())
            .map(|c| if c == 0 { ms.to_string() } else { (c + ms).to_string() })
            .collect::<Vec<_>>()
            .join(",")
    };
    let (log, summary) = read(format!("{}\n{}\n{}\n", names.join(","), row(0), row(3)));
    assert_eq!(log.time_s, [0.0, 0.003]);
    assert_eq!(log.tau_j_d_nm.as_ref().unwrap()[1], [9.0, 12.0], "of the state, not of the command");
    assert_eq!(log.theta_rad.as_ref().unwrap()[0], [10.0, 13.0]);
    assert_eq!(log.dtheta_rad_s.as_ref().unwrap()[1], [13.0, 16.0]);
    assert_eq!(log.o_f_ext.as_ref().unwrap()[5], [19.0, 22.0]);
    assert_eq!(summary.unknown_columns, ["note"]);

    // A motion generator commands no torque: seven columns of zeros at the end.
    for header in HEADERS {
        let text = libfranka_csv(header, 3);
        let zeros = |(line, text): (usize, &str)| match line {
            0 => format!("{text}\n"),
            _ => format!("{},0,0,0,0,0,0,0\n", text.rsplitn(8, ',').last().unwrap()),
        };
        let (log, summary) = read(text.lines().enumerate().map(zeros).collect::<String>());
        assert!(!log.has(Quantity::TorqueDesired));
        assert_eq!(summary.warnings, ["tau_J_d is zero throughout: no torque was commanded; left out"], "{header}");
        // One torque in the last row, and the columns stay.
        let late = text
            .lines()
            .enumerate()
            .map(|(line, text)| if line < 3 { zeros((line, text)) } else { format!("{text}\n") });
        assert!(read(late.collect::<String>()).0.has(Quantity::TorqueDesired), "{header}");
    }
}

#[test]
fn six_digits_and_whole_milliseconds_are_taken_as_they_are() {
    let text = libfranka_csv("current", 3).replace("5002,1,", "5002,0.98,").replace(",400.125,", ",4.00125e+02,");
    let (log, _) = read(&text);
    assert_eq!((log.time_s[1], log.tau_j_nm[0][1]), (5.002, 400.125));
    // A lost packet is a gap of two periods.
    let gap: String = libfranka_csv("legacy", 9)
        .lines()
        .enumerate()
        .filter(|(k, _)| *k != 4)
        .map(|(_, l)| format!("{l}\n"))
        .collect();
    assert_eq!(read(gap).1.bursts, 2);
}

#[test]
fn errors_name_file_line_and_column() {
    let whole = libfranka_csv("current", 3);
    let text = error(whole.replacen(",400.125,", ",nan,", 1));
    assert_eq!(text, "panda.csv:3: column state.tau_J[0]: `nan` is not a finite decimal number");
    assert_eq!(
        error(whole.replacen("5003", "5001", 1)),
        "panda.csv:4: column time: 5.001 s does not exceed the stamp before, 5.002 s"
    );
    assert_eq!(error(whole.replacen("state.dq[6]", "state.dq[x]", 1)), "panda.csv: missing column: state.dq[6]");
    assert_eq!(
        error(whole.replacen("state.dq[6]", "state.dq[5]", 1)),
        "panda.csv: column `dq_5` occurs twice, as columns 22 and 23"
    );
    assert_eq!(error(format!("{whole}5004,1,0.1")), "panda.csv:5: 3 cells, the header has 87");
    assert_eq!(error(whole.lines().next().unwrap()), "panda.csv: 0 rows, expected at least 2");
    // The legacy header doubles q_d and dq_d by design, but not q.
    let legacy = libfranka_csv("legacy", 3);
    assert_eq!(
        error(legacy.replacen(" q[1],", " q[0],", 1)),
        "panda.csv: column `q_0` occurs twice, as columns 3 and 4"
    );
    assert_eq!(error(legacy.replacen("1,,", "1,", 1).replace(",,", ",")), "panda.csv:2: 87 cells, the header has 88");
    let text = error(legacy.replacen(",400.125,", ",4x,", 1));
    assert_eq!(text, "panda.csv:3: column tau_J[0]: `4x` is not a finite decimal number");
}
