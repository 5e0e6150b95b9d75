//! One joint of the chain.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use std::f64::consts::PI;
use urdf_rs::{Joint, JointType};

use super::UrdfError;
use super::frame::{Frame, frame_of};

/// Position limit (rad) of a joint that may turn without end: five turns.
const ENDLESS_RAD: f64 = 10.0 * PI;

/// What a joint of the chain says of itself.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ChainJoint {
    pub name: String,
    /// Position limits (rad).
    pub range_rad: [f64; 2],
    /// Speed limit [rad/s].
    pub speed_rad_s: f64,
    /// Torque limit (Nm).
    pub torque_nm: f64,
    /// `friction` of `<dynamics>` (Nm).
    pub coulomb_nm: f64,
    /// `damping` of `<dynamics>` [Nm s/rad].
    pub viscous_nm_s_per_rad: f64,
}

/// The `<origin>` of a joint.
pub(super) fn origin(joint: &Joint) -> Result<Frame, UrdfError> {
    frame_of(&joint.origin).ok_or_else(|| refusal(joint, "origin", format!("{:?}", joint.origin), "finite numbers"))
}

/// Rotation that takes z onto the axis of a joint.
pub(super) fn axis_from_z(joint: &Joint) -> Result<Matrix3<f64>, UrdfError> {
    let axis = Vector3::from(joint.axis.xyz.0);
    let length = axis.norm();
    if !(length > 1e-6 && length < 1e6) {
        return Err(refusal(joint, "axis", format!("{:?}", joint.axis.xyz.0), "a direction"));
    }
    let (z, axis) = (Vector3::z(), Unit::new_normalize(axis));
    // Opposite directions leave the plane of the turn open; x is as good as any.
    let turn =
        Rotation3::rotation_between(&z, &axis).unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), PI));
    Ok(turn.into_inner().map(|value| if (value - value.round()).abs() < 1e-15 { value.round() } else { value }))
}

impl ChainJoint {
    /// Reads a joint that moves.
    pub fn of(joint: &Joint) -> Result<Self, UrdfError> {
        if joint.mimic.is_some() {
            return Err(UrdfError::Kind { joint: joint.name.clone(), kind: "a mimic of another" });
        }
        let limit = &joint.limit;
        let range_rad = match joint.joint_type {
            JointType::Continuous => [-ENDLESS_RAD, ENDLESS_RAD],
            _ => [limit.lower, limit.upper],
        };
        let [low, high] = range_rad;
        if !(low < high && low.abs() < 1e3 && high.abs() < 1e3) {
            let allowed = "lower below upper, both within 1000 rad";
            return Err(refusal(joint, "<limit>", format!("lower {low}, upper {high}"), allowed));
        }
        let positive = |field, value: f64| match value > 0.0 && value < 1e6 {
            true => Ok(value),
            false => Err(refusal(joint, field, value.to_string(), "above 0")),
        };
        let not_negative = |field, value: f64| match (0.0..1e6).contains(&value) {
            true => Ok(value),
            false => Err(refusal(joint, field, value.to_string(), "0 or above")),
        };
        let (damping, friction) = joint.dynamics.as_ref().map_or((0.0, 0.0), |it| (it.damping, it.friction));
        Ok(Self {
            name: joint.name.clone(),
            range_rad,
            speed_rad_s: positive("velocity of <limit>", limit.velocity)?,
            torque_nm: positive("effort of <limit>", limit.effort)?,
            coulomb_nm: not_negative("friction of <dynamics>", friction)?,
            viscous_nm_s_per_rad: not_negative("damping of <dynamics>", damping)?,
        })
    }
}

/// The name of a kind of joint that is not supported.
pub(super) fn unsupported(kind: &JointType) -> Option<&'static str> {
    match kind {
        JointType::Revolute | JointType::Continuous | JointType::Fixed => None,
        JointType::Prismatic => Some("prismatic"),
        JointType::Floating => Some("floating"),
        JointType::Planar => Some("planar"),
        JointType::Spherical => Some("spherical"),
    }
}

fn refusal(joint: &Joint, field: &'static str, value: String, allowed: &'static str) -> UrdfError {
    UrdfError::Joint { joint: joint.name.clone(), field, value, allowed }
}
