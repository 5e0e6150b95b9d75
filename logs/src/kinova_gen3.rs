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
use std::path::Path;

use crate::csv_lines::{Lines, RowLayout};
use crate::error::LogError;
use crate::format::LogFormat;
use crate::header::positions_by_name;
use crate::log::{LogColumns, RobotLog};
use crate::source::open_text;
use crate::summary::LogSummary;

/// Joints of the arm.
const JOINTS: usize = 7;

/// Samples per second: the slope of `Position` per index, over `Velocity`, is 1.00 ms.
const SAMPLES_PER_S: f64 = 1000.0;

const INDEX: &str = "Time";

/// The quantities read, one column per joint, joints from 1; in the order of [`Rows::columns`].
const READ: [&str; 5] = ["Position", "Velocity", "TorqueCur", "TorqueSm", "Temp"];

/// The quantities known and left out.
const LEFT_OUT: [&str; 6] = ["Torque", "Cur", "PositionCmptd", "VelocityCmptd", "AccCmptd", "TorqueCmptd"];

/// Whether a header looks like this data set: the reader then says what is wrong with it.
pub(crate) fn is_kinova_gen3(names: &[String]) -> bool {
    [INDEX, "Position1", "TorqueSm1", "TorqueCur1"].iter().all(|wanted| names.iter().any(|name| name == wanted))
}

/// Reads one CSV file of the data set, plain or gzip.
///
/// # Errors
/// [`LogError::MissingColumns`] and [`LogError::DuplicateColumn`] for the header, [`LogError::NotLogged`] for a joint
/// without `TorqueCur`, otherwise as [`read_csv`](crate::read_csv); an index that is no whole number is
/// [`LogError::BadLine`].
pub fn read_kinova_gen3(path: impl AsRef<Path>) -> Result<(RobotLog, LogSummary), LogError> {
    let path = path.as_ref();
    let mut rows = Rows::read(path)?;
    let mut warnings = std::mem::take(&mut rows.warnings);
    let [position, velocity, motor, link, temperature] = rows.columns;

    // What was measured.
    let row_count = rows.time_s.len();
    if let Some(joint) = motor.iter().position(|column| never_logged(column)) {
        let column = format!("TorqueCur{}", joint + 1);
        return Err(LogError::NotLogged { column, rows: row_count }.in_file(path));
    }
    let link = measured("TorqueSm", link, &mut warnings);
    let temperature = measured("Temp", temperature, &mut warnings);
    let is_complete = |k: usize| link.iter().flatten().all(|column| column[k] != 0.0);
    let kept: Vec<usize> = (0..row_count).filter(|&k| is_complete(k)).collect();

    // The rows kept, by columns.
    let pick = |column: &Vec<f64>| -> Vec<f64> { kept.iter().map(|&k| column[k]).collect() };
    let pick_all = |columns: &Vec<Vec<f64>>| -> Vec<Vec<f64>> { columns.iter().map(pick).collect() };
    let log = LogColumns {
        time_s: pick(&rows.time_s),
        q_rad: position.iter().map(|column| pick(&unwrapped(column))).collect(),
        dq_rad_s: pick_all(&velocity),
        tau_j_nm: pick_all(&motor),
        tau_link_nm: link.as_ref().map(pick_all),
        temperature_c: temperature.as_ref().map(pick_all),
        ..LogColumns::default()
    };
    let log = log.validate().map_err(|error| error.in_file(path))?;

    // What to know about it.
    let stale = stale_rows(&log);
    if stale > 0 {
        warnings.push(format!("{stale} rows repeat the positions, velocities and torques of the row before; kept"));
    }
    let mut summary = LogSummary::new(LogFormat::KinovaGen3, &log, rows.dropped_repeats, rows.unknown);
    summary.dropped_incomplete = row_count - kept.len();
    summary.warnings = warnings;
    Ok((log, summary))
}

/// The file as it stands, stamps in seconds.
struct Rows {
    time_s: Vec<f64>,
    /// Quantity of [`READ`], joint, row.
    columns: [Vec<Vec<f64>>; READ.len()],
    dropped_repeats: usize,
    unknown: Vec<String>,
    warnings: Vec<String>,
}

