//! How far a pose is from its reference.

use nalgebra::{Matrix3, Vector3, Vector6};
use tribo_robot::{Pose, so3};

/// `e = [log(R R_dᵀ); p − p_d]`, base axes [rad; m].
#[inline]
pub(crate) fn pose_error(position: &Vector3<f64>, rotation: &Matrix3<f64>, reference: &Pose) -> Vector6<f64> {
    let r = so3::log(&(rotation * reference.rotation.matrix().transpose()));
    let p = position - reference.translation.vector;
    Vector6::new(r.x, r.y, r.z, p.x, p.y, p.z)
}
