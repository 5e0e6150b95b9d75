//! How a log tells what friction a joint may have.

mod band_of;
mod identify;
mod likelihood;
mod nelder_mead;

pub use band_of::BandOf;
pub use identify::{BandFitError, JointBandFit, band_coverage, identify_band};
