//! Inverse-dynamics regressor.

use nalgebra::{SMatrix, SVector, Vector3};

use crate::link_motion::LinkMotion;
use crate::{Arm, Kinematics};

/// Regressor of the rigid-body torque in the ten inertial parameters of every link (atkeson1986).
///
/// ```text
/// rnea(q, qd, qdd) = Σ_k Y_k(q, qd, qdd) π_k + Ir qdd,   π_k = [m, m c, I_o: xx xy xz yy yz zz]
/// ```
///
/// Returns one N×10 block per link, in the order of [`crate::LinkInertia::parameters`]. q (rad), qd [rad/s],
/// qdd [rad/s²]; rows are joint torques (Nm). The rotor inertia is not among the parameters: its column is qdd.
pub fn inverse_dynamics_regressor<const N: usize>(
    arm: &Arm<N>,
    q: &SVector<f64, N>,
    qd: &SVector<f64, N>,
    qdd: &SVector<f64, N>,
) -> [SMatrix<f64, N, 10>; N] {
    let kinematics = Kinematics::at(arm, q);
    let mut blocks = [SMatrix::<f64, N, 10>::zeros(); N];
    let mut motion = LinkMotion::of_base(-arm.gravity_m_s2);
    for k in 0..N {
        let ((rotation, origin), axis) = (kinematics.link(arm, k), kinematics.axis(k));
        motion.move_to(&origin);
        motion.turn(&axis, qd[k]);
        motion.dw += axis * qdd[k];

        let to_link = rotation.transpose();
        let (force, moment) = body_regressor(&(to_link * motion.w), &(to_link * motion.dw), &(to_link * motion.a));
        for i in 0..=k {
            // tau_i = z_i · (n + (o_k − o_i) × f) = z_i · n + (z_i × (o_k − o_i)) · f
            let z = kinematics.axis(i);
            let (z, l) = (to_link * z, to_link * z.cross(&(origin - kinematics.pivot(i))));
            blocks[k].set_row(i, &(z.transpose() * moment + l.transpose() * force));
        }
    }
    blocks
}

/// Force and moment about the link origin that one body needs, as 3×10 maps of its parameters.
fn body_regressor(w: &Vector3<f64>, dw: &Vector3<f64>, a: &Vector3<f64>) -> (SMatrix<f64, 3, 10>, SMatrix<f64, 3, 10>) {
    let mut force = SMatrix::<f64, 3, 10>::zeros();
    let mut moment = SMatrix::<f64, 3, 10>::zeros();
    let wx = w.cross_matrix();
    force.set_column(0, a);
    force.fixed_view_mut::<3, 3>(0, 1).copy_from(&(dw.cross_matrix() + wx * wx));
    // m c × a = −[a]× (m c)
    moment.fixed_view_mut::<3, 3>(0, 1).copy_from(&(-a.cross_matrix()));
    moment.fixed_view_mut::<3, 6>(0, 4).copy_from(&(inertia_map(dw) + wx * inertia_map(w)));
    (force, moment)
}

/// `L(v)` with `I v = L(v) [xx xy xz yy yz zz]`.
fn inertia_map(v: &Vector3<f64>) -> SMatrix<f64, 3, 6> {
    SMatrix::<f64, 3, 6>::new(
        v.x, v.y, v.z, 0.0, 0.0, 0.0, //
        0.0, v.x, 0.0, v.y, v.z, 0.0, //
        0.0, 0.0, v.x, 0.0, v.y, v.z,
    )
}
