//! One trial to look at.

use std::path::Path;
use std::sync::Arc;

use tribo_friction::JointFriction;

use super::{TrialColumns, WatchedTrial, read_trial};
use tribo_campaign::AnyTune;
use tribo_model::FileError;

/// A finished trial with its log and what the views derive from it.
#[derive(Clone, Debug)]
pub struct TrialSnapshot {
    /// Parameters, cost, reason.
    pub watched: WatchedTrial,
    /// Settings of its campaign.
    pub tune: Arc<AnyTune>,
    /// Its log.
    pub log: TrialColumns,
    /// Log of the same motion without compensation, where it was run.
    pub uncompensated: Option<Arc<TrialColumns>>,
    /// Friction law that the compensator believed, of each joint.
    pub friction: Vec<JointFriction>,
}

impl TrialSnapshot {
    /// Reads the log of a trial.
    ///
    /// # Errors
    /// The log is missing or damaged.
    pub fn read(
        campaign: &Path,
        tune: Arc<AnyTune>,
        watched: WatchedTrial,
        uncompensated: Option<Arc<TrialColumns>>,
    ) -> Result<Self, FileError> {
        let log = read_trial(&tune, campaign, &watched)?;
        Ok(Self::new(tune, watched, log, uncompensated))
    }

    /// The snapshot of a trial whose log is there.
    pub fn new(
        tune: Arc<AnyTune>,
        watched: WatchedTrial,
        log: TrialColumns,
        uncompensated: Option<Arc<TrialColumns>>,
    ) -> Self {
        let friction = tune.space().joint_laws(&watched.trial.theta);
        Self { watched, tune, log, uncompensated, friction }
    }

    /// The row of the log that is nearest to `time_s` (s since the start of the judged part).
    pub fn row_at(&self, time_s: f64) -> usize {
        let after = self.log.time_s.partition_point(|t| *t < time_s);
        let before = after.saturating_sub(1);
        let distance = |k: usize| self.log.time_s.get(k).map_or(f64::INFINITY, |t| (t - time_s).abs());
        if distance(after) < distance(before) { after } else { before }
    }
}
