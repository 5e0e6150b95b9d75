//! The model that a log is held against.

use tribo_friction::law::smooth_sign;
use tribo_friction::{FrictionModel, JointFriction};
use tribo_robot::Arm;
use tribo_sim::{Effect, TorqueSide, Truth};

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
    /// The same model with payloads, tilts, links and rotors among its effects moved into the arm.
    pub(crate) fn with_rigid_effects_in_the_arm(&self) -> Self {
        let rigid = |effect: &Effect| {
            matches!(
                effect,
                Effect::Payload { .. }
                    | Effect::BaseTilt { .. }
                    | Effect::LinkInertial { .. }
                    | Effect::RotorInertia { .. }
            )
        };
        let (in_arm, effects): (Vec<Effect>, Vec<Effect>) = self.effects.iter().cloned().partition(rigid);
        let arm = Truth { effects: in_arm, ..Truth::new(self.arm.clone(), self.friction) }.true_arm();
        Self { arm, effects, ..self.clone() }
    }

    /// Friction of a joint that slides at qd [rad/s] (Nm): of its law, with what `effects` add that goes with speed alone.
    pub(crate) fn sliding_friction_nm(&self, joint: usize, qd: f64) -> f64 {
        let sign = smooth_sign(qd, self.smoothing_rad_s);
        let added = self.effects.iter().map(|effect| match *effect {
            Effect::Coulomb { joint: at, delta_coulomb_nm } if at == joint => delta_coulomb_nm * sign,
            Effect::Viscous { joint: at, delta_viscous_nm_s_per_rad } if at == joint => delta_viscous_nm_s_per_rad * qd,
            Effect::FrictionCurve { joint: at, amplitude_nm, width_rad_s } if at == joint => {
                amplitude_nm * smooth_sign(qd, width_rad_s)
            }
            _ => 0.0,
        });
        self.friction.joints[joint].torque(qd, self.smoothing_rad_s) + added.sum::<f64>()
    }

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
