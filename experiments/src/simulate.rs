//! One trial recorded as a robot log.

use tribo_friction::FrictionModel;
use tribo_logs::{LogColumns, LogError, RobotLog};
use tribo_robot::WrenchEstimator;

use crate::{Trial, TrialOutcome, run_trial_observed};

/// Runs a trial and records it at the full rate as a canonical log: measured q, dq and tau_J, the commanded motor torque
/// as tau_J_d, and as O_F_ext the **true** wrench by the robot on the environment, which a simulation knows.
///
/// tau_J is on the side of the gears that the trial's sensors say. A trial aborted on its first ticks gives an error.
pub fn simulate_log<E: WrenchEstimator<7>>(
    trial: &Trial<7>,
    friction: &FrictionModel<7>,
    estimator: E,
    seed: u64,
) -> Result<(TrialOutcome<7>, RobotLog), LogError> {
    let seven = || vec![Vec::new(); 7];
    let mut columns = LogColumns {
        q_rad: seven(),
        dq_rad_s: seven(),
        tau_j_nm: seven(),
        tau_j_d_nm: Some(seven()),
        o_f_ext: Some(Default::default()),
        ..LogColumns::default()
    };
    let outcome = run_trial_observed(trial, friction, estimator, seed, |record, plant| {
        columns.time_s.push(record.frame.time_s);
        for j in 0..7 {
            columns.q_rad[j].push(record.frame.q[j]);
            columns.dq_rad_s[j].push(record.frame.qd[j]);
            columns.tau_j_nm[j].push(record.frame.tau[j]);
            if let Some(command) = &mut columns.tau_j_d_nm {
                command[j].push(record.command[j]);
            }
        }
        if let Some(wrench) = &mut columns.o_f_ext {
            for (column, value) in wrench.iter_mut().zip(plant.wrench().to_force_moment()) {
                column.push(value);
            }
        }
    });
    Ok((outcome, columns.validate()?))
}
