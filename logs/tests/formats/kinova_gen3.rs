//! The Kinova Gen3 files: a synthetic one for every error, the real ones (`TRIBO_DATA`) for the numbers.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::path::{Path, PathBuf};

use crate::common::{bits, file, kinova_csv, relative};
use tribo_logs::{LogFormat, LogSummary, Quantity, RobotLog, read_log, row, write_csv, write_parquet};

fn read(content: &str) -> (RobotLog, LogSummary) {
    let (_directory, path) = file("arm.csv", content);
    read_log(path).unwrap()
}

fn error(content: &str) -> String {
    let (_directory, path) = file("arm.csv", content);
    relative(&read_log(&path).unwrap_err().to_string(), &path)
}

/// The text with column `name` of the lines `rows` (from 0, header left out) replaced by `cell`.
fn with_cells(text: &str, name: &str, rows: impl Fn(usize) -> bool, cell: &str) -> String {
    let column = text.lines().next().unwrap().split(',').position(|n| n == name).unwrap();
    let edit = |(line, text): (usize, &str)| {
        let mut cells: Vec<&str> = text.split(',').collect();
        if line > 0 && rows(line - 1) {
            cells[column] = cell;
        }
        cells.join(",") + "\n"
    };
    text.lines().enumerate().map(edit).collect()
}

#[test]
fn every_column_goes_to_its_quantity() {
    let (log, summary) = read(&kinova_csv(3));
    assert_eq!(summary.format, LogFormat::KinovaGen3);
    assert_eq!(log.time_s, [0.0, 0.001, 0.002]);
    assert_eq!(row::<7>(&log.dq_rad_s, 1), [101.125, 102.125, 103.125, 104.125, 105.125, 106.125, 107.125]);
    assert_eq!((log.q_rad[0][1], log.tau_j_nm[6][2]), (1.125, 207.25));
    assert_eq!((log.tau_link_nm.as_ref().unwrap()[1][0], log.temperature_c.as_ref().unwrap()[2][0]), (302.0, 403.0));
    assert_eq!(summary.missing.len(), Quantity::ALL.len() - 6);
    assert!(summary.warnings.is_empty() && summary.unknown_columns.is_empty());
    // A wrapped position continues where it was.
    let (log, _) = read(&with_cells(&kinova_csv(3), "Position1", |k| k == 2, "-5.0331853"));
    assert!((log.q_rad[0][2] - 1.25).abs() < 1e-7, "{}", log.q_rad[0][2]);
}

#[test]
fn lost_samples_are_gaps_and_repeats_are_counted() {
    let lines: Vec<String> = kinova_csv(9).lines().map(|line| format!("{line}\n")).collect();
    let (log, summary) = read(&[&lines[..4], &lines[3..4], &lines[6..]].concat().concat());
    assert_eq!(log.time_s, [0.0, 0.001, 0.002, 0.005, 0.006, 0.007, 0.008]);
    assert_eq!((summary.dropped_repeats, summary.bursts, summary.rows_read()), (1, 2, 8));
    let text = error(&[&lines[..4], &lines[2..3]].concat().concat());
    assert_eq!(text, "arm.csv:5: column time: 0.001 s does not exceed the stamp before, 0.002 s");
    // The same measurement under a new index.
    let stale = lines[3].replacen('2', "3", 1);
    let (log, summary) = read(&[&lines[..4], &[stale]].concat().concat());
    assert_eq!((log.rows(), summary.dropped_repeats), (4, 0));
    assert_eq!(summary.warnings, ["1 rows repeat the positions, velocities and torques of the row before; kept"]);
}

#[test]
fn zero_means_not_logged() {
    let whole = kinova_csv(5);
    let text = error(&with_cells(&whole, "TorqueCur3", |_| true, "0"));
    assert_eq!(text, "arm.csv: column TorqueCur3 is zero in all 5 rows: not logged");
    // Some rows of the sensor: the complete ones stay.
    let (log, summary) = read(&with_cells(&whole, "TorqueSm2", |k| k < 2, "0"));
    assert_eq!((log.time_s[0], summary.dropped_incomplete, summary.rows_read()), (0.002, 2, 5));
    assert!(summary.to_string().contains("rows         3 (0 repeated rows dropped, 2 incomplete)"), "{summary}");
    // One joint of it: no link torque.
    let (log, summary) = read(&with_cells(&whole, "TorqueSm1", |_| true, "0"));
    assert_eq!((log.rows(), log.has(Quantity::LinkTorque)), (5, false));
    assert_eq!(summary.warnings, ["TorqueSm1 zero throughout: TorqueSm of the other joints left out too"]);
    // All of it, and no temperature.
    let none = (1..=7).fold(whole, |text, j| with_cells(&text, &format!("TorqueSm{j}"), |_| true, "0"));
    let (log, summary) = read(&with_cells(&none, "Temp7", |_| true, "0.0"));
    assert_eq!((log.has(Quantity::LinkTorque), log.has(Quantity::Temperature)), (false, false));
    assert_eq!(summary.warnings, ["Temp7 zero throughout: Temp of the other joints left out too"]);
}

