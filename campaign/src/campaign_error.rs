//! What can go wrong in a campaign.

use std::path::PathBuf;

use tribo_model::{ConfigError, FieldError, FileError};
use tribo_trial::EstimatorError;

use crate::EarlyStop;
use crate::strategy::StrategyError;

/// Why a campaign cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// Settings out of range.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A file is missing, damaged or cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The strategy has no answer.
    #[error("trial {trial}: {source}")]
    Strategy {
        /// The trial that was to be chosen.
        trial: usize,
        /// Why it could not be.
        source: StrategyError,
    },
    /// The estimator cannot work with the parameters of a trial.
    #[error(transparent)]
    Estimator(#[from] EstimatorError),
    /// Another trial is not worth its time.
    #[error("{}: nothing left to gain: {stop}", campaign.display())]
    NothingToGain {
        /// Directory of the campaign.
        campaign: PathBuf,
        /// What another trial promises.
        stop: EarlyStop,
    },
    /// Somebody asked to stop; finished trials are safe.
    #[error("stopped after {finished} finished trials")]
    Stopped {
        /// Trials finished so far.
        finished: usize,
    },
}

impl From<FieldError> for CampaignError {
    fn from(error: FieldError) -> Self {
        Self::Config(ConfigError::Field(error))
    }
}
