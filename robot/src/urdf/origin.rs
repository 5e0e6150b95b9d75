//! `<origin>`.

use nalgebra::{Rotation3, Vector3};
use urdf_rs::Pose;

use crate::chain::frame::{Frame, quarter_turns_exact};

/// The frame of an `<origin>`: `RotZ(yaw) RotY(pitch) RotX(roll)`.
pub(super) fn frame_of(origin: &Pose) -> Option<Frame> {
    let [[x, y, z], [roll, pitch, yaw]] = [origin.xyz.0, origin.rpy.0];
    let finite = [x, y, z, roll, pitch, yaw].iter().all(|value| value.is_finite() && value.abs() < 1e6);
    let rotation = quarter_turns_exact(Rotation3::from_euler_angles(roll, pitch, yaw).into_inner());
    finite.then_some(Frame { rotation, translation: Vector3::new(x, y, z) })
}
