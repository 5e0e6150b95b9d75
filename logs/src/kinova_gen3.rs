//! The Kinova Gen3 data (7 joints) of `dynamic-identification`: one CSV per motion, plain or gzip.
//!
//! ```text
//! time = Time · 1 ms   q = unwrap(Position)   dq = Velocity   tau_J = TorqueCur   tau_link = TorqueSm   temperature = Temp
//! unwrap(x)_k = x_k + 2π n_k,   n_k the integer that leaves |q_k − q_{k−1}| <= π
//! ```
//!
//! `Time` is a sample index; a lost index is a gap. `TorqueCur` is the motor torque through the gear, from the current
//! (9.13 Nm/A in joints 1–4, 5.85 Nm/A in 5–7); `TorqueSm` is the torque sensor behind the gear. Both have the sign of the
//! torque on the link: in the two published logs that have both they correlate by +0.28 to +0.998 in every joint, and
//! `TorqueCur − TorqueSm`, which is friction and rotor inertia, by +0.18 to +0.89 with the velocity.
//!
//! The recorder writes zero for what it did not measure:
//! - `TorqueCur` zero throughout is an error;
//! - a joint whose `TorqueSm` (or `Temp`) is zero throughout takes the quantity from the log, with a warning if other
//!   joints have it; `RunTrajectory1` lacks joint 1;
//! - other rows with a zero in `TorqueSm` are dropped and counted as incomplete; the published logs have none.
//!
//! Up to 1 % of the rows repeat q, dq and tau of the row before while the index moves on. They stay, because the clock
//! is regular and each is only one period old, and a warning counts them. In the published logs no `Position` wraps, and
//! `Velocity` follows the slope of `Position` one sample late.
//! Leaves out: `Torque` (computed by a model), `Cur` (proportional to `TorqueCur`) and the commanded values (`…Cmptd`).
//!
//! Source: <https://github.com/wissem01chiha/dynamic-identification>, folder `data/kinova`.

use std::f64::consts::{PI, TAU};
use std::io::BufRead;

use tribo_files::csv_lines::Lines;
use tribo_files::{LogError, LogFile};

use crate::csv_rows::{Clock, CsvRows};
use crate::format::LogFormat;
use crate::header::{Header, positions_by_name};
use crate::log::RobotLog;
use crate::quantity::Quantity;
use crate::summary::LogSummary;

/// Joints of the arm.
const JOINTS: usize = 7;

/// The sample index; one sample is 1 ms: so is the slope of `Position` per index, over `Velocity`.
const INDEX: &str = "Time";

/// The quantities read, one column per joint, joints from 1.
const READ: [(&str, Quantity); 5] = [
    ("Position", Quantity::Position),
    ("Velocity", Quantity::Velocity),
    ("TorqueCur", Quantity::Torque),
    ("TorqueSm", Quantity::LinkTorque),
    ("Temp", Quantity::Temperature),
];

/// The quantities known and left out.
const LEFT_OUT: [&str; 6] = ["Torque", "Cur", "PositionCmptd", "VelocityCmptd", "AccCmptd", "TorqueCmptd"];

/// Whether a header looks like this data set: the reader then says what is wrong with it.
pub(crate) fn is_kinova_gen3(names: &[String]) -> bool {
    [INDEX, "Position1", "TorqueSm1", "TorqueCur1"].iter().all(|wanted| names.iter().any(|name| name == wanted))
}

/// Reads one CSV of the data set, plain or gzip: [`LogError::NotLogged`] for a joint without `TorqueCur`, [`LogError::BadLine`] for an
/// index that is no whole number, otherwise as [`read_csv`](crate::read_csv).
pub(crate) fn kinova_gen3(file: &LogFile) -> Result<(RobotLog, LogSummary), LogError> {
    let path = file.path;
    let (mut columns, end) = rows(file)?.into_columns(None)?;
    let mut warnings = end.warnings;

    // What was measured.
    let row_count = columns.rows();
    if let Some(joint) = columns.tau_j_nm.iter().position(|column| never_logged(column)) {
        let column = format!("TorqueCur{}", joint + 1);
        return Err(LogError::NotLogged { column, rows: row_count }.in_file(path));
    }
    columns.tau_link_nm = columns.tau_link_nm.and_then(|link| measured("TorqueSm", link, &mut warnings));
    columns.temperature_c = columns.temperature_c.and_then(|warm| measured("Temp", warm, &mut warnings));
    let unwrapped_jumps = columns.q_rad.iter_mut().map(|angle_rad| unwrap_angle(angle_rad)).sum();

    // The rows kept.
    let is_complete = |k: usize| columns.tau_link_nm.iter().flatten().all(|column| column[k] != 0.0);
    let kept: Vec<usize> = (0..row_count).filter(|&k| is_complete(k)).collect();
    let log = columns.map(|_, column| kept.iter().map(|&k| column[k]).collect());
    let log = log.validate().map_err(|error| error.in_file(path))?;

    // What to know about it.
    let stale = stale_rows(&log);
    if stale > 0 {
        warnings.push(format!("{stale} rows repeat the positions, velocities and torques of the row before; kept"));
    }
    let mut summary = LogSummary::new(LogFormat::KinovaGen3, &log, end.dropped_repeats, end.unknown);
    summary.dropped_incomplete = row_count - kept.len();
    summary.unwrapped_jumps = unwrapped_jumps;
    summary.warnings.extend(warnings);
    Ok((log, summary))
}

