//! Where a function is smallest and an acquisition largest.

mod maximise;
mod projected_lbfgs;
mod region;

pub use maximise::{Maximum, SearchSettings, maximise_acquisition};
pub use projected_lbfgs::{Bounds, Curvature, Descent, DescentEnd, Minimum, minimise, minimise_with};
pub use region::Region;
