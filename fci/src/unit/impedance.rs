//! The unit's own controllers.

use nalgebra::{SVector, Vector6};
use tribo_robot::{ControlTerms, Pose, SensorFrame, so3};

use super::desired::Desired;
use super::frames::end_effector_jacobian;

/// Damping ratio of both controllers [-].
const DAMPING_RATIO: f64 = 0.7;
/// Damping of the null space under the Cartesian controller [Nm s/rad].
const NULL_SPACE_DAMPING: f64 = 5.0;

/// Joint impedance, torque without gravity (Nm):
///
/// ```text
/// τ = K (q_d − q) + D (q̇_d − q̇) + M q̈_d + C q̇,    D = 2 ζ √(K diag M)
/// ```
///
/// K [Nm/rad]; M with the rotors.
pub(super) fn joint_impedance(
    stiffness: &[f64; 7],
    frame: &SensorFrame<7>,
    terms: &ControlTerms<7>,
    desired: &Desired,
) -> SVector<f64, 7> {
    let feed_forward = terms.mass_matrix * desired.qdd + terms.coriolis_nm;
    SVector::from_fn(|j, _| {
        let damping = 2.0 * DAMPING_RATIO * (stiffness[j] * terms.mass_matrix[(j, j)]).sqrt();
        stiffness[j] * (desired.q[j] - frame.q[j]) + damping * (desired.qd[j] - frame.qd[j]) + feed_forward[j]
    })
}

/// Cartesian impedance at the end effector, torque without gravity (Nm):
///
/// ```text
/// τ = Jᵀ (K e + D (v_d − v)) − d (I − J⁺J) q̇ + C q̇,    D = 2 ζ √(K diag((J M⁻¹ Jᵀ)⁻¹))
/// ```
///
/// K [N/m, Nm/rad], J of the end effector with linear rows first.
pub(super) fn cartesian_impedance(
    stiffness: &[f64; 6],
    frame: &SensorFrame<7>,
    terms: &ControlTerms<7>,
    end_effector: &Pose,
    desired: &Desired,
) -> SVector<f64, 7> {
    let jacobian = end_effector_jacobian(terms, end_effector);
    let turn = so3::log(&(desired.pose.rotation.matrix() * end_effector.rotation.matrix().transpose()));
    let shift = desired.pose.translation.vector - end_effector.translation.vector;
    let error = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
    let twist = jacobian * frame.qd;
    let mobility = terms.mass_matrix.try_inverse().map(|inverse| jacobian * inverse * jacobian.transpose());
    let force = Vector6::from_fn(|i, _| {
        let inertia = mobility.map_or(1.0, |mobility| 1.0 / mobility[(i, i)].max(1e-3));
        let damping = 2.0 * DAMPING_RATIO * (stiffness[i] * inertia).sqrt();
        stiffness[i] * error[i] + damping * (desired.twist[i] - twist[i])
    });
    // What the task does not see of the velocity is damped on its own.
    let seen = (jacobian * jacobian.transpose()).try_inverse().map(|inverse| jacobian.transpose() * (inverse * twist));
    let unseen = seen.map_or_else(SVector::zeros, |seen| frame.qd - seen);
    jacobian.transpose() * force - unseen * NULL_SPACE_DAMPING + terms.coriolis_nm
}
