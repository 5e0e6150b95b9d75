//! Filters for signals on a uniform grid, off the tick: all have zero phase, so nothing moves in time.

mod central_difference;
mod decimation;
mod knots;
mod zero_phase;

pub use central_difference::central_difference;
pub(crate) use decimation::Decimation;
pub(crate) use knots::Knots;
pub use zero_phase::{FilterError, ZeroPhaseLowPass};
