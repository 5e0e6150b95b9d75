//! What the views show: immutable, shared, complete at one moment.

use std::path::PathBuf;
use std::sync::Arc;

use tribo_diagnose::Diagnosis;
use tribo_experiments::watch::{CampaignSnapshot, LoopTimes, Surrogate, TrialSnapshot};
use tribo_experiments::{References, TrialLog};

use crate::log_snapshot::LogSnapshot;

/// A diagnosis with the name of its log.
#[derive(Clone, Debug)]
pub struct DiagnosisSnapshot {
    /// The log.
    pub log: String,
    /// What was found.
    pub diagnosis: Diagnosis,
}

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
    /// What it says about the model.
    pub diagnosis: Option<Arc<DiagnosisSnapshot>>,
    /// Another campaign to compare with.
    pub other: Option<Arc<CampaignSnapshot>>,
}

/// What work brings.
#[derive(Debug)]
pub enum Answer {
    /// Reference costs of the campaign in this directory, and its log without compensation.
    References(PathBuf, Result<(References, Arc<TrialLog<7>>), String>),
    /// Its surrogate; none where there is too little to learn from.
    Surrogate(PathBuf, Option<Arc<Surrogate>>),
    /// One of its trials.
    Trial(PathBuf, Result<Arc<TrialSnapshot>, String>),
    /// Loop time of a trial.
    LoopTimes(usize, Result<Arc<LoopTimes>, String>),
    /// A log.
    Log(Result<Arc<LogSnapshot>, String>),
    /// A diagnosis.
    Diagnosis(Result<Arc<DiagnosisSnapshot>, String>),
    /// A report has been written.
    Report(Result<PathBuf, String>),
}
