//! The thermal friction model and the virtual sensor built on it (simoni2019, simoni2017).

mod duty_cycles;
mod observer_run;
mod simoni2017;
mod simoni2019;
mod table4;

use thiserror::Error;
use tribo_friction::thermal::{ThermalError, ThermalFitError};
use tribo_residual::ThermalSettingsError;

pub use duty_cycles::DutyCycleStudy;
pub use observer_run::ObserverTrace;
pub use simoni2017::{PolishingTrace, Simoni2017};
pub use simoni2019::{Simoni2019, Simoni2019Trace};
pub use table4::Table4Row;

/// Why a thermal experiment stopped.
#[derive(Debug, Error)]
pub enum ThermalExperimentError {
    /// The identification failed.
    #[error(transparent)]
    Fit(#[from] ThermalFitError),
    /// A thermal model is out of range.
    #[error(transparent)]
    Model(#[from] ThermalError),
    /// A setting of the estimator is out of range.
    #[error(transparent)]
    Settings(#[from] ThermalSettingsError),
}
