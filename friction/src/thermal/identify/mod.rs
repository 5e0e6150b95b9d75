//! The parameters of a thermal joint from logs.
//!
//! 1. [`identify_cold`]: c0 … c4 and h from a joint that is still as cold as the room (simoni2019 (12), simoni2017 (14)).
//! 2. [`identify_thermal`]: α, β, γ, δ, K, C, and c and h again, from sessions of hours at several duty cycles.

mod blocks;
mod cold_fit;
mod error;
mod fit;
mod levenberg_marquardt;
mod session;
mod temperature_path;

pub use cold_fit::{ColdFit, identify_cold};
pub use error::ThermalFitError;
pub use fit::{CapacityAnchor, Estimated, ThermalFit, ThermalFitSettings, identify_thermal};
pub use session::{ThermalSample, ThermalSession};
