//! Where one frame is in another.

use nalgebra::{Matrix3, Rotation3, Vector3};
use urdf_rs::Pose;

use crate::JointPlacement;

/// Where a frame is in another; the placement of a joint at q = 0 is one.
pub(super) type Frame = JointPlacement;

/// The same frame.
pub(super) fn same() -> Frame {
    Frame { rotation: Matrix3::identity(), translation: Vector3::zeros() }
}

/// `a_from_c` of `a_from_b` and `b_from_c`.
pub(super) fn chained(a_from_b: &Frame, b_from_c: &Frame) -> Frame {
    Frame {
        rotation: a_from_b.rotation * b_from_c.rotation,
        translation: a_from_b.rotation * b_from_c.translation + a_from_b.translation,
    }
}

/// The frame of an `<origin>`: `RotZ(yaw) RotY(pitch) RotX(roll)`.
pub(super) fn frame_of(origin: &Pose) -> Option<Frame> {
    let [[x, y, z], [roll, pitch, yaw]] = [origin.xyz.0, origin.rpy.0];
    let finite = [x, y, z, roll, pitch, yaw].iter().all(|value| value.is_finite() && value.abs() < 1e6);
    let rotation = quarter_turns_exact(Rotation3::from_euler_angles(roll, pitch, yaw).into_inner());
    finite.then_some(Frame { rotation, translation: Vector3::new(x, y, z) })
}

/// Right angles are the rule in real arms; keep their cosine an exact zero.
fn quarter_turns_exact(rotation: Matrix3<f64>) -> Matrix3<f64> {
    rotation.map(|value| if (value - value.round()).abs() < 1e-15 { value.round() } else { value })
}
