//! A simulated run as a canonical log.

use nalgebra::SVector;
use tribo_files::LogError;
use tribo_logs::{LogColumns, RobotLog};
use tribo_robot::{SensorFrame, Wrench};

/// Collects ticks at the full rate: measured q, dq and tau_J, theta of robots with two encoders per joint, the commanded
/// motor torque as tau_J_d, the compensator's part of it as tau_friction, and as O_F_ext the wrench by the robot on the environment of a
/// plant that knows it.
#[derive(Clone, Debug)]
pub(crate) struct LogRecorder {
    columns: LogColumns,
}

impl LogRecorder {
    /// Nothing yet, of an arm with so many joints.
    pub(crate) fn new(joints: usize) -> Self {
        let empty = || vec![Vec::new(); joints];
        let columns = LogColumns {
            q_rad: empty(),
            dq_rad_s: empty(),
            tau_j_nm: empty(),
            tau_j_d_nm: Some(empty()),
            tau_friction_nm: Some(empty()),
            ..LogColumns::default()
        };
        Self { columns }
    }

    /// One tick, after the plant has moved on.
    pub(crate) fn push<const N: usize>(
        &mut self,
        frame: &SensorFrame<N>,
        command: &SVector<f64, N>,
        compensation: &SVector<f64, N>,
        wrench: Option<&Wrench>,
    ) {
        let columns = &mut self.columns;
        columns.time_s.push(frame.time_s);
        if let Some(theta) = &frame.theta {
            let logged = columns.theta_rad.get_or_insert_with(|| vec![Vec::new(); N]);
            for j in 0..N {
                logged[j].push(theta[j]);
            }
        }
        for j in 0..N {
            columns.q_rad[j].push(frame.q[j]);
            columns.dq_rad_s[j].push(frame.qd[j]);
            columns.tau_j_nm[j].push(frame.tau[j]);
            if let Some(commanded) = &mut columns.tau_j_d_nm {
                commanded[j].push(command[j]);
            }
            if let Some(compensated) = &mut columns.tau_friction_nm {
                compensated[j].push(compensation[j]);
            }
        }
        if let Some(wrench) = wrench {
            let logged = columns.o_f_ext.get_or_insert_default();
            for (column, value) in logged.iter_mut().zip(wrench.to_force_moment()) {
                column.push(value);
            }
        }
    }

    /// The log; a run that ended on its first ticks gives an error.
    pub(crate) fn finish(self) -> Result<RobotLog, LogError> {
        self.columns.validate()
    }
}
