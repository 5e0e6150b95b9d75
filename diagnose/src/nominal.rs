//! The model that a log is held against.

use tribo_friction::FrictionModel;
use tribo_robot::Arm;
use tribo_sim::{Effect, TorqueSide};

/// `tau = M qdd + C qd + g + Ir qdd + friction(qd) + effects`, what the user's simulation believes.
#[derive(Clone, Debug, PartialEq)]
pub struct Nominal<const N: usize> {
    /// The arm with its payload; without rotor inertia if torques are link-side.
    pub arm: Arm<N>,
    /// Friction with sign(qd) = tanh(qd/smoothing).
    pub friction: FrictionModel<N>,
    /// Width of the smooth sign (rad/s).
    pub smoothing_rad_s: f64,
    /// Causes that the model has already.
    pub effects: Vec<Effect>,
    /// Side of the gears that torques are measured on.
    pub torque_side: TorqueSide,
}
