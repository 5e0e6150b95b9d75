//! The thermal virtual force sensor (simoni2017, simoni2019).

mod contact_gate;
mod estimator;
mod observer;
mod settings;
mod settings_error;

pub use contact_gate::{ContactGate, ContactSettings};
pub use estimator::ThermalEstimator;
pub use observer::{FrictionSample, Innovation, ObserverGain, ObserverSettings, TemperatureObserver};
pub use settings::ThermalSettings;
pub use settings_error::ThermalSettingsError;
