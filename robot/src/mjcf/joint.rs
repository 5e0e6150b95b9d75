//! One joint of the chain.

use nalgebra::{Matrix3, Vector3};

use super::MjcfError;
use super::actuators::Drive;
use super::bodies::Body;
use super::compiler::Compiler;
use super::element::{Defaults, called};
use super::limit::{largest_both_ways, limited};
use crate::chain::frame::{Frame, chained, from_z_onto};
use crate::chain::joint::{ChainJoint, ENDLESS_RAD, JointPose};
use crate::chain::skeleton::JointKind;

/// Bound of frictions (Nm, Nm s/rad), torque limits (Nm) and rotor inertias (kg m²).
const LARGEST: f64 = 1e6;

/// What kind of joint a body hangs on.
pub(super) fn kind(body: &Body<'_>, defaults: &Defaults<'_>) -> JointKind {
    match body.joints[..] {
        [] => JointKind::Fixed,
        [(element, _)] => match defaults.text(element, "type") {
            _ if element.node.has_tag_name("freejoint") => JointKind::Other("free"),
            None | Some("hinge") => JointKind::Revolute,
            Some("slide") => JointKind::Other("prismatic (slide)"),
            Some("ball") => JointKind::Other("a ball joint"),
            Some(_) => JointKind::Other("free"),
        },
        _ => JointKind::Other("one of several joints of its body"),
    }
}

/// Reads the hinge of a body:
///
/// ```text
/// T(parent, body)(q) = T_body Trans(pos) Rot(axis, q − ref) Trans(−pos)
/// ```
pub(super) fn hinge(
    body: &Body<'_>,
    name: String,
    defaults: &Defaults<'_>,
    compiler: &Compiler,
    drive: &Drive,
) -> Result<(ChainJoint, JointPose), MjcfError> {
    let Some(&(element, around)) = body.joints.first() else {
        return Err(MjcfError::Syntax(format!("body `{}` has no joint", body.name)));
    };
    let wrong = |attribute, value: String, allowed| MjcfError::Attribute {
        element: called(element.node),
        attribute,
        value,
        allowed,
    };
    let not_negative = |attribute: &'static str| -> Result<f64, MjcfError> {
        // Higher powers of the speed may follow.
        let numbers = defaults.numbers(element, attribute, 1..=4)?.unwrap_or_else(|| vec![0.0]);
        if numbers[1..].iter().any(|&more| more != 0.0) {
            let what = format!("{attribute} with powers of the speed, of {},", called(element.node));
            return Err(MjcfError::NotSupported { what, why: "friction is dry and viscous here" });
        }
        match (0.0..LARGEST).contains(&numbers[0]) {
            true => Ok(numbers[0]),
            false => Err(wrong(attribute, numbers[0].to_string(), "0 or above")),
        }
    };
    let range = limited(element, defaults, compiler, ("limited", "range"))?;
    let range_rad = match range {
        Some([low, high]) => [low * compiler.angle_rad, high * compiler.angle_rad],
        None => [-ENDLESS_RAD, ENDLESS_RAD],
    };
    let [low, high] = range_rad;
    if !(low < high && low.abs() < 1e3 && high.abs() < 1e3) {
        return Err(wrong("range", format!("{low} to {high} rad"), "lower below upper, both within 1000 rad"));
    }
    let own_nm =
        limited(element, defaults, compiler, ("actuatorfrclimited", "actuatorfrcrange"))?.map(largest_both_ways);
    let torque_nm = [own_nm, drive.torque_nm]
        .into_iter()
        .flatten()
        .filter(|&limit| limit > 0.0 && limit < LARGEST)
        .reduce(f64::min);
    let vector = |attribute, otherwise: Vector3<f64>| -> Result<Vector3<f64>, MjcfError> {
        let numbers = defaults.numbers(element, attribute, 3..=3)?;
        Ok(numbers.map_or(otherwise, |numbers| Vector3::from_column_slice(&numbers)))
    };
    let axis = around.rotation * vector("axis", Vector3::z())?;
    let anchor = around.rotation * vector("pos", Vector3::zeros())? + around.translation;
    let Some(body_from_axis) = from_z_onto(&axis) else {
        return Err(wrong("axis", format!("{:?}", axis.as_slice()), "a direction"));
    };
    let reference_rad = defaults.number(element, "ref")?.unwrap_or(0.0) * compiler.angle_rad;
    let (sin, cos) = (-reference_rad).sin_cos();
    let body_from_joint = Frame { rotation: body_from_axis, translation: anchor };
    let back =
        Frame { rotation: Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0), translation: Vector3::zeros() };
    let with_drive = |attribute, of_drive: f64| -> Result<f64, MjcfError> {
        let both = not_negative(attribute)? + of_drive;
        if both < LARGEST {
            Ok(both)
        } else {
            Err(wrong(attribute, both.to_string(), "with its actuators', below 1e6"))
        }
    };
    let rotor_inertia_kg_m2 = with_drive("armature", drive.armature_kg_m2)?;
    let viscous_nm_s_per_rad = with_drive("damping", drive.damping_nm_s_per_rad)?;
    let joint = ChainJoint {
        name,
        range_rad,
        speed_rad_s: None,
        torque_nm,
        coulomb_nm: not_negative("frictionloss")?,
        viscous_nm_s_per_rad,
        rotor_inertia_kg_m2,
    };
    let pose = JointPose {
        above_from_joint: chained(&chained(&body.pose, &body_from_joint), &back),
        joint_from_link: Frame {
            rotation: body_from_axis.transpose(),
            translation: -(body_from_axis.transpose() * anchor),
        },
    };
    Ok((joint, pose))
}
