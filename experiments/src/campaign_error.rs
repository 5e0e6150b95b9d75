//! What can go wrong in a campaign.

use crate::EstimatorError;
use crate::config::ConfigError;
use crate::files::FileError;
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
    /// Somebody asked to stop; finished trials are safe.
    #[error("stopped after {finished} finished trials")]
    Stopped {
        /// Trials finished so far.
        finished: usize,
    },
}
