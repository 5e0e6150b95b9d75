//! The experiment that would separate rival causes.

use crate::diagnosis::{CauseLabel, Location};

/// A safe motion of the library.
#[derive(Clone, Debug, PartialEq)]
pub struct NextExperiment {
    /// Name of the motion: `multi_speed_cruise`.
    pub motion: &'static str,
    /// What to do, in one sentence.
    pub instruction: String,
    /// The rivals it separates.
    pub separates: [(CauseLabel, Location); 2],
    /// Expected evidence between the two after that motion (difference of twice the log likelihood).
    pub expected_evidence: f64,
    /// The same on a repetition of the log at hand.
    pub evidence_of_this_log: f64,
    /// Via points of the motion: time (s), then the joint angles (rad).
    pub via_points: Vec<(f64, Vec<f64>)>,
}
