//! A robot model, validated.

use tribo_friction::FrictionModel;
use tribo_regression::{Nominal, SIGN_SMOOTHING_RAD_S};
use tribo_robot::Arm;
use tribo_sim::{Effect, TorqueSide, Truth};

use crate::Robot;

/// What a model file says, `tau = M qdd + C qd + g + Ir qdd + friction(qd) + effects`.
#[derive(Clone, Debug, PartialEq)]
pub struct Model<const N: usize> {
    /// The robot, bare and with its motors.
    pub robot: Robot<N>,
    /// The arm with the file's payload, but without its effects; without rotor inertia if the torques are link-side.
    pub arm: Arm<N>,
    /// Side of the gears on which torques are meant.
    pub torque_side: TorqueSide,
    /// Friction, zero if the file has none.
    pub friction: FrictionModel<N>,
    /// Width of the smooth sign on logs [rad/s].
    pub smoothing_rad_s: f64,
    /// Whether joints stick where they stop for a moment, on logs: see `friction.sticks` of the file.
    pub sticks: bool,
    /// Causes on top of arm and friction.
    pub effects: Vec<Effect>,
}

impl<const N: usize> Model<N> {
    /// The bare robot without friction, torques on the given side.
    pub fn bare(robot: Robot<N>, torque_side: TorqueSide) -> Self {
        let arm = match torque_side {
            TorqueSide::Motor => robot.arm.clone(),
            TorqueSide::Link => robot.arm.clone().link_side(),
        };
        let friction = FrictionModel::none();
        Self {
            robot,
            arm,
            torque_side,
            friction,
            smoothing_rad_s: SIGN_SMOOTHING_RAD_S,
            sticks: false,
            effects: Vec::new(),
        }
    }

    /// The model as a diagnosis holds a log against it.
    pub fn to_nominal(&self) -> Nominal<N> {
        Nominal {
            arm: self.arm.clone(),
            friction: self.friction,
            smoothing_rad_s: self.smoothing_rad_s,
            sticks: self.sticks,
            effects: self.effects.clone(),
            torque_side: self.torque_side,
        }
    }

    /// The plant that the model describes. A plant is always driven by its motors: a link-side model, which has no rotor
    /// inertia, gets the robot's.
    pub fn to_truth(&self) -> Truth<N> {
        let mut arm = self.arm.clone();
        if arm.rotor_inertia_kg_m2.amax() == 0.0 {
            arm.rotor_inertia_kg_m2 = self.robot.arm.rotor_inertia_kg_m2;
        }
        Truth { effects: self.effects.clone(), ..Truth::new(arm, self.friction) }
    }

    /// The plant to the letter of the file: a motor-side model whose rotors weigh nothing has none to turn. (A controller does not
    /// believe that: see [`Self::to_truth`].)
    pub fn to_plant(&self) -> Truth<N> {
        match self.torque_side {
            TorqueSide::Motor => Truth { arm: self.arm.clone(), ..self.to_truth() },
            TorqueSide::Link => self.to_truth(),
        }
    }
}

impl Model<7> {
    /// The bare Panda without friction, torques on the given side.
    pub fn panda(torque_side: TorqueSide) -> Self {
        Self::bare(Robot::panda(), torque_side)
    }
}
