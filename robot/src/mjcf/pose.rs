//! Where an element is in its body: `pos`, and one of `quat axisangle euler xyaxes zaxis`.

use nalgebra::{Matrix3, Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};

use super::MjcfError;
use super::compiler::Compiler;
use super::element::{Defaults, Element, called, numbers};
use crate::chain::frame::{Frame, from_z_onto, quarter_turns_exact};

/// Ways to say how an element is turned.
const ORIENTATIONS: [&str; 5] = ["euler", "axisangle", "xyaxes", "zaxis", "quat"];
/// Furthest place (m).
const FURTHEST_M: f64 = 1e6;

/// The frame of an element in its body.
pub(super) fn pose_of(element: Element<'_>, defaults: &Defaults<'_>, compiler: &Compiler) -> Result<Frame, MjcfError> {
    let translation =
        defaults.numbers(element, "pos", 3..=3)?.map_or_else(Vector3::zeros, |pos| Vector3::from_column_slice(&pos));
    if translation.amax() > FURTHEST_M {
        return Err(refusal(element, "pos", translation.amax().to_string(), "within 1e6 m"));
    }
    Ok(Frame { rotation: rotation_of(element, defaults, compiler)?, translation })
}

/// How an element is turned.
fn rotation_of(element: Element<'_>, defaults: &Defaults<'_>, compiler: &Compiler) -> Result<Matrix3<f64>, MjcfError> {
    let Some((name, text)) = defaults.one_of(element, &ORIENTATIONS) else { return Ok(Matrix3::identity()) };
    let count = match name {
        "euler" | "zaxis" => 3,
        "xyaxes" => 6,
        _ => 4,
    };
    let x = numbers(&called(element.node), name, text, count..=count)?;
    let no_direction =
        || refusal(element, name, format!("\"{}\"", text.escape_debug()), "directions that are not zero");
    let vector = |at: usize| Vector3::from_column_slice(&x[at..at + 3]);
    let unit = |vector: Vector3<f64>| Unit::try_new(vector, 1e-12).ok_or_else(no_direction);
    Ok(quarter_turns_exact(match name {
        "quat" => {
            let quaternion = UnitQuaternion::try_new(Quaternion::new(x[0], x[1], x[2], x[3]), 1e-12);
            quaternion.ok_or_else(no_direction)?.to_rotation_matrix().into_inner()
        }
        "axisangle" => Rotation3::from_axis_angle(&unit(vector(0))?, x[3] * compiler.angle_rad).into_inner(),
        "zaxis" => from_z_onto(&unit(vector(0))?.into_inner()).ok_or_else(no_direction)?,
        "xyaxes" => {
            let first = unit(vector(0))?.into_inner();
            let second = unit(vector(3) - first * first.dot(&vector(3)))?.into_inner();
            Matrix3::from_columns(&[first, second, first.cross(&second)])
        }
        _ => {
            let mut turned = Rotation3::identity();
            for (axis, angle) in compiler.eulerseq.iter().zip(x) {
                let about = match axis.to_ascii_lowercase() {
                    'x' => Vector3::x_axis(),
                    'y' => Vector3::y_axis(),
                    _ => Vector3::z_axis(),
                };
                let turn = Rotation3::from_axis_angle(&about, angle * compiler.angle_rad);
                turned = if axis.is_ascii_lowercase() { turned * turn } else { turn * turned };
            }
            turned.into_inner()
        }
    }))
}

fn refusal(element: Element<'_>, attribute: &'static str, value: String, allowed: &'static str) -> MjcfError {
    MjcfError::Attribute { element: called(element.node), attribute, value, allowed }
}
