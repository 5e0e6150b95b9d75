//! What friction a joint may have at a velocity, and how a log tells.

mod friction_band;

pub use friction_band::{BandError, FrictionBand, JointBand};
