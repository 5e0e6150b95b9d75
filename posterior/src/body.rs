//! Rigid bodies as pseudo-inertia matrices, and how far a link may be from its drawing.
//!
//! ```text
//! P = [[Σ, h], [hᵀ, m]],   Σ = ½ tr(I) 1 − I,   a body ⇔ P ≻ 0
//! H_ab = tr(P⁻¹ E_a P⁻¹ E_b)
//! ```
//!
//! I about the link's origin, h = m c, E_a = ∂P/∂π_a for the ten parameters π = [m, h, I: xx xy xz yy yz zz]. H is the metric
//! in which distances between bodies do not depend on the frame (lee2020): the precision of a link's
//! parameters for one unit of scale.

use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector3};
use tribo_robot::{Arm, LinkInertia};

/// Ten inertial parameters.
pub(crate) type Parameters = SVector<f64, 10>;

/// Pseudo-inertia of ten parameters; linear.
pub(crate) fn pseudo_inertia(pi: &Parameters) -> Matrix4<f64> {
    let inertia = Matrix3::new(pi[4], pi[5], pi[6], pi[5], pi[7], pi[8], pi[6], pi[8], pi[9]);
    let second = Matrix3::identity() * (0.5 * inertia.trace()) - inertia;
    Matrix4::from_fn(|r, c| match (r, c) {
        (3, 3) => pi[0],
        (3, k) | (k, 3) => pi[1 + k],
        (r, c) => second[(r, c)],
    })
}

/// ∂P/∂π_a.
fn directions() -> [Matrix4<f64>; 10] {
    std::array::from_fn(|a| pseudo_inertia(&Parameters::from_fn(|i, _| f64::from(u8::from(i == a)))))
}

/// The metric H at a body; `None` if P is singular.
pub(crate) fn metric(p: &Matrix4<f64>) -> Option<SMatrix<f64, 10, 10>> {
    let inverse = p.try_inverse()?;
    let turned = directions().map(|e| inverse * e);
    Some(SMatrix::from_fn(|a, b| (turned[a] * turned[b]).trace()))
}

/// ln det P and its gradient; `None` where the parameters are no body.
pub(crate) fn log_det(pi: &Parameters) -> Option<(f64, Parameters)> {
    let p = pseudo_inertia(pi);
    let factor = p.cholesky()?;
    let value = 2.0 * factor.l().diagonal().map(f64::ln).sum();
    let inverse = factor.inverse();
    let gradient = directions().map(|e| (inverse * e).trace());
    Some((value, Parameters::from(gradient)))
}

/// Least mass of a link (kg).
const LEAST_KG: f64 = 0.2;
/// Least mass over the mean of a link and its neighbours.
const LEAST_OVER_NEIGHBOURS: f64 = 0.5;
/// Least radius of gyration over the distance to the next joint.
const LEAST_RADIUS: f64 = 0.3;
/// Least radius of gyration (m).
const LEAST_RADIUS_M: f64 = 0.05;
/// Length of the last link (m).
const LAST_LENGTH_M: f64 = 0.1;
/// Farthest believable centre of mass from the link's origin (m).
const FARTHEST_COM_M: f64 = 0.5;

/// A body of the size that link `k` must have, where its description says less: many descriptions hold links without mass, or
/// without extent.
pub(crate) fn typical_body<const N: usize>(arm: &Arm<N>, k: usize) -> Matrix4<f64> {
    let link = &arm.links[k];
    let near = &arm.links[k.saturating_sub(1)..(k + 2).min(N)];
    let neighbours_kg = near.iter().map(|link| link.mass_kg).sum::<f64>() / near.len() as f64;
    let mass_kg = link.mass_kg.max(LEAST_OVER_NEIGHBOURS * neighbours_kg).max(LEAST_KG);
    let length_m = if k + 1 < N { arm.placements[k + 1].translation.norm() } else { LAST_LENGTH_M };
    let radius_m = (LEAST_RADIUS * length_m).max(LEAST_RADIUS_M);
    let com_m = if link.mass_kg > 1e-6 && link.com_m.norm() <= FARTHEST_COM_M { link.com_m } else { Vector3::zeros() };
    // Second moments about the centre of mass, at least those of the radius.
    let second = Matrix3::identity() * (0.5 * link.inertia_kg_m2.trace()) - link.inertia_kg_m2;
    let mut eigen = second.symmetric_eigen();
    let least = mass_kg * radius_m * radius_m;
    let scale = mass_kg / link.mass_kg.max(1e-6);
    let heavier = if link.mass_kg > 1e-6 { scale } else { 0.0 };
    eigen.eigenvalues.iter_mut().for_each(|value| *value = (*value * heavier).max(least));
    let second = eigen.recompose() + com_m * com_m.transpose() * mass_kg;
    let h = com_m * mass_kg;
    Matrix4::from_fn(|r, c| match (r, c) {
        (3, 3) => mass_kg,
        (3, k) | (k, 3) => h[k],
        (r, c) => second[(r, c)],
    })
}

/// The ten parameters of a pseudo-inertia.
pub(crate) fn parameters(p: &Matrix4<f64>) -> Parameters {
    let second = p.fixed_view::<3, 3>(0, 0).into_owned();
    let i = Matrix3::identity() * second.trace() - second;
    let h = |k: usize| p[(k, 3)];
    Parameters::from([p[(3, 3)], h(0), h(1), h(2), i[(0, 0)], i[(0, 1)], i[(0, 2)], i[(1, 1)], i[(1, 2)], i[(2, 2)]])
}

/// The ten parameters of a link.
pub(crate) fn of_link(link: &LinkInertia) -> Parameters {
    link.parameters()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;

    /// Two ways to one number: the metric is the Hessian of −ln det, by finite differences of its gradient.
    #[test]
    fn the_metric_is_the_curvature_of_the_barrier() {
        let pi = presets::panda().links[3].parameters();
        let metric = metric(&pseudo_inertia(&pi)).unwrap();
        for a in 0..10 {
            let step = 1e-6 * pi[0];
            let moved = |sign: f64| {
                let mut moved = pi;
                moved[a] += sign * step;
                log_det(&moved).unwrap().1
            };
            let slope = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            let error = (metric.column(a) + slope).norm() / metric.column(a).norm();
            assert!(error < 1e-5, "{a}: {error}");
        }
        assert!((parameters(&pseudo_inertia(&pi)) - pi).amax() < 1e-12);
    }

    /// A change of a link by a share of its mass is as far in any frame.
    #[test]
    fn distances_do_not_depend_on_the_frame() {
        let link = presets::panda().links[2];
        let moved = link.placed(
            &nalgebra::Rotation3::from_euler_angles(0.3, -0.5, 0.9).into_inner(),
            &Vector3::new(0.2, 0.1, -0.4),
        );
        for body in [link, moved] {
            let pi = body.parameters();
            let square = (pi.transpose() * metric(&pseudo_inertia(&pi)).unwrap() * pi)[0];
            assert!((square - 4.0).abs() < 1e-6, "{square}");
        }
    }

    #[test]
    fn sick_links_get_a_body() {
        let arm = presets::panda().altered(|arm| {
            arm.links[4].mass_kg = 0.0;
            arm.links[4].inertia_kg_m2 = Matrix3::zeros();
        });
        let p = typical_body(&arm, 4);
        assert!(p.cholesky().is_some() && p[(3, 3)] > 0.5);
        // A healthy heavy link stays what it is.
        let healthy = typical_body(&presets::panda(), 0);
        assert!((healthy[(3, 3)] - presets::panda().links[0].mass_kg).abs() < 1e-12);
    }
}
