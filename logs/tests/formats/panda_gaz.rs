//! The Panda text files: synthetic ones for every error, the real ones (`TRIBO_DATA`) for the numbers.

#![allow(clippy::unwrap_used, reason = "tests")]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::bits;
use tempfile::TempDir;
use tribo_logs::{
    LogFormat, Resampling, bursts, median_period_s, read_log, read_panda_gaz, resample, row, write_csv, write_parquet,
};

/// Four rows, the third repeating the second under a new stamp.
fn synthetic() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("exciting_traj_time.txt"), "0\n0.001\n0.002\n0.003\n").unwrap();
    for (name, offset) in [("positions", 0.0), ("velocity", 100.0), ("torques", 200.0)] {
        let mut text = String::new();
        for source in [0, 1, 1, 3] {
            (0..7).for_each(|joint| writeln!(text, "{}", offset + f64::from(10 * source + joint)).unwrap());
        }
        fs::write(directory.path().join(format!("exciting_traj_{name}.txt")), text).unwrap();
    }
    directory
}

fn error_after(file: &str, edit: impl Fn(String) -> String) -> String {
    let directory = synthetic();
    let path = directory.path().join(file);
    fs::write(&path, edit(fs::read_to_string(&path).unwrap())).unwrap();
    let text = read_log(directory.path()).unwrap_err().to_string();
    text.replace(&format!("{}/", directory.path().display()), "")
}

#[test]
fn rows_are_read_and_repeats_dropped() {
    let directory = synthetic();
    // A recording of something else beside them.
    fs::write(directory.path().join("other.mcap"), "").unwrap();
    let (log, summary) = read_log(directory.path()).unwrap();
    assert_eq!(log.time_s, [0.0, 0.001, 0.003]);
    assert_eq!(row::<7>(&log.q_rad, 2), [30.0, 31.0, 32.0, 33.0, 34.0, 35.0, 36.0]);
    assert_eq!((log.dq_rad_s[6][1], log.tau_j_nm[0][0]), (116.0, 200.0));
    assert_eq!((summary.format, summary.rows_read(), summary.dropped_repeats), (LogFormat::PandaGaz, 4, 1));
}

#[test]
fn errors_name_file_line_and_numbers() {
    let text = error_after("exciting_traj_velocity.txt", |t| t.replacen("103\n", "103x\n", 1));
    assert_eq!(text, "exciting_traj_velocity.txt:4: column dq: `103x` is not a finite decimal number");
    let text = error_after("exciting_traj_torques.txt", |t| t.trim_end().rsplit_once('\n').unwrap().0.to_owned());
    assert_eq!(
        text,
        "exciting_traj_torques.txt: 27 values, expected 28 = 7 per stamp for the 4 stamps of exciting_traj_time.txt"
    );
    let text = error_after("exciting_traj_time.txt", |t| t.replace("0.003", "0.0005"));
    assert_eq!(text, "exciting_traj_time.txt:4: column time: 0.0005 s does not exceed the stamp before, 0.001 s");
    let directory = synthetic();
    fs::remove_file(directory.path().join("exciting_traj_positions.txt")).unwrap();
    let text = read_panda_gaz(directory.path()).unwrap_err().to_string();
    assert!(text.ends_with("exciting_traj_positions.txt: no such file or directory"), "{text}");
}

/// The real data, or a loud word that it is not here.
fn real_data() -> Option<PathBuf> {
    let fallback = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let path = std::env::var_os("TRIBO_DATA").map_or(fallback, PathBuf::from).join("panda_gaz2019");
    if !path.is_dir() {
        eprintln!("SKIPPED: {} not found (set TRIBO_DATA)", path.display());
    }
    path.is_dir().then_some(path)
}

#[test]
fn the_real_log_has_the_published_size_and_survives_conversion() {
    let Some(path) = real_data() else { return };
    let (log, summary) = read_log(&path).unwrap();
    println!("{summary}");
    assert_eq!((summary.rows_read(), summary.dropped_repeats, summary.rows), (20_544, 1131, 19_413));
    assert!((summary.duration_s - 21.0).abs() < 0.01, "{}", summary.duration_s);
    assert!((summary.rate_hz - 1000.0).abs() < 1.0, "{}", summary.rate_hz);
    assert_eq!(row::<7>(&log.q_rad, 0)[..3], [-0.9584, 0.5622, -1.4576]);
    // The numbers of the doc of `bursts`.
    for (tolerance, expected) in [(1.5, 1360), (3.0, 49), (5.0, 9), (10.0, 2)] {
        assert_eq!(bursts(&log.time_s, tolerance).len(), expected, "tolerance {tolerance}");
    }
    // Through both formats, to the bit.
    let directory = tempfile::tempdir().unwrap();
    let (csv, parquet) = (directory.path().join("gaz.csv.gz"), directory.path().join("gaz.parquet"));
    write_csv(&csv, &log).unwrap();
    write_parquet(&parquet, &log).unwrap();
    assert_eq!(bits(&read_log(&csv).unwrap().0), bits(&log));
    assert_eq!(bits(&read_log(&parquet).unwrap().0), bits(&log));
}

#[test]
fn the_real_log_resamples_to_one_kilohertz() {
    let Some(path) = real_data() else { return };
    let (log, _) = read_log(&path).unwrap();
    let settings = Resampling { period_s: Some(1e-3), gap_tolerance: 10.0, ..Resampling::default() };
    let resampled = resample(&log, &settings).unwrap();
    let rows: usize = resampled.bursts.iter().map(|burst| burst.rows()).sum();
    assert!((20_980..=21_000).contains(&rows), "{rows} rows of 1 ms in 21.0 s");
    let burst = &resampled.bursts[0];
    assert!((median_period_s(&burst.time_s).unwrap() - 1e-3).abs() < 1e-9);
    for joint in 0..7 {
        let range = |column: &[f64]| column.iter().fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
        let ((low, high), (low_raw, high_raw)) = (range(&burst.q_rad[joint]), range(&log.q_rad[joint]));
        assert!(low > low_raw - 1e-4 && high < high_raw + 1e-4, "overshoot below the stamp jitter of 0.2 mrad");
    }
}
