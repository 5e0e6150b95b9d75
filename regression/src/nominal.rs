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
    /// Whether joints stick where they stop for a moment: see `short_rests.rs` for the law.
    pub sticks: bool,
    /// Causes that the model has already.
    pub effects: Vec<Effect>,
    /// Side of the gears that torques are measured on.
    pub torque_side: TorqueSide,
}

/// Width of the smooth sign on logs (rad/s) where no model says another: above the noise of a velocity.
pub const SIGN_SMOOTHING_RAD_S: f64 = 0.005;
/// Width of the smooth sign [rad/s] from which downwards dry friction jumps.
const JUMP_RAD_S: f64 = 1e-3;

impl<const N: usize> Nominal<N> {
    /// An arm with friction laws whose sign is as wide as usual ([`SIGN_SMOOTHING_RAD_S`]), without sticking or effects.
    pub fn new(arm: Arm<N>, friction: FrictionModel<N>, torque_side: TorqueSide) -> Self {
        Self { arm, friction, smoothing_rad_s: SIGN_SMOOTHING_RAD_S, sticks: false, effects: Vec::new(), torque_side }
    }

    /// The same model with payloads, tilts, links and rotors among its effects moved into the arm.
    pub fn with_rigid_effects_in_the_arm(&self) -> Self {
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

    /// Whether dry friction jumps where a joint turns round: no joint is seen within its sign, and one that stands is stuck.
    pub fn friction_jumps(&self) -> bool {
        self.smoothing_rad_s < JUMP_RAD_S
    }

    /// The same model with another width of the smooth sign [rad/s].
    pub fn with_sign(&self, smoothing_rad_s: f64) -> Self {
        Self { smoothing_rad_s, ..self.clone() }
    }

    /// The same model with joints that stick.
    pub fn with_sticking(&self) -> Self {
        Self { sticks: true, ..self.clone() }
    }

    /// Friction of a joint that slides: of its law, with what `effects` add that goes with speed alone.
    pub fn sliding_friction(&self, joint: usize) -> SlidingFriction {
        let mut sliding = SlidingFriction {
            law: self.friction.joints[joint],
            smoothing_rad_s: self.smoothing_rad_s,
            delta_coulomb_nm: 0.0,
            delta_viscous_nm_s: 0.0,
            curves: Vec::new(),
        };
        for effect in &self.effects {
            match *effect {
                Effect::Coulomb { joint: at, delta_coulomb_nm } if at == joint => {
                    sliding.delta_coulomb_nm += delta_coulomb_nm;
                }
                Effect::Viscous { joint: at, delta_viscous_nm_s_per_rad } if at == joint => {
                    sliding.delta_viscous_nm_s += delta_viscous_nm_s_per_rad;
                }
                Effect::FrictionCurve { joint: at, amplitude_nm, width_rad_s } if at == joint => {
                    sliding.curves.push((amplitude_nm, width_rad_s));
                }
                _ => {}
            }
        }
        sliding
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

/// Friction of one joint over its speed.
#[derive(Clone)]
pub struct SlidingFriction {
    law: JointFriction,
    smoothing_rad_s: f64,
    delta_coulomb_nm: f64,
    delta_viscous_nm_s: f64,
    /// Amplitude (Nm) and width [rad/s] of each curve.
    curves: Vec<(f64, f64)>,
}

impl SlidingFriction {
    /// The same with another width of the smooth sign [rad/s] and more Coulomb friction (Nm).
    pub fn with_sign(&self, smoothing_rad_s: f64, more_coulomb_nm: f64) -> Self {
        Self { smoothing_rad_s, delta_coulomb_nm: self.delta_coulomb_nm + more_coulomb_nm, ..self.clone() }
    }

    /// Torque at a speed [rad/s] (Nm).
    pub fn torque_nm(&self, qd: f64) -> f64 {
        let curves = self.curves.iter().map(|(amplitude_nm, width_rad_s)| amplitude_nm * smooth_sign(qd, *width_rad_s));
        self.law.torque(qd, self.smoothing_rad_s)
            + self.delta_coulomb_nm * smooth_sign(qd, self.smoothing_rad_s)
            + self.delta_viscous_nm_s * qd
            + curves.sum::<f64>()
    }
}
