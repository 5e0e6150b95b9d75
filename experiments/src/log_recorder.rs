//! A simulated run as a canonical log.

use nalgebra::SVector;
use tribo_logs::{LogColumns, LogError, RobotLog};
use tribo_robot::SensorFrame;
use tribo_sim::BoxFrictionPlant;

/// Collects ticks at the full rate: measured q, dq and tau_J, theta of robots with two encoders per joint, the commanded
/// motor torque as tau_J_d, and as O_F_ext the **true** wrench by the robot on the environment, which a simulation knows.
#[derive(Clone, Debug)]
pub(crate) struct LogRecorder {
    columns: LogColumns,
}

impl LogRecorder {
    /// Nothing yet.
    pub(crate) fn new() -> Self {
        let seven = || vec![Vec::new(); 7];
        let columns = LogColumns {
            q_rad: seven(),
            dq_rad_s: seven(),
            tau_j_nm: seven(),
            tau_j_d_nm: Some(seven()),
            o_f_ext: Some(Default::default()),
            ..LogColumns::default()
        };
        Self { columns }
    }

    /// One tick, after the plant has moved on.
    pub(crate) fn push(&mut self, frame: &SensorFrame<7>, command: &SVector<f64, 7>, plant: &BoxFrictionPlant<7>) {
        let columns = &mut self.columns;
        columns.time_s.push(frame.time_s);
        if let Some(theta) = &frame.theta {
            let logged = columns.theta_rad.get_or_insert_with(|| vec![Vec::new(); 7]);
            for j in 0..7 {
                logged[j].push(theta[j]);
            }
        }
        for j in 0..7 {
            columns.q_rad[j].push(frame.q[j]);
            columns.dq_rad_s[j].push(frame.qd[j]);
            columns.tau_j_nm[j].push(frame.tau[j]);
            if let Some(commanded) = &mut columns.tau_j_d_nm {
                commanded[j].push(command[j]);
            }
        }
        if let Some(wrench) = &mut columns.o_f_ext {
            for (column, value) in wrench.iter_mut().zip(plant.wrench().to_force_moment()) {
                column.push(value);
            }
        }
    }

    /// The log; a run that ended on its first ticks gives an error.
    pub(crate) fn finish(self) -> Result<RobotLog, LogError> {
        self.columns.validate()
    }
}
