//! One trial recorded as a robot log.

use tribo_files::LogError;
use tribo_friction::FrictionModel;
use tribo_logs::RobotLog;
use tribo_robot::{Plant, WrenchEstimator};

use crate::log_recorder::LogRecorder;
use crate::{Trial, TrialOutcome, run_trial_observed, run_trial_on};

/// Runs a trial and records it at the full rate as a canonical log: measured q, dq and tau_J, the commanded motor torque
/// as tau_J_d, the compensator's part of it as tau_friction, and as O_F_ext the **true** wrench by the robot on the environment, which a simulation knows.
///
/// tau_J is on the side of the gears that the trial's sensors say. A trial aborted on its first ticks gives an error.
pub fn simulate_log<const N: usize, E: WrenchEstimator<N>>(
    trial: &Trial<N>,
    friction: &FrictionModel<N>,
    estimator: E,
    seed: u64,
) -> Result<(TrialOutcome<N>, RobotLog), LogError> {
    let mut recorder = LogRecorder::new(N);
    let outcome = run_trial_observed(trial, friction, estimator, seed, |record, plant| {
        let compensation = record.torque.friction + record.torque.effects;
        recorder.push(&record.frame, &record.command, &compensation, Some(&plant.wrench()));
    });
    Ok((outcome, recorder.finish()?))
}

/// Runs a trial on any robot that stands at its start, and records it like [`simulate_log`], without a true wrench.
///
/// # Errors
/// A trial that ended on its first ticks.
pub fn record_trial<const N: usize, P: Plant<N>, E: WrenchEstimator<N>>(
    plant: &mut P,
    trial: &Trial<N>,
    friction: &FrictionModel<N>,
    estimator: E,
) -> Result<(TrialOutcome<N>, RobotLog), LogError> {
    let mut recorder = LogRecorder::new(N);
    let outcome = run_trial_on(plant, trial, friction, estimator, |record, _| {
        let compensation = record.torque.friction + record.torque.effects;
        recorder.push(&record.frame, &record.command, &compensation, None);
    });
    Ok((outcome, recorder.finish()?))
}
