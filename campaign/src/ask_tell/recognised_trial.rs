//! What physics and the campaign say of the log of a trial, before it is judged.

use tribo_diagnose::Diagnosable;
use tribo_logs::RobotLog;
use tribo_logs::recognise::{Fault, Remark, recognise, without_impossible_rows};
use tribo_regression::Nominal;

use super::UserTrials;
use super::trial_remarks::{reach, trial_remarks};
use crate::ValidTune;

/// The log of a trial without rows that cannot be, and what is to be said of it.
#[derive(Clone, Debug, PartialEq)]
pub struct RecognisedTrial {
    /// The log, without single samples that no joint of the arm reaches.
    pub log: RobotLog,
    /// Remarks in the order in which they are to be heard: of the log alone, of the log and the arm, of the samples that were left out.
    /// The first that refuses says it best.
    pub remarks: [Vec<Remark>; 3],
}

/// Looks at the log of a trial; one that `failed` may have been stopped before the arm moved.
pub fn recognise_trial<const N: usize>(
    tune: &ValidTune<N>,
    user_trials: &UserTrials,
    log: &RobotLog,
    failed: bool,
) -> RecognisedTrial
where
    Nominal<N>: Diagnosable,
{
    let (log, impossible) = without_impossible_rows(log, &reach(&tune.trial.model, log.joints()));
    let mut alone = recognise(&log);
    alone.retain(|remark| !failed || remark.fault != Fault::Standstill);
    let with_arm = trial_remarks(tune, user_trials, &log, failed);
    RecognisedTrial { log, remarks: [alone, with_arm, impossible.into_iter().collect()] }
}