impl Rows {
    fn read(path: &Path) -> Result<Self, LogError> {
        let (reader, _) = open_text(path, "CSV")?;
        let mut lines = Lines::new(reader, path);
        let (names, delimiter) = lines.header()?;
        let unknown = unknown(&names);
        let columns = placed(&names, &unknown).map_err(|error| error.in_file(path))?;
        let layout = RowLayout { cell_count: names.len(), delimiter, columns };

        let columns = std::array::from_fn(|_| vec![Vec::new(); JOINTS]);
        let mut rows = Self { time_s: Vec::new(), columns, dropped_repeats: 0, unknown, warnings: Vec::new() };
        let (mut cells, mut row) = (Vec::new(), vec![0.0; layout.columns.len()]);
        while lines.advance()? {
            layout.read(&lines, &mut cells, &mut row)?;
            let [index, values @ ..] = row.as_slice() else { break };
            if index.fract() != 0.0 {
                return Err(lines.bad_line(format!("column {INDEX}: {index} is no sample index")));
            }
            rows.push(index / SAMPLES_PER_S, values).map_err(|previous_s| {
                let (path, line) = (path.to_path_buf(), lines.number);
                LogError::TimeStepsBack { path, line, previous_s, value_s: index / SAMPLES_PER_S }
            })?;
        }
        rows.warnings.extend(lines.cut_off());
        Ok(rows)
    }

    /// Appends a row; a row that is exactly the one before is counted instead. The error is the stamp not exceeded.
    fn push(&mut self, stamp_s: f64, values: &[f64]) -> Result<(), f64> {
        let mut columns = self.columns.iter_mut().flatten().zip(values);
        if let Some(&previous_s) = self.time_s.last()
            && stamp_s <= previous_s
        {
            let repeats = stamp_s == previous_s && columns.all(|(c, v)| c.last() == Some(v));
            self.dropped_repeats += usize::from(repeats);
            return if repeats { Ok(()) } else { Err(previous_s) };
        }
        columns.for_each(|(column, &value)| column.push(value));
        self.time_s.push(stamp_s);
        Ok(())
    }
}

/// Name and position of every column read, the index first.
fn placed(names: &[String], unknown: &[String]) -> Result<Vec<(String, usize)>, LogError> {
    let position_of = positions_by_name(names)?;
    let (mut placed, mut missing) = (Vec::new(), Vec::new());
    for name in std::iter::once(INDEX.to_owned()).chain(READ.into_iter().flat_map(of_joints)) {
        match position_of.get(name.as_str()) {
            Some(&position) => placed.push((name, position)),
            None => missing.push(name),
        }
    }
    let unknown = unknown.to_vec();
    if missing.is_empty() { Ok(placed) } else { Err(LogError::MissingColumns { missing, unknown }) }
}

/// The names that are neither read nor knowingly left out.
fn unknown(names: &[String]) -> Vec<String> {
    let known: Vec<String> = READ.into_iter().chain(LEFT_OUT).flat_map(of_joints).collect();
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

/// The angle without jumps of a turn.
fn unwrapped(angle_rad: &[f64]) -> Vec<f64> {
    let (mut turns, mut previous_rad) = (0.0, angle_rad.first().copied().unwrap_or(0.0));
    angle_rad
        .iter()
        .map(|&wrapped_rad| {
            let step_rad: f64 = wrapped_rad - previous_rad;
            if step_rad.abs() > PI {
                turns -= (step_rad / TAU).round();
            }
            previous_rad = wrapped_rad;
            wrapped_rad + TAU * turns
        })
        .collect()
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
        for (got, expected) in unwrapped(&wrapped).into_iter().zip(turning) {
            assert!((got - expected).abs() < 1e-14, "{got} {expected}");
        }
        let calm = [3.0, 0.0, -3.0, 0.1];
        assert_eq!(unwrapped(&calm), calm);
        assert!(unwrapped(&[]).is_empty());
    }
}
