//! Recursive Newton–Euler algorithm.

use nalgebra::{Matrix3, SVector, Vector3};

use crate::sines::{sines, turned_about_z};
use crate::{Arm, Kinematics};

/// Inverse dynamics (luh1980), link frames, forward then backward pass.
///
/// ```text
/// ω_k  = Rᵀ ω + z qd          ω̇_k = Rᵀ ω̇ + (Rᵀ ω) × z qd + z qdd
/// a_k  = Rᵀ (a + ω̇ × p + ω × (ω × p)),    a_0 = −gravity
/// F_k  = m (a + ω̇ × c + ω × (ω × c)),      N_k = I_c ω̇ + ω × I_c ω
/// tau_k = z · n_k + Ir_k qdd_k
/// ```
///
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
    let mut rotations = [Matrix3::identity(); N];
    let mut forces = [Vector3::zeros(); N];
    let mut moments = [Vector3::zeros(); N];
    let (mut w, mut dw, mut a) = (Vector3::zeros(), Vector3::zeros(), -gravity);

    let sines = sines(q);
    for k in 0..N {
        let placement = &arm.placements[k];
        let r = turned_about_z(&placement.rotation, sines[k]);
        let p = &placement.translation;
        let rt = r.transpose();
        a = rt * (a + dw.cross(p) + w.cross(&w.cross(p)));
        let w_parent = rt * w;
        // (ω × z) qd without the cross product: z = (0, 0, 1).
        dw = rt * dw + Vector3::new(w_parent.y * qd[k], -w_parent.x * qd[k], qdd[k]);
        w = w_parent + Vector3::new(0.0, 0.0, qd[k]);

        let link = &arm.links[k];
        let f = (a + dw.cross(&link.com_m) + w.cross(&w.cross(&link.com_m))) * link.mass_kg;
        let n = link.inertia_kg_m2 * dw + w.cross(&(link.inertia_kg_m2 * w));
        forces[k] = f;
        moments[k] = n + link.com_m.cross(&f);
        rotations[k] = r;
    }

    let mut tau = SVector::zeros();
    for k in (0..N).rev() {
        tau[k] = moments[k].z;
        if k > 0 {
            let f = rotations[k] * forces[k];
            let n = rotations[k] * moments[k] + arm.placements[k].translation.cross(&f);
            forces[k - 1] += f;
            moments[k - 1] += n;
        }
    }
    tau
}
