//! The model that a log is held against.

use tribo_friction::{FrictionModel, JointFriction};
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

impl<const N: usize> Nominal<N> {
    /// Coulomb friction of a joint at speed (Nm): of its law, with what `effects` add.
    pub fn dry_nm(&self, joint: usize) -> f64 {
        let law = match self.friction.joints[joint] {
            JointFriction::CoulombViscous(law) => law.coulomb_nm,
            JointFriction::Stribeck(law) => law.coulomb_nm,
            JointFriction::GazSigmoid(law) => law.phi1_nm,
            JointFriction::Asymmetric(law) => 0.5 * (law.coulomb_positive_nm + law.coulomb_negative_nm),
            JointFriction::Lugre(law) => law.coulomb_nm,
        };
        let added = self.effects.iter().map(|effect| match effect {
            Effect::Coulomb { joint: at, delta_coulomb_nm } if *at == joint => *delta_coulomb_nm,
            _ => 0.0,
        });
        law + added.sum::<f64>()
    }

    /// Viscous friction of a joint [Nm s/rad]: of its law, with what `effects` add.
    pub fn viscous_nm_s(&self, joint: usize) -> f64 {
        let law = match self.friction.joints[joint] {
            JointFriction::CoulombViscous(law) => law.viscous_nm_s_per_rad,
            JointFriction::Stribeck(law) => law.viscous_nm_s_per_rad,
            JointFriction::GazSigmoid(_) => 0.0,
            JointFriction::Asymmetric(law) => {
                0.5 * (law.viscous_positive_nm_s_per_rad + law.viscous_negative_nm_s_per_rad)
            }
            JointFriction::Lugre(law) => law.viscous_nm_s_per_rad,
        };
        let added = self.effects.iter().map(|effect| match effect {
            Effect::Viscous { joint: at, delta_viscous_nm_s_per_rad } if *at == joint => *delta_viscous_nm_s_per_rad,
            _ => 0.0,
        });
        law + added.sum::<f64>()
    }
}