/// The rows of a file, header read.
fn rows<'p>(file: &LogFile<'p>) -> Result<CsvRows<'p, Box<dyn BufRead>>, LogError> {
    let path = file.path;
    let mut lines = Lines::new(file.open_text("CSV")?.0, path);
    let (names, delimiter) = lines.header()?;
    let header = placed(&names).map_err(|error| error.in_file(path))?;
    Ok(CsvRows::new(lines, path, LogFormat::KinovaGen3, &names, delimiter, header, Clock::SampleIndex))
}

/// Where every column read stands, the index first.
fn placed(names: &[String]) -> Result<Header, LogError> {
    let position_of = positions_by_name(names)?;
    let (mut positions, mut missing, unknown) = (Vec::new(), Vec::new(), unknown(names));
    for name in std::iter::once(INDEX.to_owned()).chain(READ.into_iter().flat_map(|(stem, _)| of_joints(stem))) {
        match position_of.get(name.as_str()) {
            Some(&position) => positions.push(position),
            None => missing.push(name),
        }
    }
    if !missing.is_empty() {
        return Err(LogError::MissingColumns { missing, unknown });
    }
    let quantities = std::iter::once(Quantity::Time).chain(READ.map(|(_, quantity)| quantity)).collect();
    Ok(Header { joints: JOINTS, quantities, positions, unknown })
}

/// The names that are neither read nor knowingly left out.
fn unknown(names: &[String]) -> Vec<String> {
    let known: Vec<String> = READ.map(|(stem, _)| stem).into_iter().chain(LEFT_OUT).flat_map(of_joints).collect();
    names.iter().filter(|name| *name != INDEX && !known.contains(name)).cloned().collect()
}

/// The columns of a quantity, joints from 1.
fn of_joints(stem: &'static str) -> impl Iterator<Item = String> {
    (1..=JOINTS).map(move |joint| format!("{stem}{joint}"))
}

fn never_logged(column: &[f64]) -> bool {
    column.iter().all(|&value| value == 0.0)
}

/// The columns if every joint has them; if only some do, a warning says which do not.
fn measured(stem: &str, columns: Vec<Vec<f64>>, warnings: &mut Vec<String>) -> Option<Vec<Vec<f64>>> {
    let absent: Vec<String> = (0..JOINTS)
        .filter(|&joint| never_logged(&columns[joint]))
        .map(|joint| format!("{stem}{}", joint + 1))
        .collect();
    if !absent.is_empty() && absent.len() < JOINTS {
        warnings.push(format!("{} zero throughout: {stem} of the other joints left out too", absent.join(", ")));
    }
    absent.is_empty().then_some(columns)
}

/// Takes the jumps of a turn out of an angle; their number.
fn unwrap_angle(angle_rad: &mut [f64]) -> usize {
    let (mut turns, mut jumps, mut previous_rad) = (0.0, 0, angle_rad.first().copied().unwrap_or(0.0));
    for angle in angle_rad {
        let step_rad: f64 = *angle - previous_rad;
        if step_rad.abs() > PI {
            turns -= (step_rad / TAU).round();
            jumps += 1;
        }
        previous_rad = *angle;
        *angle += TAU * turns;
    }
    jumps
}

/// Rows whose q, dq, tau and link tau are those of the row before.
fn stale_rows(log: &RobotLog) -> usize {
    let measured = [Some(&log.q_rad), Some(&log.dq_rad_s), Some(&log.tau_j_nm), log.tau_link_nm.as_ref()];
    let same = |k: usize| measured.iter().flatten().flat_map(|columns| columns.iter()).all(|c| c[k] == c[k - 1]);
    (1..log.rows()).filter(|&k| same(k)).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_undone_and_the_rest_is_untouched() {
        // Three turns forward and back in steps of a quarter turn, wrapped to (−π, π].
        let turning: Vec<f64> = (0..=24).map(|k| f64::from(12 - i32::abs(12 - k)) * TAU / 4.0 + 0.1).collect();
        let wrapped: Vec<f64> = turning.iter().map(|angle| angle - TAU * (angle / TAU).round()).collect();
        assert!(wrapped.iter().all(|angle| angle.abs() <= PI));
        let mut found = wrapped.clone();
        assert_eq!(unwrap_angle(&mut found), 6, "three turns there, three back");
        for (got, expected) in found.into_iter().zip(turning) {
            assert!((got - expected).abs() < 1e-14, "{got} {expected}");
        }
        let mut calm = [3.0, 0.0, -3.0, 0.1];
        assert_eq!(unwrap_angle(&mut calm), 0);
        assert_eq!(calm, [3.0, 0.0, -3.0, 0.1]);
        assert_eq!(unwrap_angle(&mut []), 0);
    }
}
