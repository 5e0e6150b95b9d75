//! Wrench from a torque residual by weighted, damped least squares.

use nalgebra::{Matrix6, SMatrix, SVector, Vector6};

/// `h = P J R⁻¹ r`, `P = (J R⁻¹ Jᵀ + D⁻²)⁻¹` with `D = diag(moment, force damping)`; none where R is not positive definite or
/// a number overflows.
#[inline]
pub(crate) fn damped_wrench<const N: usize>(
    jacobian: &SMatrix<f64, 6, N>,
    covariance_nm2: &SMatrix<f64, N, N>,
    residual_nm: &SVector<f64, N>,
    moment_damping_nm: f64,
    force_damping_n: f64,
) -> Option<(Vector6<f64>, Matrix6<f64>)> {
    let mut weighted = jacobian.transpose();
    covariance_nm2.cholesky()?.solve_mut(&mut weighted);
    let (m, f) = (moment_damping_nm.powi(-2), force_damping_n.powi(-2));
    let information = jacobian * weighted + Matrix6::from_diagonal(&Vector6::new(m, m, m, f, f, f));
    let covariance = information.cholesky()?.inverse();
    let h = covariance * weighted.tr_mul(residual_nm);
    h.iter().all(|value| value.is_finite()).then_some((h, covariance))
}
