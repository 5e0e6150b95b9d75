//! The thermal virtual force sensor (Simoni et al. 2017, 2019).

mod contact_gate;
mod estimator;
mod observer;
mod settings;

pub use contact_gate::{ContactGate, ContactSettings};
pub use estimator::ThermalEstimator;
pub use observer::{FrictionSample, Innovation, MAX_WINDOW, ObserverGain, ObserverSettings, TemperatureObserver};
pub use settings::{ThermalSettings, ThermalSettingsError};
