//! Which arm, which friction.

use serde::{Deserialize, Serialize};
use tribo_friction::FrictionModel;
use tribo_friction::law::GazSigmoid;
use tribo_robot::{Arm, presets};

use crate::{Effect, TypicalFriction, WarmUp};

/// Side of the gears on which the torque sensors sit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TorqueSide {
    /// Motor torque through the gear ratio: friction and rotor inertia included.
    #[default]
    Motor,
    /// Link-side torque sensor: behind friction and rotor inertia.
    Link,
}

/// Everything the plant obeys and no controller is told.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth<const N: usize> {
    /// The arm with its payload, gravity and rotor inertia.
    pub arm: Arm<N>,
    /// The friction of its joints when cold.
    pub friction: FrictionModel<N>,
    /// Loss of friction by warming up.
    pub warm_up: Option<WarmUp>,
    /// What dry friction is near standstill.
    pub dry: DryFriction,
    /// Further causes, on top of arm and friction.
    pub effects: Vec<Effect>,
}

/// What dry friction does with a joint that stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DryFriction {
    /// It holds the joint: set-valued, as Coulomb's law has it.
    #[default]
    Holds,
    /// It lets the joint creep, as the soft constraint of a physics engine does: see [`crate::SoftFriction`].
    Creeps,
}

impl<const N: usize> Truth<N> {
    /// An arm with this friction and nothing else.
    pub fn new(arm: Arm<N>, friction: FrictionModel<N>) -> Self {
        Self { arm, friction, warm_up: None, dry: DryFriction::Holds, effects: Vec::new() }
    }

    /// The same truth with a spring and damper in every joint: with [`crate::Sensors::with_motor_encoders`] a robot with
    /// two encoders per joint.
    pub fn with_elastic_joints(mut self, stiffness_nm_per_rad: [f64; N], damping_nm_s_per_rad: f64) -> Self {
        let springs = stiffness_nm_per_rad.into_iter().enumerate();
        self.effects.extend(springs.map(|(joint, stiffness_nm_per_rad)| Effect::JointElasticity {
            joint,
            stiffness_nm_per_rad,
            damping_nm_s_per_rad,
        }));
        self
    }

    /// The same truth in a physics engine: dry friction is a soft constraint.
    pub fn creeping(self) -> Self {
        Self { dry: DryFriction::Creeps, ..self }
    }

    /// The same truth warming up: it loses 28 % of its friction with a time constant of 10 min, 26 % over 50 trials.
    pub fn warming_up(self) -> Self {
        let warm_up = WarmUp { drop_fraction: 0.28, time_constant_s: 600.0, operated_s: 0.0 };
        Self { warm_up: Some(warm_up), ..self }
    }
}

impl Truth<7> {
    /// Panda without friction.
    pub fn panda_frictionless() -> Self {
        Self::new(presets::panda(), FrictionModel::none())
    }

    /// Panda with motor-side Coulomb and viscous friction: Fc .60 .90 .55 .80 .40 .30 .35 Nm.
    pub fn panda_coulomb_viscous() -> Self {
        Self::new(presets::panda(), TypicalFriction::panda().coulomb_viscous())
    }

    /// Panda with Stribeck friction: Fc .50 .75 .45 .65 .33 .25 .28, dF .35 .50 .30 .40 .20 .15 .15 Nm.
    pub fn panda_stribeck() -> Self {
        Self::new(presets::panda(), TypicalFriction::panda().stribeck())
    }

    /// Panda with bristle friction: the Coulomb-viscous values and a presliding distance of 5e-4 rad.
    pub fn panda_lugre() -> Self {
        Self::new(presets::panda(), TypicalFriction::panda().lugre())
    }

    /// Panda with the smooth, asymmetric friction identified by gaz2019 (link side of one real arm).
    pub fn panda_gaz() -> Self {
        Self::new(presets::panda(), FrictionModel { joints: panda_gaz_joints().map(Into::into) })
    }

    /// The Coulomb-viscous Panda, losing 28 % of its friction with a time constant of 10 min: 26 % over 50 trials.
    pub fn panda_thermal() -> Self {
        Self::panda_coulomb_viscous().warming_up()
    }
}

/// Friction sigmoids of one Panda (gaz2019).
pub fn panda_gaz_joints() -> [GazSigmoid; 7] {
    let phi1 = [0.54615, 0.87224, 0.64068, 1.2794, 0.83904, 0.30301, 0.56489];
    let phi2 = [5.1181, 9.0657, 10.136, 5.5903, 8.3469, 17.133, 10.336];
    let phi3 = [0.039533, 0.025882, -0.04607, 0.036194, 0.026226, -0.021047, 0.0035526];
    std::array::from_fn(|j| GazSigmoid { phi1_nm: phi1[j], phi2_s_per_rad: phi2[j], phi3_rad_s: phi3[j] })
}
