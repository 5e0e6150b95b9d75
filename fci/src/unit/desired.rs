//! What the arm is asked to do.

use nalgebra::{SVector, Vector6};
use tribo_robot::Pose;

/// Control period (s).
pub(super) const PERIOD_S: f64 = 1e-3;

/// Desired motion at the end of a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Desired {
    /// Joint positions (rad).
    pub(super) q: SVector<f64, 7>,
    /// Joint velocities (rad/s).
    pub(super) qd: SVector<f64, 7>,
    /// Joint accelerations (rad/s²).
    pub(super) qdd: SVector<f64, 7>,
    /// Pose of the end effector.
    pub(super) pose: Pose,
    /// Twist of the end effector, linear part first.
    pub(super) twist: Vector6<f64>,
    /// Its derivative.
    pub(super) acceleration: Vector6<f64>,
}

impl Desired {
    /// Rest at q (rad), the end effector at `pose`.
    pub(super) fn rest(q: SVector<f64, 7>, pose: Pose) -> Self {
        let (zero, still) = (SVector::zeros(), Vector6::zeros());
        Self { q, qd: zero, qdd: zero, pose, twist: still, acceleration: still }
    }
}
