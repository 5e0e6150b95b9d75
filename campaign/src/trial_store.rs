//! Trial logs on disk: `trials/NNNN.parquet`.

use std::path::{Path, PathBuf};

use nalgebra::{SMatrix, SVector};
use tribo_logs::{Table, read_table, seal_of, write_table};

use crate::TrialLog;
use tribo_model::FileError;

/// Path of a trial's log in a campaign directory.
pub fn trial_log_path(campaign: &Path, number: usize) -> PathBuf {
    campaign.join("trials").join(format!("{number:04}.parquet"))
}

/// Name stems of the columns with one entry per joint, in the order of the fields of [`TrialLog`].
const JOINT_GROUPS: [&str; 8] = [
    "q_rad",
    "qd_rad_s",
    "tau_command_nm",
    "tau_friction_nm",
    "tau_task_nm",
    "tau_nullspace_nm",
    "tau_gravity_nm",
    "tau_coriolis_nm",
];

/// Components of the wrench in file order, and their places in `[moment; force]`.
const WRENCH: [(&str, usize); 6] = [("fx_n", 3), ("fy_n", 4), ("fz_n", 5), ("mx_nm", 0), ("my_nm", 1), ("mz_nm", 2)];
/// Components of the pose error in file order, and their places in `[rotation; position]`.
const ERROR: [(&str, usize); 6] = [("x_m", 3), ("y_m", 4), ("z_m", 5), ("rx_rad", 0), ("ry_rad", 1), ("rz_rad", 2)];

/// Writes a log atomically, to the last bit.
pub fn write_trial_log<const N: usize>(path: &Path, log: &TrialLog<N>) -> Result<(), FileError> {
    let mut columns = vec![("time_s".to_owned(), log.time_s.clone())];
    let joint_groups = [
        &log.q,
        &log.qd,
        &log.tau_command,
        &log.tau_friction,
        &log.tau_task,
        &log.tau_nullspace,
        &log.tau_gravity,
        &log.tau_coriolis,
    ];
    for (name, rows) in JOINT_GROUPS.iter().zip(joint_groups) {
        columns.extend((0..N).map(|j| (format!("{name}_{j}"), component(rows, j))));
    }
    for (axis, place) in WRENCH {
        columns.push((format!("wrench_{axis}"), component(&log.wrench, place)));
        columns.push((format!("wrench_sd_{axis}"), component(&log.wrench_sd, place)));
    }
    for (k, axis) in ["x_m", "y_m", "z_m"].iter().enumerate() {
        columns.push((format!("reference_{axis}"), component(&log.reference_position, k)));
    }
    for (axis, place) in ERROR {
        columns.push((format!("error_{axis}"), component(&log.error, place)));
    }
    let metadata = vec![("period_s".to_owned(), format!("{}", log.period_s))];
    Ok(write_table(path, &Table { columns, metadata, skipped_columns: Vec::new() })?)
}

/// Reads the log of trial `number` of a campaign; where the journal has the `seal` of what that trial left, it must be that file.
///
/// # Errors
/// A log that is missing or damaged, or that another trial left.
pub fn read_own_trial_log<const N: usize>(
    campaign: &Path,
    number: usize,
    seal: Option<&str>,
) -> Result<TrialLog<N>, FileError> {
    let path = trial_log_path(campaign, number);
    let log = read_trial_log(&path)?;
    let found = seal_of(&path).map_err(FileError::io(&path))?;
    if seal.is_some() && found.as_deref() != seal {
        let message = format!("is not the log that trial {number} left (its checksum is another in journal.log)");
        return Err(FileError::Campaign { path, message });
    }
    Ok(log)
}

/// Reads a log back.
pub fn read_trial_log<const N: usize>(path: &Path) -> Result<TrialLog<N>, FileError> {
    let table = read_table(path)?;
    let missing = |what: &str| FileError::Campaign {
        path: path.to_owned(),
        message: format!("`{what}` is missing; this is not a trial log of this version"),
    };
    let column = |name: String| table.column(&name).ok_or_else(|| missing(&name));
    let rows = table.rows();
    let joints = |stem: &str| -> Result<Vec<SVector<f64, N>>, FileError> {
        let columns: Vec<&[f64]> = (0..N).map(|j| column(format!("{stem}_{j}"))).collect::<Result<_, _>>()?;
        Ok((0..rows).map(|r| SVector::from_fn(|j, _| columns[j][r])).collect())
    };
    let six = |stem: &str, axes: &[(&str, usize); 6]| -> Result<Vec<SVector<f64, 6>>, FileError> {
        let mut vectors = vec![SVector::<f64, 6>::zeros(); rows];
        for (axis, place) in axes {
            for (vector, value) in vectors.iter_mut().zip(column(format!("{stem}_{axis}"))?) {
                vector[*place] = *value;
            }
        }
        Ok(vectors)
    };
    let mut reference_position = vec![SVector::<f64, 3>::zeros(); rows];
    for (k, axis) in ["x_m", "y_m", "z_m"].iter().enumerate() {
        for (vector, value) in reference_position.iter_mut().zip(column(format!("reference_{axis}"))?) {
            vector[k] = *value;
        }
    }
    let period_s = table
        .metadata_value("period_s")
        .and_then(|text| text.parse().ok())
        .filter(|period: &f64| *period > 0.0)
        .ok_or_else(|| missing("period_s"))?;
    Ok(TrialLog {
        period_s,
        time_s: column("time_s".to_owned())?.to_vec(),
        q: joints(JOINT_GROUPS[0])?,
        qd: joints(JOINT_GROUPS[1])?,
        tau_command: joints(JOINT_GROUPS[2])?,
        tau_friction: joints(JOINT_GROUPS[3])?,
        tau_task: joints(JOINT_GROUPS[4])?,
        tau_nullspace: joints(JOINT_GROUPS[5])?,
        tau_gravity: joints(JOINT_GROUPS[6])?,
        tau_coriolis: joints(JOINT_GROUPS[7])?,
        wrench: six("wrench", &WRENCH)?,
        wrench_sd: six("wrench_sd", &WRENCH)?,
        reference_position,
        error: six("error", &ERROR)?,
    })
}

fn component<const R: usize>(rows: &[SMatrix<f64, R, 1>], index: usize) -> Vec<f64> {
    rows.iter().map(|row| row[index]).collect()
}
