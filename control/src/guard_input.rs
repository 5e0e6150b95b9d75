//! What a guard is told.

use nalgebra::{SVector, Vector6};

/// What a [`CompensationGuard`](crate::CompensationGuard) is told at every tick.
#[derive(Clone, Copy, Debug)]
pub struct GuardInput<'a, const N: usize> {
    /// Measured joint velocity [rad/s].
    pub qd: &'a SVector<f64, N>,
    /// Joint velocity that the motion is meant to have [rad/s].
    pub qd_reference: &'a SVector<f64, N>,
    /// `(I − J#J) qd` [rad/s].
    pub nullspace_qd: &'a SVector<f64, N>,
    /// Compensation (Nm).
    pub compensation: &'a SVector<f64, N>,
    /// Torque of the impedance at the tool, gravity and Coriolis torques apart (Nm).
    pub task_torque: &'a SVector<f64, N>,
    /// Torque of null-space damping and posture spring (Nm).
    pub nullspace_torque: &'a SVector<f64, N>,
    /// Twist of the tool, base axes, angular part first [rad/s; m/s].
    pub twist: &'a Vector6<f64>,
    /// Estimated wrench by the robot on the environment, base axes, angular part first [Nm; N].
    pub wrench: &'a Vector6<f64>,
    /// Control period (s).
    pub dt_s: f64,
}
