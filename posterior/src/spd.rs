//! Inverse and determinant of a symmetric positive definite matrix, by faer.

use faer::Side;
use faer::linalg::solvers::DenseSolveCore;
use nalgebra::DMatrix;

/// A⁻¹ and ln det A.
pub(crate) struct Inverse {
    pub matrix: DMatrix<f64>,
    pub log_det: f64,
}

/// Inverts a symmetric matrix, its lower triangle read; `None` unless it is positive definite.
pub(crate) fn inverse(a: &DMatrix<f64>) -> Option<Inverse> {
    let n = a.nrows();
    if n == 0 {
        return Some(Inverse { matrix: DMatrix::zeros(0, 0), log_det: 0.0 });
    }
    // Scaled to a unit diagonal: torques, masses and seconds stand beside each other.
    let scale: Vec<f64> = (0..n).map(|i| a[(i, i)].sqrt().recip()).collect();
    if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return None;
    }
    let unit = faer::Mat::from_fn(n, n, |r, c| a[(r, c)] * scale[r] * scale[c]);
    let factor = unit.llt(Side::Lower).ok()?;
    let lower = factor.L();
    let log_det = (0..n).map(|i| 2.0 * (lower[(i, i)].ln() - scale[i].ln())).sum();
    let inverse = factor.inverse();
    let matrix = DMatrix::from_fn(n, n, |r, c| inverse[(r, c)] * scale[r] * scale[c]);
    Some(Inverse { matrix, log_det })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverts_and_refuses() {
        let a = DMatrix::from_row_slice(2, 2, &[4.0, 2.0, 2.0, 5e6]);
        let found = inverse(&a).unwrap();
        assert!((&a * found.matrix - DMatrix::identity(2, 2)).amax() < 1e-9);
        assert!((found.log_det - (2e7f64 - 4.0).ln()).abs() < 1e-9);
        assert!(inverse(&DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0])).is_none());
    }
}
