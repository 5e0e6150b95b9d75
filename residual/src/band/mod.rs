//! What friction a joint may have at a velocity, and how a log tells.

mod friction_band;
mod identify;
mod likelihood;
mod nelder_mead;

pub use friction_band::{BandError, FrictionBand, JointBand};
pub use identify::{BandFitError, JointBandFit, SPEED_CLASSES, band_coverage, identify_band};
