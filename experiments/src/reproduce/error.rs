//! Why an experiment stopped.

use thiserror::Error;
use tribo_files::LogError;
use tribo_friction::thermal::{ThermalError, ThermalFitError};
use tribo_model::ConfigError;
use tribo_residual::{BandFitError, BoxOutcome, ThermalSettingsError};
use tribo_trial::EstimatorError;

/// Why an experiment stopped.
#[derive(Debug, Error)]
pub enum ExperimentError {
    /// A trial cannot be set up.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The estimator cannot be had.
    #[error(transparent)]
    Estimator(#[from] EstimatorError),
    /// The thermal identification failed.
    #[error(transparent)]
    Fit(#[from] ThermalFitError),
    /// A thermal model is out of range.
    #[error(transparent)]
    Model(#[from] ThermalError),
    /// A setting of the thermal estimator is out of range.
    #[error(transparent)]
    Settings(#[from] ThermalSettingsError),
    /// A trial left no log.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The friction band cannot be identified.
    #[error(transparent)]
    Band(#[from] BandFitError),
    /// The friction-band programme has no solution.
    #[error("the programme of {joints} joints: {outcome:?}")]
    Unsolved {
        /// Number of joints.
        joints: usize,
        /// What the solver says.
        outcome: BoxOutcome,
    },
}
