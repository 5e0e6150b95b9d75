//! One joint of a chain.

use std::f64::consts::PI;

use super::frame::Frame;

/// Position limit (rad) of a joint that may turn without end: five turns.
pub(crate) const ENDLESS_RAD: f64 = 10.0 * PI;

/// What a description says of one joint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ChainJoint {
    pub name: String,
    /// Position limits (rad).
    pub range_rad: [f64; 2],
    /// Speed limit [rad/s], if the file has one.
    pub speed_rad_s: Option<f64>,
    /// Torque limit (Nm), if the file has one.
    pub torque_nm: Option<f64>,
    /// Coulomb friction (Nm).
    pub coulomb_nm: f64,
    /// Viscous friction [Nm s/rad].
    pub viscous_nm_s_per_rad: f64,
    /// Rotor inertia reflected through the gear [kg m²].
    pub rotor_inertia_kg_m2: f64,
}

/// Where a joint is: z is its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointPose {
    /// The joint at q = 0 in the link above.
    pub above_from_joint: Frame,
    /// The link below in the joint.
    pub joint_from_link: Frame,
}
