//! What the tests of this folder share: a synthetic log, a file with given content.

#![allow(clippy::unwrap_used, clippy::panic, dead_code, reason = "test helpers; not every binary uses all")]

pub mod ros2;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use tribo_logs::{LogColumns, RobotLog};

/// A log whose cells use every bit of the mantissa, with all optional quantities if `full`.
pub fn synthetic_log(joints: usize, rows: usize, full: bool) -> RobotLog {
    let time_s: Vec<f64> = (0..rows).map(|k| k as f64 * 1e-3 + 1e-5 * (k as f64).sin()).collect();
    let column = |phase: f64| -> Vec<f64> { time_s.iter().map(|t| (3.0 * t + phase).sin() / 3.0).collect() };
    let per_joint = |seed: f64| -> Vec<Vec<f64>> { (0..joints).map(|j| column(seed + j as f64)).collect() };
    let some = |seed: f64| full.then(|| per_joint(seed));
    let mut log = LogColumns {
        q_rad: per_joint(0.1),
        dq_rad_s: per_joint(0.2),
        tau_j_nm: per_joint(0.3),
        tau_j_d_nm: some(0.4),
        tau_friction_nm: some(0.42),
        tau_link_nm: some(0.45),
        theta_rad: some(0.5),
        dtheta_rad_s: some(0.6),
        temperature_c: some(0.7),
        temperature_ambient_c: full.then(|| column(0.8)),
        o_f_ext: full.then(|| std::array::from_fn(|k| column(k as f64))),
        time_s,
    };
    // Values that bad number formats lose.
    let hard = [-0.0, 5e-324, f64::MAX, f64::MIN_POSITIVE, 0.1 + 0.2, 1e-300, 123_456_789.123_456_79];
    for (k, value) in hard.into_iter().enumerate().take(rows) {
        log.tau_j_nm[0][k] = value;
    }
    log.validate().unwrap()
}

/// All cells as bits: `==` alone does not tell zero from minus zero.
pub fn bits(log: &RobotLog) -> Vec<(String, Vec<u64>)> {
    log.named().into_iter().map(|(name, column)| (name, column.iter().map(|v| v.to_bits()).collect())).collect()
}

/// A Kinova Gen3 file: in row k, joint j of quantity s reads `100 s + j + k / 8`, s = 0 for `Position`, 4 for `Temp`.
pub fn kinova_csv(rows: usize) -> String {
    let stems = ["Position", "Velocity", "TorqueCur", "TorqueSm", "Temp", "Torque"];
    let names = stems.iter().flat_map(|stem| (1..=7).map(move |joint| format!("{stem}{joint}")));
    let line = |k: usize| -> Vec<String> {
        let values = (0..stems.len()).flat_map(|s| (1..=7).map(move |j| (100 * s + j) as f64 + k as f64 / 8.0));
        [k.to_string()].into_iter().chain(values.map(|v| v.to_string())).collect()
    };
    let header: Vec<String> = ["Time".to_owned()].into_iter().chain(names).collect();
    [header].into_iter().chain((0..rows).map(line)).map(|cells| cells.join(",") + "\n").collect()
}

/// What libfranka's `logToCSV` writes under its `current`, `spaced` or `legacy` header: in row k, entry j of the b-th block
/// reads `100 b + j + k / 8`; time is 5001 + k ms.
pub fn libfranka_csv(header: &str, rows: usize) -> String {
    let state = [("q", 7), ("q_d", 7), ("dq", 7), ("dq_d", 7), ("tau_J", 7), ("tau_ext_hat_filtered", 7)];
    let command = [("q_d", 7), ("dq_d", 7), ("O_T_EE_d", 16), ("O_dP_EE_d", 6), ("tau_J_d", 7)];
    let (legacy, comma) = (header == "legacy", if header == "current" { "," } else { ", " });
    let block = |prefix: &str, (name, count): (&str, usize)| -> String {
        let prefix = if legacy { "" } else { prefix };
        (0..count).map(|i| format!("{prefix}{name}[{i}]")).collect::<Vec<_>>().join(comma)
    };
    let first = if legacy { ["duration", "success rate"] } else { ["time", "success_rate"] };
    let mut names =
        vec![state.map(|named| block("state.", named)).join(","), command.map(|named| block("cmd.", named)).join(",")];
    if legacy {
        names.insert(1, "sent commands".to_owned());
    }
    let mut text = format!("{}{comma}{}\n", first.join(comma), names.join(","));
    for k in 0..rows {
        let numbers = |first: usize, blocks: &[(&str, usize)]| -> String {
            let block = |(b, &(_, count)): (usize, &(&str, usize))| {
                (0..count).map(move |j| (100 * (first + b) + j) as f64 + k as f64 / 8.0)
            };
            blocks.iter().enumerate().flat_map(block).map(|v| v.to_string()).collect::<Vec<_>>().join(",")
        };
        let middle = if legacy { ",," } else { "," };
        text += &format!("{},1,{}{middle}{}\n", 5001 + k, numbers(0, &state), numbers(6, &command));
    }
    text
}

/// The text as gzip.
pub fn pack(text: &str) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

/// A file `name` with `content` in its own directory, which lives as long as the first value.
pub fn file(name: &str, content: impl AsRef<[u8]>) -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(name);
    fs::write(&path, content).unwrap();
    (directory, path)
}

/// What remains of an error text when the directory is taken away.
pub fn relative(text: &str, path: &Path) -> String {
    text.replace(&format!("{}/", path.parent().unwrap().display()), "")
}
