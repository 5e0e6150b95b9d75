//! Composite rigid-body algorithm.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use crate::Arm;
use crate::inertia::{symmetric, turned};
use crate::sines::{sines, turned_about_z};

/// Joint-space mass matrix M(q) + diag(Ir) [kg m²] (featherstone2008, table 6.2), link frames.
///
/// Column k is the torque of a unit acceleration of joint k, all others at rest: the composite body outboard of k
/// needs force `z × m c` and moment `I_o z` in frame k, carried down to the base. Symmetric positive definite.
#[inline]
pub fn mass_matrix<const N: usize>(arm: &Arm<N>, q: &SVector<f64, N>) -> SMatrix<f64, N, N> {
    let mut rotations = [Matrix3::identity(); N];
    let mut masses = [0.0; N];
    let mut first_moments = [Vector3::zeros(); N];
    let mut inertias = [Matrix3::zeros(); N];
    let sines = sines(q);
    for k in 0..N {
        rotations[k] = turned_about_z(&arm.placements[k].rotation, sines[k]);
        let link = &arm.links[k];
        masses[k] = link.mass_kg;
        first_moments[k] = link.com_m * link.mass_kg;
        inertias[k] = link.inertia_about_origin();
    }

    let mut m = SMatrix::zeros();
    for k in (0..N).rev() {
        let mut f = Vector3::new(-first_moments[k].y, first_moments[k].x, 0.0);
        let mut n = inertias[k].column(2).into_owned();
        m[(k, k)] = n.z + arm.rotor_inertia_kg_m2[k];
        for i in (1..=k).rev() {
            f = rotations[i] * f;
            n = rotations[i] * n + arm.placements[i].translation.cross(&f);
            m[(i - 1, k)] = n.z;
            m[(k, i - 1)] = n.z;
        }
        if k > 0 {
            let r = rotations[k];
            let p = &arm.placements[k].translation;
            let h = r * first_moments[k];
            // I' = R I Rᵀ + shift of a body with first moment h and mass m to the parent origin (Steiner).
            inertias[k - 1] += turned(&r, &inertias[k]) + shifted(&h, p, masses[k]);
            first_moments[k - 1] += h + p * masses[k];
            masses[k - 1] += masses[k];
        }
    }
    m
}

/// `−([p]×[h]× + [h]×[p]×) − m [p]×[p]×`: what moving the reference point by p adds to an inertia tensor.
#[inline]
fn shifted(h: &Vector3<f64>, p: &Vector3<f64>, mass: f64) -> Matrix3<f64> {
    // −([p]×[u]× + [u]×[p]×) with u = h + m p/2, as [a]×[b]× = b aᵀ − (a·b) I.
    let u = h + p * (0.5 * mass);
    let (xx, yy, zz) = (2.0 * p.x * u.x, 2.0 * p.y * u.y, 2.0 * p.z * u.z);
    let (xy, xz, yz) = (p.x * u.y + p.y * u.x, p.x * u.z + p.z * u.x, p.y * u.z + p.z * u.y);
    symmetric([yy + zz, -xy, -xz, xx + zz, -yz, xx + yy])
}
