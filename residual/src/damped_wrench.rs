//! Wrench from a torque residual by weighted, damped least squares.

use nalgebra::{Matrix6, SMatrix, SVector, Vector6};

/// Weighted, damped inverse W of Jᵀ and the covariance P of what it gives:
///
/// ```text
/// W = P J R⁻¹,   P = (J R⁻¹ Jᵀ + D⁻²)⁻¹,   D = diag(moment damping (Nm), force damping (N))
/// ```
///
/// R is the covariance of the torques (Nm²); none where it is not positive definite.
#[inline]
pub(crate) fn weighted_inverse<const N: usize>(
    jacobian: &SMatrix<f64, 6, N>,
    covariance_nm2: &SMatrix<f64, N, N>,
    damping: [f64; 2],
) -> Option<(SMatrix<f64, 6, N>, Matrix6<f64>)> {
    let (weighted, covariance) = weights(jacobian, covariance_nm2, damping)?;
    Some((covariance * weighted.transpose(), covariance))
}

/// R⁻¹ Jᵀ and P.
#[inline]
fn weights<const N: usize>(
    jacobian: &SMatrix<f64, 6, N>,
    covariance_nm2: &SMatrix<f64, N, N>,
    damping: [f64; 2],
) -> Option<(SMatrix<f64, N, 6>, Matrix6<f64>)> {
    let mut weighted = jacobian.transpose();
    covariance_nm2.cholesky()?.solve_mut(&mut weighted);
    let [m, f] = damping.map(|damping| damping.powi(-2));
    let information = jacobian * weighted + Matrix6::from_diagonal(&Vector6::new(m, m, m, f, f, f));
    let covariance = information.cholesky()?.inverse();
    Some((weighted, covariance))
}

/// `W r` and P for a torque residual r (Nm); none where R is not positive definite or a number overflows.
#[inline(never)]
pub(crate) fn damped_wrench<const N: usize>(
    jacobian: &SMatrix<f64, 6, N>,
    covariance_nm2: &SMatrix<f64, N, N>,
    residual_nm: &SVector<f64, N>,
    damping: [f64; 2],
) -> Option<(Vector6<f64>, Matrix6<f64>)> {
    let (weighted, covariance) = weights(jacobian, covariance_nm2, damping)?;
    let h = covariance * weighted.tr_mul(residual_nm);
    h.iter().all(|value| value.is_finite()).then_some((h, covariance))
}
