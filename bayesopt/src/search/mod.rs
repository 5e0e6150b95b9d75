//! Where a function is smallest and an acquisition largest.

mod maximise;
mod projected_lbfgs;

pub use maximise::{Maximum, SearchSettings, maximise_acquisition};
pub use projected_lbfgs::{Bounds, Descent, DescentEnd, Minimum, minimise};
