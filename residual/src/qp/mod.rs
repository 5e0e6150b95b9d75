//! Most likely wrench when the friction of each joint lies in a band (linderoth2013).
//!
//! [`ForceSolver`] is the programme for any number of joints and components, [`BoxQp`] what is left of it when the force
//! is eliminated, [`BandObserver`] what they are asked about one arm, [`QpEstimator`] all of them in the tick;
//! [`stack_opposed`] makes one programme of two arms.

mod band_observer;
mod box_qp;
mod estimator;
mod force;
mod subset_factor;

pub use band_observer::{BandObserver, stack_opposed};
pub use box_qp::{BoxOutcome, BoxQp, BoxSolution, Side};
pub use estimator::{QpEstimator, QpSettings, diagonal_prior};
pub use force::{ForceEstimate, ForceLimit, ForcePrior, ForceProblem, ForceSolver};
