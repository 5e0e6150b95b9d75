//! What there is to look at in a campaign of any robot.

use std::path::Path;

use tribo_campaign::{AnyTune, ValidTune, uncompensated_trial};
use tribo_model::FileError;
use tribo_trial::{EstimatorError, read_own_trial_log};

use crate::{LoopTimes, TrialColumns, WatchedTrial, loop_times};

/// The log of [`uncompensated_trial`].
///
/// # Errors
/// Those of the estimator.
pub fn uncompensated(tune: &AnyTune) -> Result<TrialColumns, EstimatorError> {
    Ok(match tune {
        AnyTune::Six(tune) => TrialColumns::of(&uncompensated_trial(tune)?.log, &tune.trial.model),
        AnyTune::Seven(tune) => TrialColumns::of(&uncompensated_trial(tune)?.log, &tune.trial.model),
    })
}

/// [`loop_times`].
///
/// # Errors
/// Those of the estimator.
pub fn any_loop_times(tune: &AnyTune, theta: &[f64]) -> Result<LoopTimes, EstimatorError> {
    match tune {
        AnyTune::Six(tune) => loop_times(tune, theta),
        AnyTune::Seven(tune) => loop_times(tune, theta),
    }
}

/// The log of a trial in the directory of its campaign, whose journal may know its seal.
///
/// # Errors
/// The log is missing or damaged, or another trial's.
pub(crate) fn read_trial(tune: &AnyTune, campaign: &Path, watched: &WatchedTrial) -> Result<TrialColumns, FileError> {
    fn read<const N: usize>(
        tune: &ValidTune<N>,
        campaign: &Path,
        watched: &WatchedTrial,
    ) -> Result<TrialColumns, FileError> {
        let log = read_own_trial_log::<N>(campaign, watched.trial.number, watched.seal.as_deref())?;
        Ok(TrialColumns::of(&log, &tune.trial.model))
    }
    match tune {
        AnyTune::Six(tune) => read(tune, campaign, watched),
        AnyTune::Seven(tune) => read(tune, campaign, watched),
    }
}
