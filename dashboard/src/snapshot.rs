//! What the views show: immutable, shared, complete at one moment.

use std::path::PathBuf;
use std::sync::Arc;

use tribo_campaign::References;
use tribo_trial::EstimatorName;
use tribo_watch::{CampaignSnapshot, LoopTimes, Surrogate, TrialColumns, TrialSnapshot};

use crate::diagnosis_snapshot::DiagnosisSnapshot;
use crate::live_snapshot::LiveSnapshot;
use crate::log_snapshot::LogSnapshot;
use crate::wrench_snapshot::WrenchSnapshot;

/// Everything there is to show. Parts that are not there yet are `None`.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// The campaign.
    pub campaign: Option<Arc<CampaignSnapshot>>,
    /// Its surrogate.
    pub surrogate: Option<Arc<Surrogate>>,
    /// The trial that is looked at.
    pub trial: Option<Arc<TrialSnapshot>>,
    /// Loop time of that trial on this computer, where it was measured.
    pub loop_times: Option<Arc<LoopTimes>>,
    /// A measured log.
    pub log: Option<Arc<LogSnapshot>>,
    /// The wrench along it, by every estimator that was asked, or why that cannot be.
    pub wrenches: Vec<(EstimatorName, Result<Arc<WrenchSnapshot>, String>)>,
    /// What it says about the model.
    pub diagnosis: Option<Arc<DiagnosisSnapshot>>,
    /// Another campaign to compare with.
    pub other: Option<Arc<CampaignSnapshot>>,
    /// A robot that is watched.
    pub live: Option<Arc<LiveSnapshot>>,
}

impl Snapshot {
    /// The wrench along the log, by one estimator; none until it has been worked out.
    pub fn wrench(&self, estimator: EstimatorName) -> Option<&Result<Arc<WrenchSnapshot>, String>> {
        self.wrenches.iter().find(|(name, _)| *name == estimator).map(|(_, wrench)| wrench)
    }
}

/// What work brings.
#[derive(Debug)]
pub enum Answer {
    /// Reference costs of the campaign in this directory.
    References(PathBuf, Result<References, String>),
    /// Its log without compensation.
    Uncompensated(PathBuf, Result<Option<Arc<TrialColumns>>, String>),
    /// Its surrogate, none where there is too little to learn from, and the time the fit took (s).
    Surrogate(PathBuf, Option<Arc<Surrogate>>, f64),
    /// One of its trials.
    Trial(PathBuf, Result<Arc<TrialSnapshot>, String>),
    /// Loop time of a trial.
    LoopTimes(usize, Result<Arc<LoopTimes>, String>),
    /// A log.
    Log(Result<Arc<LogSnapshot>, String>),
    /// The wrench along this log.
    Wrench(Arc<LogSnapshot>, EstimatorName, Result<Arc<WrenchSnapshot>, String>),
    /// A diagnosis.
    Diagnosis(Result<Arc<DiagnosisSnapshot>, String>),
    /// A report has been written.
    Report(Result<PathBuf, String>),
}
