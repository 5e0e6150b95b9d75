//! Whole campaigns as a user runs them: `cargo bench -p tribo-cli --bench campaign`.
//!
//! `tribo tune --trials 50 --stop-below never` of the built binary, disk and report included, on at most two threads: time on the wall and peak memory
//! of the process (`VmHWM` of Linux, read while it runs), medians of `REPEATS` (5) runs. `STRATEGIES="grey_box paper"` in the
//! environment chooses others.

use std::path::Path;
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

fn main() -> ExitCode {
    let variable = |name: &str, usual: &str| std::env::var(name).unwrap_or_else(|_| usual.to_owned());
    let repeats = variable("REPEATS", "5").parse::<usize>().unwrap_or(5).max(1);
    let strategies = variable("STRATEGIES", "grey_box paper bo composite random");
    println!("{:<12} {:>8} {:>12}", "strategy", "wall [s]", "memory [MB]");
    for strategy in strategies.split_whitespace() {
        let (mut walls, mut peaks) = (Vec::new(), Vec::new());
        for _ in 0..repeats {
            match run(strategy) {
                Ok((wall_s, peak_mb)) => {
                    walls.push(wall_s);
                    peaks.push(peak_mb);
                }
                Err(error) => {
                    eprintln!("{strategy}: {error}");
                    return ExitCode::FAILURE;
                }
            }
        }
        println!("{strategy:<12} {:>8.2} {:>12.1}", median(&mut walls), median(&mut peaks));
    }
    ExitCode::SUCCESS
}

/// One campaign: wall (s), peak memory (MB).
fn run(strategy: &str) -> std::io::Result<(f64, f64)> {
    let scratch = tempfile::tempdir()?;
    let started = Instant::now();
    let mut campaign = start(strategy, &scratch.path().join("campaign"))?;
    let status = format!("/proc/{}/status", campaign.id());
    let mut peak_mb = f64::NAN;
    loop {
        // The last reading is at most a pause older than the end; the peak is reached before the report.
        peak_mb = peak_mb.max(std::fs::read_to_string(&status).ok().and_then(|text| peak(&text)).unwrap_or(f64::NAN));
        if let Some(ended) = campaign.try_wait()? {
            let wall_s = started.elapsed().as_secs_f64();
            return if ended.success() { Ok((wall_s, peak_mb)) } else { Err(std::io::Error::other(ended.to_string())) };
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn start(strategy: &str, out: &Path) -> std::io::Result<Child> {
    Command::new(env!("CARGO_BIN_EXE_tribo"))
        .args([
            "tune",
            "--trials",
            "50",
            "--stop-below",
            "never",
            "--strategy",
            strategy,
            "--threads",
            "2",
            "--quiet",
            "--out",
        ])
        .arg(out)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
}

fn peak(status: &str) -> Option<f64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kib| kib * 1024e-6)
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
