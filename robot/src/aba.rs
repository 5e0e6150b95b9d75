//! Articulated-body algorithm.

use nalgebra::{Matrix3, Matrix6, SVector, Vector3, Vector6};

use crate::Arm;
use crate::sines::{sines, turned_about_z};

/// Forward dynamics qdd [rad/s²] (featherstone2008, table 7.1), spatial vectors in link frames, angular part first.
///
/// ```text
/// U = Iᴬ s,  D = sᵀU + Ir,  u = tau − sᵀ pᴬ
/// Iᵃ = Iᴬ − U Uᵀ/D,  pᵃ = pᴬ + Iᵃ c + U u/D
/// qdd = (u − Uᵀ a')/D,  a = a' + s qdd
/// ```
///
/// q (rad), qd [rad/s], tau (Nm) motor torque less friction and external wrench. The rotor inertia enters D.
pub fn forward_dynamics<const N: usize>(
    arm: &Arm<N>,
    q: &SVector<f64, N>,
    qd: &SVector<f64, N>,
    tau: &SVector<f64, N>,
) -> SVector<f64, N> {
    let mut motion = [Matrix6::identity(); N];
    let mut inertia = [Matrix6::zeros(); N];
    let mut bias_force = [Vector6::zeros(); N];
    let mut bias_acceleration = [Vector6::zeros(); N];
    let mut v = Vector6::<f64>::zeros();
    let sines = sines(q);
    for k in 0..N {
        let placement = &arm.placements[k];
        motion[k] = motion_transform(&turned_about_z(&placement.rotation, sines[k]), &placement.translation);
        let v_joint = Vector6::new(0.0, 0.0, qd[k], 0.0, 0.0, 0.0);
        v = motion[k] * v + v_joint;
        bias_acceleration[k] = cross_motion(&v, &v_joint);
        let link = &arm.links[k];
        inertia[k] = spatial_inertia(link.mass_kg, &(link.com_m * link.mass_kg), &link.inertia_about_origin());
        bias_force[k] = cross_force(&v, &(inertia[k] * v));
    }

    let mut u_vectors = [Vector6::zeros(); N];
    let mut pivots = [0.0; N];
    let mut net_torque = [0.0; N];
    for k in (0..N).rev() {
        let u = inertia[k].column(2).into_owned();
        let d = u[2] + arm.rotor_inertia_kg_m2[k];
        let net = tau[k] - bias_force[k][2];
        u_vectors[k] = u;
        pivots[k] = d;
        net_torque[k] = net;
        if k > 0 {
            let articulated = inertia[k] - u * u.transpose() / d;
            let force = bias_force[k] + articulated * bias_acceleration[k] + u * (net / d);
            let xt = motion[k].transpose();
            inertia[k - 1] += xt * articulated * motion[k];
            bias_force[k - 1] += xt * force;
        }
    }

    let g = &arm.gravity_m_s2;
    let mut a = Vector6::new(0.0, 0.0, 0.0, -g.x, -g.y, -g.z);
    let mut qdd = SVector::zeros();
    for k in 0..N {
        a = motion[k] * a + bias_acceleration[k];
        qdd[k] = (net_torque[k] - u_vectors[k].dot(&a)) / pivots[k];
        a[2] += qdd[k];
    }
    qdd
}

/// Motion transform `link_X_parent = [Rᵀ 0; −Rᵀ[p]× Rᵀ]` for a link at (R, p) in its parent.
#[inline]
fn motion_transform(r: &Matrix3<f64>, p: &Vector3<f64>) -> Matrix6<f64> {
    let rt = r.transpose();
    let mut x = Matrix6::zeros();
    x.fixed_view_mut::<3, 3>(0, 0).copy_from(&rt);
    x.fixed_view_mut::<3, 3>(3, 3).copy_from(&rt);
    x.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-rt * p.cross_matrix()));
    x
}

/// Spatial inertia `[I_o [h]×; −[h]× m I]` about the link origin, h = m c.
#[inline]
fn spatial_inertia(mass: f64, h: &Vector3<f64>, inertia: &Matrix3<f64>) -> Matrix6<f64> {
    let mut i = Matrix6::zeros();
    let hx = h.cross_matrix();
    i.fixed_view_mut::<3, 3>(0, 0).copy_from(inertia);
    i.fixed_view_mut::<3, 3>(0, 3).copy_from(&hx);
    i.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-hx));
    i.fixed_view_mut::<3, 3>(3, 3).copy_from(&(Matrix3::identity() * mass));
    i
}

/// `v ×`: motion on motion.
#[inline]
fn cross_motion(v: &Vector6<f64>, m: &Vector6<f64>) -> Vector6<f64> {
    let (w, l) = halves(v);
    let (mw, ml) = halves(m);
    join(&w.cross(&mw), &(w.cross(&ml) + l.cross(&mw)))
}

/// `v ×*`: motion on force.
#[inline]
fn cross_force(v: &Vector6<f64>, f: &Vector6<f64>) -> Vector6<f64> {
    let (w, l) = halves(v);
    let (n, lin) = halves(f);
    join(&(w.cross(&n) + l.cross(&lin)), &w.cross(&lin))
}

#[inline]
fn halves(v: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (v.fixed_rows::<3>(0).into_owned(), v.fixed_rows::<3>(3).into_owned())
}

#[inline]
fn join(a: &Vector3<f64>, b: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(a.x, a.y, a.z, b.x, b.y, b.z)
}
