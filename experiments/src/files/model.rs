//! A robot model, validated.

use std::path::Path;

use tribo_diagnose::Nominal;
use tribo_friction::FrictionModel;
use tribo_robot::{Arm, presets};
use tribo_sim::{Effect, TorqueSide, Truth};

use super::{FileError, ModelFile, YamlDocument};

/// What a model file says, `tau = M qdd + C qd + g + Ir qdd + friction(qd) + effects`.
#[derive(Clone, Debug, PartialEq)]
pub struct Model<const N: usize> {
    /// The arm with the file's payload, but without its effects; without rotor inertia if the torques are link-side.
    pub arm: Arm<N>,
    /// Side of the gears on which torques are meant.
    pub torque_side: TorqueSide,
    /// Friction, zero if the file has none.
    pub friction: FrictionModel<N>,
    /// Width of the smooth sign on logs [rad/s].
    pub smoothing_rad_s: f64,
    /// Causes on top of arm and friction.
    pub effects: Vec<Effect>,
}

impl Model<7> {
    /// The bare Panda without friction, torques on the given side.
    pub fn panda(torque_side: TorqueSide) -> Self {
        let arm = match torque_side {
            TorqueSide::Motor => presets::panda(),
            TorqueSide::Link => presets::panda().link_side(),
        };
        let friction = FrictionModel::none();
        Self { arm, torque_side, friction, smoothing_rad_s: 0.005, effects: Vec::new() }
    }

    /// Reads and validates a model file.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let document = YamlDocument::read(path)?;
        document.parse::<ModelFile>()?.validate().map_err(|error| document.explain(error))
    }

    /// The model as a diagnosis holds a log against it.
    pub fn to_nominal(&self) -> Nominal<7> {
        Nominal {
            arm: self.arm.clone(),
            friction: self.friction,
            smoothing_rad_s: self.smoothing_rad_s,
            effects: self.effects.clone(),
            torque_side: self.torque_side,
        }
    }

    /// The plant that the model describes. A plant is always driven by its motors: a link-side model, which has no rotor
    /// inertia, gets the preset's.
    pub fn to_truth(&self) -> Truth<7> {
        Truth {
            arm: motor_side(self.arm.clone()),
            friction: self.friction,
            warm_up: None,
            effects: self.effects.clone(),
        }
    }
}

/// The same arm with the preset's rotor inertia if it has none.
pub(crate) fn motor_side(mut arm: Arm<7>) -> Arm<7> {
    if arm.rotor_inertia_kg_m2.amax() == 0.0 {
        arm.rotor_inertia_kg_m2 = presets::panda().rotor_inertia_kg_m2;
    }
    arm
}
