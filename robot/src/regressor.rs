//! Inverse-dynamics regressor.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

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
        let link = kinematics.link(arm, k);
        motion = next_link(motion, &link.1, &kinematics.axis(k), qd[k], qdd[k]);
        blocks[k] = block(&kinematics, &link, &motion, k);
    }
    blocks
}

/// The block of one link in [`inverse_dynamics_regressor`], at the price of one.
pub fn link_regressor<const N: usize>(
    arm: &Arm<N>,
    q: &SVector<f64, N>,
    qd: &SVector<f64, N>,
    qdd: &SVector<f64, N>,
    link: usize,
) -> SMatrix<f64, N, 10> {
    let kinematics = Kinematics::at(arm, q);
    let base = LinkMotion::of_base(-arm.gravity_m_s2);
    let motion = (0..=link)
        .fold(base, |motion, k| next_link(motion, &kinematics.link(arm, k).1, &kinematics.axis(k), qd[k], qdd[k]));
    block(&kinematics, &kinematics.link(arm, link), &motion, link)
}

/// Motion of a link, about its origin, from that of the link before.
fn next_link(mut motion: LinkMotion, origin: &Vector3<f64>, axis: &Vector3<f64>, qd: f64, qdd: f64) -> LinkMotion {
    motion.move_to(origin);
    motion.turn(axis, qd);
    motion.dw += axis * qdd;
    motion
}

/// Torques per parameter of link k, whose rotation and origin are given.
fn block<const N: usize>(
    kinematics: &Kinematics<N>,
    (rotation, origin): &(Matrix3<f64>, Vector3<f64>),
    motion: &LinkMotion,
    k: usize,
) -> SMatrix<f64, N, 10> {
    let mut block = SMatrix::<f64, N, 10>::zeros();
    let to_link = rotation.transpose();
    let (force, moment) = body_regressor(&(to_link * motion.w), &(to_link * motion.dw), &(to_link * motion.a));
    for i in 0..=k {
        // tau_i = z_i · (n + (o_k − o_i) × f) = z_i · n + (z_i × (o_k − o_i)) · f
        let z = kinematics.axis(i);
        let (z, l) = (to_link * z, to_link * z.cross(&(origin - kinematics.pivot(i))));
        block.set_row(i, &(z.transpose() * moment + l.transpose() * force));
    }
    block
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
