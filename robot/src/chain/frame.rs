//! Where one frame is in another.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use std::f64::consts::PI;

use crate::JointPlacement;

/// Where a frame is in another; the placement of a joint at q = 0 is one.
pub(crate) type Frame = JointPlacement;

/// The same frame.
pub(crate) fn same() -> Frame {
    Frame { rotation: Matrix3::identity(), translation: Vector3::zeros() }
}

/// `a_from_c` of `a_from_b` and `b_from_c`.
pub(crate) fn chained(a_from_b: &Frame, b_from_c: &Frame) -> Frame {
    Frame {
        rotation: a_from_b.rotation * b_from_c.rotation,
        translation: a_from_b.rotation * b_from_c.translation + a_from_b.translation,
    }
}

/// Rotation that takes z onto a direction; none of what has no direction.
pub(crate) fn from_z_onto(direction: &Vector3<f64>) -> Option<Matrix3<f64>> {
    let length = direction.norm();
    if !(length > 1e-6 && length < 1e6) {
        return None;
    }
    let (z, direction) = (Vector3::z(), Unit::new_normalize(*direction));
    // Opposite directions leave the plane of the turn open; x is as good as any.
    let turn = Rotation3::rotation_between(&z, &direction)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), PI));
    Some(quarter_turns_exact(turn.into_inner()))
}

/// Right angles are the rule in real arms; keep their cosine an exact zero.
pub(crate) fn quarter_turns_exact(rotation: Matrix3<f64>) -> Matrix3<f64> {
    rotation.map(|value| if (value - value.round()).abs() < 1e-15 { value.round() } else { value })
}
