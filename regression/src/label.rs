//! The vocabulary of a diagnosis: the name of a cause, and where it sits.

use std::fmt;

use tribo_robot::{JointNames, NamedJoint};
use tribo_sim::Effect;

/// The fixed vocabulary of causes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CauseLabel {
    /// Dry friction unlike the model's.
    Coulomb,
    /// Viscous friction unlike the model's.
    Viscous,
    /// More dry friction at low speed.
    Stribeck,
    /// Dry friction that differs by direction.
    CoulombAsymmetry,
    /// A constant torque.
    TorqueOffset,
    /// A torque sensor of the wrong scale.
    TorqueGain,
    /// Friction that fades as the joint warms up.
    ThermalFriction,
    /// Dry friction that grows with the load.
    LoadFriction,
    /// A body at the flange.
    Payload,
    /// A base that is not level.
    BaseTilt,
    /// A link of another mass or first moment.
    LinkInertial,
    /// Rotor inertia unlike the model's.
    RotorInertia,
    /// Torque periodic in the joint angle.
    TorqueRipple,
    /// Dry friction that builds up over a distance after reversals.
    Presliding,
    /// A spring between motor and link.
    JointElasticity,
    /// A gap between motor and link.
    Backlash,
    /// Torques stamped late.
    TimeDelay,
    /// Somebody pushed the arm.
    ExternalContact,
    /// A spring across the joint.
    PositionSpring,
    /// Friction that bends with speed.
    FrictionCurve,
    /// None of these.
    Unknown,
}

impl CauseLabel {
    /// All labels, `unknown` last.
    pub const ALL: [Self; 21] = [
        Self::Coulomb,
        Self::Viscous,
        Self::Stribeck,
        Self::CoulombAsymmetry,
        Self::TorqueOffset,
        Self::TorqueGain,
        Self::ThermalFriction,
        Self::LoadFriction,
        Self::Payload,
        Self::BaseTilt,
        Self::LinkInertial,
        Self::RotorInertia,
        Self::TorqueRipple,
        Self::Presliding,
        Self::JointElasticity,
        Self::Backlash,
        Self::TimeDelay,
        Self::ExternalContact,
        Self::PositionSpring,
        Self::FrictionCurve,
        Self::Unknown,
    ];

    /// Name in files: `coulomb_asymmetry`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coulomb => "coulomb",
            Self::Viscous => "viscous",
            Self::Stribeck => "stribeck",
            Self::CoulombAsymmetry => "coulomb_asymmetry",
            Self::TorqueOffset => "torque_offset",
            Self::TorqueGain => "torque_gain",
            Self::ThermalFriction => "thermal_friction",
            Self::LoadFriction => "load_friction",
            Self::Payload => "payload",
            Self::BaseTilt => "base_tilt",
            Self::LinkInertial => "link_inertial",
            Self::RotorInertia => "rotor_inertia",
            Self::TorqueRipple => "torque_ripple",
            Self::Presliding => "presliding",
            Self::JointElasticity => "joint_elasticity",
            Self::Backlash => "backlash",
            Self::TimeDelay => "time_delay",
            Self::ExternalContact => "external_contact",
            Self::PositionSpring => "position_spring",
            Self::FrictionCurve => "friction_curve",
            Self::Unknown => "unknown",
        }
    }

    /// The label of an effect.
    pub fn of(effect: &Effect) -> Self {
        match effect {
            Effect::Coulomb { .. } => Self::Coulomb,
            Effect::Viscous { .. } => Self::Viscous,
            Effect::Stribeck { .. } => Self::Stribeck,
            Effect::CoulombAsymmetry { .. } => Self::CoulombAsymmetry,
            Effect::TorqueOffset { .. } => Self::TorqueOffset,
            Effect::TorqueGain { .. } => Self::TorqueGain,
            Effect::ThermalFriction { .. } => Self::ThermalFriction,
            Effect::LoadFriction { .. } => Self::LoadFriction,
            Effect::Payload { .. } => Self::Payload,
            Effect::BaseTilt { .. } => Self::BaseTilt,
            Effect::LinkInertial { .. } => Self::LinkInertial,
            Effect::RotorInertia { .. } => Self::RotorInertia,
            Effect::TorqueRipple { .. } => Self::TorqueRipple,
            Effect::Presliding { .. } => Self::Presliding,
            Effect::JointElasticity { .. } => Self::JointElasticity,
            Effect::Backlash { .. } => Self::Backlash,
            Effect::TimeDelay { .. } => Self::TimeDelay,
            Effect::ExternalContact { .. } => Self::ExternalContact,
            Effect::PositionSpring { .. } => Self::PositionSpring,
            Effect::FrictionCurve { .. } | Effect::FrictionLead { .. } => Self::FrictionCurve,
        }
    }
}

impl fmt::Display for CauseLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Where a cause sits; joints and links count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Location {
    /// One joint.
    Joint(usize),
    /// One link.
    Link(usize),
    /// The whole arm.
    Arm,
}

impl Location {
    /// The place as people read it, with the name of the joint: `panda_joint4 (3)`, `link 6`, `arm`.
    pub fn among(self, names: &JointNames) -> String {
        match self {
            Self::Joint(joint) => names.of(joint).to_string(),
            place => place.to_string(),
        }
    }

    /// The joints and links of a place.
    pub fn places(self) -> (Vec<usize>, Vec<usize>) {
        match self {
            Self::Joint(joint) => (vec![joint], Vec::new()),
            Self::Link(link) => (Vec::new(), vec![link]),
            Self::Arm => (Vec::new(), Vec::new()),
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Joint(joint) => NamedJoint { name: None, joint: *joint }.fmt(f),
            Self::Link(link) => write!(f, "link {link}"),
            Self::Arm => f.write_str("arm"),
        }
    }
}
