//! The generalised-momentum observer and the wrench it implies (De Luca et al. 2006; Haddadin, De Luca & Albu-Schäffer 2017).

mod estimator;
mod observer;

pub use estimator::{MomentumEstimator, MomentumSettings};
pub use observer::MomentumObserver;