#[test]
fn errors_name_file_line_and_column() {
    let whole = kinova_csv(3);
    assert_eq!(
        error(&whole.replacen("Velocity7", "Speed7", 1)),
        "arm.csv: missing column: Velocity7 (not understood: Speed7)"
    );
    assert_eq!(
        error(&whole.replacen("Temp2", "Temp1", 1)),
        "arm.csv: column `Temp1` occurs twice, as columns 30 and 31"
    );
    let text = error(&with_cells(&whole, "Temp2", |k| k == 1, "warm"));
    assert_eq!(text, "arm.csv:3: column Temp2: `warm` is not a finite decimal number");
    let text = error(&with_cells(&whole, "Time", |k| k == 1, "0.001"));
    assert_eq!(text, "arm.csv:3: column Time: 0.001 is no sample index");
    assert_eq!(error(&format!("{whole}3,1\n")), "arm.csv:5: 2 cells, the header has 43");
}

/// One of the real files, or a loud word that it is not here.
fn real_data(name: &str) -> Option<PathBuf> {
    let fallback = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let path = std::env::var_os("TRIBO_DATA").map_or(fallback, PathBuf::from).join("kinova_gen3").join(name);
    if !path.is_file() {
        eprintln!("SKIPPED: {} not found (set TRIBO_DATA)", path.display());
    }
    path.is_file().then_some(path)
}

/// Standard deviation over all rows.
fn deviation(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// Rows, duration, stale rows, and per joint the standard deviation of `TorqueCur − TorqueSm` (Nm) and the largest
/// speed (rad/s), by Python's `csv` and plain sums, printed to the digits given.
#[test]
fn the_real_logs_have_the_numbers_of_python() {
    for (name, rows, stale, torque_nm, speed_rad_s) in [
        (
            "opti_traj_testing1.csv.gz",
            4741,
            23,
            [3.841050, 1.528067, 3.790941, 3.711019, 0.933842, 0.820032, 1.662675],
            [0.925, 0.853, 1.288, 0.802, 1.162, 0.494, 0.852],
        ),
        (
            "opti_traj_testing2.csv.gz",
            2294,
            11,
            [3.094221, 6.061105, 3.181075, 2.729383, 0.906664, 0.583484, 0.968574],
            [1.281, 1.296, 1.291, 1.275, 1.147, 0.781, 1.164],
        ),
    ] {
        let Some(path) = real_data(name) else { return };
        let (log, summary) = read_log(&path).unwrap();
        println!("{name}\n{summary}");
        assert_eq!((summary.format, summary.rows, summary.rows_read()), (LogFormat::KinovaGen3, rows, rows));
        assert_eq!((summary.dropped_incomplete, summary.bursts), (0, 1));
        assert!((log.duration_s() - (rows - 1) as f64 * 1e-3).abs() < 1e-9 && (summary.rate_hz - 1e3).abs() < 1e-6);
        assert!(summary.warnings[0].starts_with(&format!("{stale} rows repeat")), "{:?}", summary.warnings);
        assert!(summary.unknown_columns.is_empty(), "{:?}", summary.unknown_columns);
        let link = log.tau_link_nm.as_ref().unwrap();
        for joint in 0..7 {
            let lost: Vec<f64> =
                log.tau_j_nm[joint].iter().zip(&link[joint]).map(|(motor, link)| motor - link).collect();
            assert!((deviation(&lost) - torque_nm[joint]).abs() < 1e-6, "{name} joint {joint}: {}", deviation(&lost));
            let speed = log.dq_rad_s[joint].iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            assert!((speed - speed_rad_s[joint]).abs() < 5.1e-4, "{name} joint {joint}: {speed}");
            let steps = log.q_rad[joint].windows(2).map(|pair| (pair[1] - pair[0]).abs());
            assert!(steps.fold(0.0, f64::max) < 3e-3, "no jump in {name} joint {joint}");
        }
        // Through both formats, to the bit.
        let directory = tempfile::tempdir().unwrap();
        let (csv, parquet) = (directory.path().join("gen3.csv.gz"), directory.path().join("gen3.parquet"));
        write_csv(&csv, &log).unwrap();
        write_parquet(&parquet, &log).unwrap();
        assert_eq!(bits(&read_log(&csv).unwrap().0), bits(&log));
        assert_eq!(bits(&read_log(&parquet).unwrap().0), bits(&log));
    }
}

#[test]
fn the_other_real_logs_have_no_link_torque() {
    for (name, rows, warned) in [
        ("RunTrajectory1.csv.gz", 1942, Some("TorqueSm1 zero throughout: TorqueSm of the other joints left out too")),
        ("RecordTrajectory_quadratic.csv.gz", 4945, None),
        ("joint_2_trapez.csv.gz", 2767, None),
    ] {
        let Some(path) = real_data(name) else { return };
        let (log, summary) = read_log(&path).unwrap();
        assert_eq!((log.rows(), log.has(Quantity::LinkTorque), log.has(Quantity::Temperature)), (rows, false, true));
        assert_eq!(summary.warnings.iter().find(|w| w.contains("TorqueSm")).map(String::as_str), warned, "{name}");
    }
}
