//! Filters for signals on a uniform grid, off the tick: both have zero phase, so nothing moves in time.

mod central_difference;
mod knots;
mod zero_phase;

pub use central_difference::central_difference;
pub(crate) use knots::Knots;
pub(crate) use zero_phase::LANES;
pub use zero_phase::{FilterError, ZeroPhaseLowPass};
