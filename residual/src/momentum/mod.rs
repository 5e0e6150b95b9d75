//! The generalised-momentum observer and the wrench it implies (deluca2006, haddadin2017).

mod estimator;
mod observer;

pub use estimator::{MomentumEstimator, MomentumSettings};
pub use observer::MomentumObserver;

/// Gain (rad/s) of the momentum observer of every estimator by default: 8 Hz, 20 ms, as the wrench filter. A friction band
/// belongs to the gain of the observer through which it was identified.
pub const OBSERVER_GAIN_RAD_S: f64 = 50.0;
/// White noise of a Panda's torque, per sample (Nm): the default of every estimator.
pub(crate) const PANDA_TORQUE_SD_NM: f64 = 0.05;
/// Noise of a Panda's velocity signal (rad/s): the default of every estimator.
pub(crate) const PANDA_VELOCITY_SD_RAD_S: f64 = 3e-3;
