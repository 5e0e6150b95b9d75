//! Recursive Newton–Euler algorithm.

use nalgebra::{SVector, Vector3};

use crate::link_dynamics::{Effort, Motion, unturned};
use crate::{Arm, Kinematics};

/// Inverse dynamics (luh1980), link frames, forward then backward pass.
///
/// ```text
/// ω_k  = Rᵀ ω + z qd          ω̇_k = Rᵀ ω̇ + (Rᵀ ω) × z qd + z qdd
/// a_k  = Rᵀ (a + A p),         a_0 = −gravity,     A = [ω̇]× + [ω]×²
/// f_k  = A h,                  n_k = h × a + vee(A Σ − Σ Aᵀ)
/// tau_k = z · n_k + Ir_k qdd_k
/// ```
///
/// h and Σ are first and second moments of a link whose mass, like all that lies on its axis, is given to the link before.
/// q (rad), qd [rad/s], qdd [rad/s²]; returns joint torque (Nm) without friction and without external wrench.
#[inline]
pub fn rnea<const N: usize>(
    arm: &Arm<N>,
    q: &SVector<f64, N>,
    qd: &SVector<f64, N>,
    qdd: &SVector<f64, N>,
) -> SVector<f64, N> {
    newton_euler(arm, q, qd, qdd, &arm.gravity_m_s2) + arm.rotor_inertia_kg_m2.component_mul(qdd)
}

/// Bias torque `C(q, qd) qd + g(q)` (Nm): inverse dynamics at qdd = 0.
#[inline]
pub fn bias_torque<const N: usize>(arm: &Arm<N>, q: &SVector<f64, N>, qd: &SVector<f64, N>) -> SVector<f64, N> {
    newton_euler(arm, q, qd, &SVector::zeros(), &arm.gravity_m_s2)
}

/// Gravity torque g(q) (Nm): inverse dynamics at rest, where only weights and levers are left.
#[inline]
pub fn gravity_torque<const N: usize>(arm: &Arm<N>, q: &SVector<f64, N>) -> SVector<f64, N> {
    Kinematics::at(arm, q).gravity_torque(arm)
}

#[inline]
fn newton_euler<const N: usize>(
    arm: &Arm<N>,
    q: &SVector<f64, N>,
    qd: &SVector<f64, N>,
    qdd: &SVector<f64, N>,
    gravity: &Vector3<f64>,
) -> SVector<f64, N> {
    let arm = arm.mechanism.canonical();
    let turns = arm.turns(q);
    let mut efforts = [Effort::NONE; N];
    let mut motion = Motion::first(unturned(&-arm.base_rotation.tr_mul(gravity), turns[0]), qd[0], qdd[0]);
    for k in 0..N {
        let gradient = motion.gradient();
        efforts[k] = arm.bodies[k].effort(&motion, &gradient);
        if k + 1 < N {
            motion = motion.next(&gradient, &arm.joints[k + 1], turns[k + 1], qd[k + 1], qdd[k + 1]);
        }
    }

    let mut tau = SVector::zeros();
    let mut outboard = Effort::NONE;
    for k in (0..N).rev() {
        outboard = outboard.plus(&efforts[k]);
        tau[k] = outboard.moment.z;
        if k > 0 {
            outboard = outboard.inwards(&arm.joints[k], turns[k]);
        }
    }
    tau
}
