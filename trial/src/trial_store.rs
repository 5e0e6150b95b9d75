//! Trial logs on disk: `trials/NNNN.parquet`, robot logs like any other ([`tribo_logs::Quantity`]) with the columns of the loop beside.
//!
//! ```text
//! time  q_i  dq_i  tau_J_i  tau_friction_i | tau_task_nm_i … wrench_fx_n … reference_x_m … error_x_m …
//! ```
//!
//! `tau_J_i` is the torque that the motors were sent, which in the simulation is what they give.

use std::path::{Path, PathBuf};

use nalgebra::{SMatrix, SVector};
use tribo_files::{Table, read_table, seal_of, write_table};
use tribo_logs::Quantity;
use tribo_model::FileError;

use crate::TrialLog;

/// Path of a trial's log in a campaign directory.
pub fn trial_log_path(campaign: &Path, number: usize) -> PathBuf {
    campaign.join("trials").join(format!("{number:04}.parquet"))
}

/// Name stems of the columns with one entry per joint that only the loop knows, in the order of the fields of [`TrialLog`].
const LOOP_GROUPS: [&str; 4] = ["tau_task_nm", "tau_nullspace_nm", "tau_gravity_nm", "tau_coriolis_nm"];

/// Components of the wrench in file order, and their places in `[moment; force]`.
const WRENCH: [(&str, usize); 6] = [("fx_n", 3), ("fy_n", 4), ("fz_n", 5), ("mx_nm", 0), ("my_nm", 1), ("mz_nm", 2)];
/// Components of the pose error in file order, and their places in `[rotation; position]`.
const ERROR: [(&str, usize); 6] = [("x_m", 3), ("y_m", 4), ("z_m", 5), ("rx_rad", 0), ("ry_rad", 1), ("rz_rad", 2)];

/// Writes a log atomically, to the last bit.
#[inline(never)]
pub fn write_trial_log<const N: usize>(path: &Path, log: &TrialLog<N>) -> Result<(), FileError> {
    let mut columns = vec![(Quantity::Time.column_name(0), log.time_s.clone())];
    let measured = [
        (Quantity::Position, &log.q),
        (Quantity::Velocity, &log.qd),
        (Quantity::Torque, &log.tau_command),
        (Quantity::FrictionCompensation, &log.tau_friction),
    ];
    for (quantity, rows) in measured {
        columns.extend((0..N).map(|j| (quantity.column_name(j), component(rows, j))));
    }
    let of_the_loop = [&log.tau_task, &log.tau_nullspace, &log.tau_gravity, &log.tau_coriolis];
    for (name, rows) in LOOP_GROUPS.iter().zip(of_the_loop) {
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
#[inline(never)]
pub fn read_trial_log<const N: usize>(path: &Path) -> Result<TrialLog<N>, FileError> {
    let table = read_table(path)?;
    let missing = |what: &str| FileError::Campaign {
        path: path.to_owned(),
        message: format!("`{what}` is missing; this is not a trial log of this version"),
    };
    let column = |name: String| table.column(&name).ok_or_else(|| missing(&name));
    let rows = table.rows();
    let joints = |name: &dyn Fn(usize) -> String| -> Result<Vec<SVector<f64, N>>, FileError> {
        let columns: Vec<&[f64]> = (0..N).map(|j| column(name(j))).collect::<Result<_, _>>()?;
        Ok((0..rows).map(|r| SVector::from_fn(|j, _| columns[j][r])).collect())
    };
    let measured = |quantity: Quantity| joints(&|j| quantity.column_name(j));
    let of_the_loop = |stem: &str| joints(&|j| format!("{stem}_{j}"));
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
        time_s: column(Quantity::Time.column_name(0))?.to_vec(),
        q: measured(Quantity::Position)?,
        qd: measured(Quantity::Velocity)?,
        tau_command: measured(Quantity::Torque)?,
        tau_friction: measured(Quantity::FrictionCompensation)?,
        tau_task: of_the_loop(LOOP_GROUPS[0])?,
        tau_nullspace: of_the_loop(LOOP_GROUPS[1])?,
        tau_gravity: of_the_loop(LOOP_GROUPS[2])?,
        tau_coriolis: of_the_loop(LOOP_GROUPS[3])?,
        wrench: six("wrench", &WRENCH)?,
        wrench_sd: six("wrench_sd", &WRENCH)?,
        reference_position,
        error: six("error", &ERROR)?,
    })
}

fn component<const R: usize>(rows: &[SMatrix<f64, R, 1>], index: usize) -> Vec<f64> {
    rows.iter().map(|row| row[index]).collect()
}
