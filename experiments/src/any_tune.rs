//! What can be done with a campaign of any robot.

use std::path::Path;

use crate::bench::{BenchError, BenchReport, BenchSettings, RealTimeReport, RealTimeSettings, bench, real_time};
use crate::files::FileError;
use crate::trial_store::read_own_trial_log;
use crate::watch::{LoopTimes, TrialColumns, WatchedTrial, loop_times};
use crate::{
    AnyTune, EstimatorError, ParameterSpace, References, TuneConfig, TunedLaw, ValidTune, references,
    uncompensated_trial,
};

impl AnyTune {
    /// The settings.
    pub fn config(&self) -> &TuneConfig {
        match self {
            Self::Six(tune) => &tune.config,
            Self::Seven(tune) => &tune.config,
        }
    }

    /// The parameters that are tuned.
    pub fn space(&self) -> &ParameterSpace {
        match self {
            Self::Six(tune) => &tune.space,
            Self::Seven(tune) => &tune.space,
        }
    }

    /// Name of the arm.
    pub fn robot(&self) -> &str {
        match self {
            Self::Six(tune) => &tune.trial.model.name,
            Self::Seven(tune) => &tune.trial.model.name,
        }
    }

    /// [`references`].
    ///
    /// # Errors
    /// Those of the estimator.
    pub fn references(&self) -> Result<References, EstimatorError> {
        match self {
            Self::Six(tune) => references(tune),
            Self::Seven(tune) => references(tune),
        }
    }

    /// The log of [`uncompensated_trial`].
    ///
    /// # Errors
    /// Those of the estimator.
    pub fn uncompensated(&self) -> Result<TrialColumns, EstimatorError> {
        Ok(match self {
            Self::Six(tune) => TrialColumns::of(&uncompensated_trial(tune)?.log, &tune.trial.model),
            Self::Seven(tune) => TrialColumns::of(&uncompensated_trial(tune)?.log, &tune.trial.model),
        })
    }

    /// [`loop_times`].
    ///
    /// # Errors
    /// Those of the estimator.
    pub fn loop_times(&self, theta: &[f64]) -> Result<LoopTimes, EstimatorError> {
        match self {
            Self::Six(tune) => loop_times(tune, theta),
            Self::Seven(tune) => loop_times(tune, theta),
        }
    }

    /// The log of a trial in the directory of its campaign, whose journal may know its seal.
    ///
    /// # Errors
    /// The log is missing or damaged, or another trial's.
    pub(crate) fn read_trial(&self, campaign: &Path, watched: &WatchedTrial) -> Result<TrialColumns, FileError> {
        fn read<const N: usize>(
            tune: &ValidTune<N>,
            campaign: &Path,
            watched: &WatchedTrial,
        ) -> Result<TrialColumns, FileError> {
            let log = read_own_trial_log::<N>(campaign, watched.trial.number, watched.seal.as_deref())?;
            Ok(TrialColumns::of(&log, &tune.trial.model))
        }
        match self {
            Self::Six(tune) => read(tune, campaign, watched),
            Self::Seven(tune) => read(tune, campaign, watched),
        }
    }

    /// [`ValidTune::true_parameters`].
    pub fn true_parameters(&self) -> Option<Vec<f64>> {
        match self {
            Self::Six(tune) => tune.true_parameters(),
            Self::Seven(tune) => tune.true_parameters(),
        }
    }

    /// Goes over to another friction law.
    pub(crate) fn change_law(&mut self, law: TunedLaw) {
        match self {
            Self::Six(tune) => tune.change_law(law),
            Self::Seven(tune) => tune.change_law(law),
        }
    }

    /// Gives the campaign another number of trials.
    pub(crate) fn set_trials(&mut self, trials: usize) {
        match self {
            Self::Six(tune) => tune.config.trials = trials,
            Self::Seven(tune) => tune.config.trials = trials,
        }
    }

    /// [`bench()`].
    ///
    /// # Errors
    /// Settings that the estimator cannot work with, or a loop that stops by itself.
    pub fn bench(&self, settings: BenchSettings, stage: impl FnMut(&str)) -> Result<BenchReport, BenchError> {
        match self {
            Self::Six(tune) => bench(tune, settings, stage),
            Self::Seven(tune) => bench(tune, settings, stage),
        }
    }

    /// [`real_time`].
    ///
    /// # Errors
    /// Settings that the estimator cannot work with.
    pub fn real_time(&self, settings: &RealTimeSettings) -> Result<RealTimeReport, BenchError> {
        match self {
            Self::Six(tune) => real_time(tune, settings),
            Self::Seven(tune) => real_time(tune, settings),
        }
    }
}
