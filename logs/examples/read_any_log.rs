//! A robot log, whatever its format: read, looked at, written as Parquet.
//!
//! `cargo run --release -p tribo-logs --example read_any_log -- [LOG]`
//!
//! Without an argument a short log is written first.

use std::path::{Path, PathBuf};

use tribo_logs::{LogColumns, LogTarget, read_log, write_csv, write_log};

/// Two seconds of one joint that swings, at 500 Hz.
fn written_here(path: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let time_s: Vec<f64> = (0..1000).map(|k| f64::from(k) * 2e-3).collect();
    let of_time = |f: &dyn Fn(f64) -> f64| vec![time_s.iter().map(|&t| f(t)).collect::<Vec<f64>>()];
    let q_rad = of_time(&|t| 0.5 * (3.0 * t).sin());
    let dq_rad_s = of_time(&|t| 1.5 * (3.0 * t).cos());
    let tau_j_nm = of_time(&|t| 2.0 * (3.0 * t).cos());
    write_csv(path, &LogColumns { time_s, q_rad, dq_rad_s, tau_j_nm, ..LogColumns::default() }.validate()?)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let path = match std::env::args().nth(1) {
        Some(path) => PathBuf::from(path),
        None => {
            let path = folder.path().join("swing.csv.gz");
            written_here(&path)?;
            path
        }
    };
    let (log, summary) = read_log(&path)?;
    println!("{:?}: {} joints, {} rows", summary.format, summary.joints, summary.rows);
    println!("{:.1} s at {:.0} Hz in {} bursts", summary.duration_s, summary.rate_hz, summary.bursts);
    println!("without {:?}", summary.missing);
    for (joint, torque) in log.tau_j_nm.iter().enumerate() {
        let largest = torque.iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
        println!("joint {joint}: at most {largest:.2} Nm");
    }
    let out = folder.path().join("swing.parquet");
    write_log(&out, &log, LogTarget::of_path(&out).ok_or("an ending that is known")?)?;
    println!("the same as Parquet: {}", read_log(&out)?.0 == log);
    Ok(())
}
