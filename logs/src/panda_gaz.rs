//! The Panda data of gaz2019 as text files in a directory.
//!
//! ```text
//! exciting_traj_time.txt                       n stamps (s), one per line
//! exciting_traj_{positions,velocity,torques}.txt   7 n values (rad), [rad/s], (Nm), one per line, row-major
//! ```
//!
//! The recorder ran faster than the robot: about 6 % of the rows repeat q, dq and tau of the row before under a new
//! stamp. They hold no measurement, so they are dropped and counted; a gap of two periods stays where they were.
//! Leaves out: `gen_*.txt`, the commanded trajectory.

use std::path::Path;

use tribo_files::csv_lines::{Lines, parse_number};
use tribo_files::{LogError, LogFile};

use crate::format::LogFormat;
use crate::log::{LogColumns, RobotLog};
use crate::summary::LogSummary;

/// Joints of the Panda.
const JOINTS: usize = 7;

const TIME_FILE: &str = "exciting_traj_time.txt";
const POSITION_FILE: &str = "exciting_traj_positions.txt";
const VELOCITY_FILE: &str = "exciting_traj_velocity.txt";
const TORQUE_FILE: &str = "exciting_traj_torques.txt";

/// Whether a directory looks like this data set: the reader then says what is wrong with it.
pub(crate) fn is_panda_gaz(directory: &Path) -> bool {
    directory.join(TIME_FILE).is_file()
}

/// Reads the four text files of `directory`.
///
/// # Errors
/// [`LogError::NotFound`] for a missing file, [`LogError::BadCell`] or [`LogError::TimeStepsBack`] with file and line,
/// [`LogError::CountMismatch`] if a file does not have seven values per stamp.
pub fn read_panda_gaz(directory: impl AsRef<Path>) -> Result<(RobotLog, LogSummary), LogError> {
    read_directory(directory.as_ref())
}

fn read_directory(directory: &Path) -> Result<(RobotLog, LogSummary), LogError> {
    // Every file whole; counts must agree before rows make sense.
    let time_path = directory.join(TIME_FILE);
    let (time_s, time_lines) = read_values(&time_path, "time")?;
    let per_joint = |name: &str, column: &str| -> Result<Vec<f64>, LogError> {
        let path = directory.join(name);
        let (values, _) = read_values(&path, column)?;
        let (stamps, expected) = (time_s.len(), JOINTS * time_s.len());
        if values.len() == expected {
            return Ok(values);
        }
        let (values, time_path) = (values.len(), time_path.clone());
        Err(LogError::CountMismatch { path, values, expected, per_stamp: JOINTS, time_path, stamps })
    };
    let q_rad = per_joint(POSITION_FILE, "q")?;
    let dq_rad_s = per_joint(VELOCITY_FILE, "dq")?;
    let tau_j_nm = per_joint(TORQUE_FILE, "tau_J")?;

    // Rows that say something new.
    let rows = [&q_rad, &dq_rad_s, &tau_j_nm];
    let repeats = |k: usize| k > 0 && rows.iter().all(|values| joints_of(values, k) == joints_of(values, k - 1));
    let kept: Vec<usize> = (0..time_s.len()).filter(|&k| !repeats(k)).collect();
    if let Some(pair) = kept.windows(2).find(|pair| time_s[pair[1]] <= time_s[pair[0]]) {
        let (path, line) = (time_path, time_lines[pair[1]]);
        return Err(LogError::TimeStepsBack { path, line, previous_s: time_s[pair[0]], value_s: time_s[pair[1]] });
    }

    // By columns.
    let columns = |values: &[f64]| -> Vec<Vec<f64>> {
        (0..JOINTS).map(|joint| kept.iter().map(|&k| values[JOINTS * k + joint]).collect()).collect()
    };
    let log = LogColumns {
        time_s: kept.iter().map(|&k| time_s[k]).collect(),
        q_rad: columns(&q_rad),
        dq_rad_s: columns(&dq_rad_s),
        tau_j_nm: columns(&tau_j_nm),
        ..LogColumns::default()
    };
    let log = log.validate().map_err(|error| error.in_file(directory))?;
    let summary = LogSummary::new(LogFormat::PandaGaz, &log, time_s.len() - kept.len(), Vec::new());
    Ok((log, summary))
}

/// The values of row `k` of a row-major file.
fn joints_of(values: &[f64], k: usize) -> &[f64] {
    &values[JOINTS * k..JOINTS * (k + 1)]
}

/// One number per line, with the line each came from.
fn read_values(path: &Path, column: &str) -> Result<(Vec<f64>, Vec<u64>), LogError> {
    let mut lines = Lines::new(LogFile::new(path).open_text("text")?.0, path);
    let (mut values, mut numbers) = (Vec::new(), Vec::new());
    while lines.advance()? {
        match parse_number(lines.text(), b',') {
            Some(value) => values.push(value),
            None => return Err(lines.bad_cell(column, lines.text())),
        }
        numbers.push(lines.number);
    }
    Ok((values, numbers))
}
