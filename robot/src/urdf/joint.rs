//! One joint of the chain.

use nalgebra::{Matrix3, Vector3};
use urdf_rs::{Joint, JointType};

use super::UrdfError;
use super::origin::frame_of;
use crate::chain::frame::{Frame, chained, from_z_onto};
use crate::chain::joint::{ChainJoint, ENDLESS_RAD, JointPose};
use crate::chain::skeleton::JointKind;

/// The `<origin>` of a joint.
pub(super) fn origin(joint: &Joint) -> Result<Frame, UrdfError> {
    frame_of(&joint.origin).ok_or_else(|| refusal(joint, "origin", format!("{:?}", joint.origin), "finite numbers"))
}

/// What kind of joint it is for an arm.
pub(super) fn kind(joint: &Joint) -> JointKind {
    match joint.joint_type {
        JointType::Fixed => JointKind::Fixed,
        JointType::Revolute | JointType::Continuous if joint.mimic.is_some() => JointKind::Other("a mimic of another"),
        JointType::Revolute | JointType::Continuous => JointKind::Revolute,
        JointType::Prismatic => JointKind::Other("prismatic"),
        JointType::Floating => JointKind::Other("floating"),
        JointType::Planar => JointKind::Other("planar"),
        JointType::Spherical => JointKind::Other("spherical"),
    }
}

/// Reads a joint that turns.
pub(super) fn chain_joint(joint: &Joint) -> Result<(ChainJoint, JointPose), UrdfError> {
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
    // Many files write 0 for what their authors do not know.
    let limit_of = |field, value: f64| match (0.0..1e6).contains(&value) {
        true => Ok((value > 0.0).then_some(value)),
        false => Err(refusal(joint, field, value.to_string(), "above 0, or 0 where it is not known")),
    };
    let not_negative = |field, value: f64| match (0.0..1e6).contains(&value) {
        true => Ok(value),
        false => Err(refusal(joint, field, value.to_string(), "0 or above")),
    };
    let (damping, friction) = joint.dynamics.as_ref().map_or((0.0, 0.0), |it| (it.damping, it.friction));
    let Some(joint_from_axis) = from_z_onto(&Vector3::from(joint.axis.xyz.0)) else {
        return Err(refusal(joint, "axis", format!("{:?}", joint.axis.xyz.0), "a direction"));
    };
    let read = ChainJoint {
        name: joint.name.clone(),
        range_rad,
        speed_rad_s: limit_of("velocity of <limit>", limit.velocity)?,
        torque_nm: limit_of("effort of <limit>", limit.effort)?,
        coulomb_nm: not_negative("friction of <dynamics>", friction)?,
        viscous_nm_s_per_rad: not_negative("damping of <dynamics>", damping)?,
        rotor_inertia_kg_m2: 0.0,
    };
    let turned = |rotation: Matrix3<f64>| Frame { rotation, translation: Vector3::zeros() };
    let pose = JointPose {
        above_from_joint: chained(&origin(joint)?, &turned(joint_from_axis)),
        joint_from_link: turned(joint_from_axis.transpose()),
    };
    Ok((read, pose))
}

fn refusal(joint: &Joint, field: &'static str, value: String, allowed: &'static str) -> UrdfError {
    UrdfError::Joint { joint: joint.name.clone(), field, value, allowed }
}
