//! One trial to look at.

use std::path::Path;
use std::sync::Arc;

use tribo_friction::FrictionModel;
use tribo_friction::identify::SavitzkyGolay;
use tribo_robot::rnea;

use super::WatchedTrial;
use crate::files::FileError;
use crate::{TrialLog, ValidTune, read_trial_log, trial_log_path};

/// A finished trial with its log and what the views derive from it.
#[derive(Clone, Debug)]
pub struct TrialSnapshot {
    /// Parameters, cost, reason.
    pub watched: WatchedTrial,
    /// Settings of its campaign.
    pub tune: Arc<ValidTune>,
    /// Its log.
    pub log: TrialLog<7>,
    /// Log of the same motion without compensation, where it was run.
    pub uncompensated: Option<Arc<TrialLog<7>>>,
    /// Friction law that the compensator believed.
    pub friction: FrictionModel<7>,
    /// Velocity from the measured positions without delay (rad/s).
    pub qd: Vec<[f64; 7]>,
    /// Torque that the controller's rigid-body model leaves unexplained: `command − rnea(q, qd, qdd)` (Nm). In free motion
    /// that is the friction.
    pub friction_torque: Vec<[f64; 7]>,
}

/// Half-width of the Savitzky–Golay window (samples of 10 ms).
const HALF_WIDTH: usize = 8;

impl TrialSnapshot {
    /// Reads the log of a trial.
    ///
    /// # Errors
    /// The log is missing or damaged.
    pub fn read(
        campaign: &Path,
        tune: Arc<ValidTune>,
        watched: WatchedTrial,
        uncompensated: Option<Arc<TrialLog<7>>>,
    ) -> Result<Self, FileError> {
        let log = read_trial_log(&trial_log_path(campaign, watched.trial.number))?;
        Ok(Self::new(tune, watched, log, uncompensated))
    }

    /// The snapshot of a trial whose log is there.
    pub fn new(
        tune: Arc<ValidTune>,
        watched: WatchedTrial,
        log: TrialLog<7>,
        uncompensated: Option<Arc<TrialLog<7>>>,
    ) -> Self {
        let filter = SavitzkyGolay { half_width: HALF_WIDTH };
        let derivative = |x: &[Vec<f64>]| -> Vec<Vec<f64>> {
            x.iter().map(|column| filter.derivative(column, log.period_s)).collect()
        };
        let q: Vec<Vec<f64>> = (0..7).map(|j| log.q.iter().map(|q| q[j]).collect()).collect();
        let qd = derivative(&q);
        let qdd = derivative(&qd);
        let at = |x: &[Vec<f64>], k: usize| nalgebra::SVector::<f64, 7>::from_fn(|j, _| x[j][k]);
        let friction_torque = (0..log.len())
            .map(|k| (log.tau_command[k] - rnea(&tune.trial.model, &log.q[k], &at(&qd, k), &at(&qdd, k))).into())
            .collect();
        let qd = (0..log.len()).map(|k| at(&qd, k).into()).collect();
        let friction = tune.space.friction(&watched.trial.theta);
        Self { watched, tune, log, uncompensated, friction, qd, friction_torque }
    }

    /// The row of the log that is nearest to `time_s` (s since the start of the judged part).
    pub fn row_at(&self, time_s: f64) -> usize {
        let after = self.log.time_s.partition_point(|t| *t < time_s);
        let before = after.saturating_sub(1);
        let distance = |k: usize| self.log.time_s.get(k).map_or(f64::INFINITY, |t| (t - time_s).abs());
        if distance(after) < distance(before) { after } else { before }
    }
}
