//! Most likely wrench when the friction of each joint lies in a band (linderoth2013).
//!
//! [`ForceSolver`] is the programme for any number of joints and components, [`BoxQp`] what is left of it when the force
//! is eliminated, [`QpEstimator`] the two of them in the tick.

mod box_qp;
mod estimator;
mod force;
mod subset_factor;

pub use box_qp::{BoxOutcome, BoxQp, BoxSolution, PIVOT_LIMIT, Side};
pub use estimator::{QpEstimator, QpSettings, diagonal_prior};
pub use force::{ForceEstimate, ForceLimit, ForcePrior, ForceProblem, ForceSolver};
