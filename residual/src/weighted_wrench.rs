//! Wrench that best explains joint torques.

use nalgebra::{Matrix6, SMatrix, SVector, Vector6};

/// Weighted, damped inverse of Jᵀ on the torque r (Nm):
///
/// ```text
/// ĥ = P J R⁻¹ r,   P = (J R⁻¹ Jᵀ + D⁻²)⁻¹ = cov(ĥ),   D = diag(moment damping (Nm), force damping (N))
/// ```
///
/// R is the covariance of r (Nm²). `None` if R is not positive definite or ĥ not finite.
#[inline]
pub(crate) fn weighted_wrench<const N: usize>(
    jacobian: &SMatrix<f64, 6, N>,
    r: &SVector<f64, N>,
    covariance: &SMatrix<f64, N, N>,
    damping: [f64; 2],
) -> Option<(Vector6<f64>, Matrix6<f64>)> {
    let mut weighted = jacobian.transpose();
    covariance.cholesky()?.solve_mut(&mut weighted);
    let [m, f] = damping.map(|damping| damping.powi(-2));
    let information = jacobian * weighted + Matrix6::from_diagonal(&Vector6::new(m, m, m, f, f, f));
    let covariance = information.cholesky()?.inverse();
    let h = covariance * weighted.tr_mul(r);
    h.iter().all(|value| value.is_finite()).then_some((h, covariance))
}
