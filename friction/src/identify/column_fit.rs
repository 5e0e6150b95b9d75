//! Least squares on given columns.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::TorqueFitError;

/// Coefficients of a fit and how well its columns can be told apart.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnFit {
    /// One coefficient per column.
    pub coefficients: Vec<f64>,
    /// Condition number of the normal matrix with unit columns.
    pub condition: f64,
}

/// Condition number beyond which columns count as indistinguishable.
const MAX_CONDITION: f64 = 1e8;
/// Fewest rows.
const LEAST_ROWS: usize = 10;

/// `min_θ Σ_{k in rows} (target_k − Σ_c θ_c column_c,k)²`.
///
/// For columns that were filtered like the target; [`super::fit_joint_torque`] evaluates its own from qd. Ranges must
/// lie inside every column.
///
/// # Errors
/// [`TorqueFitError`]: fewer than ten rows, or columns that are zero or linearly dependent.
pub fn fit_columns(columns: &[&[f64]], target: &[f64], rows: &[Range<usize>]) -> Result<ColumnFit, TorqueFitError> {
    let got = rows.iter().map(ExactSizeIterator::len).sum::<usize>();
    let need = LEAST_ROWS.max(columns.len());
    if got < need {
        return Err(TorqueFitError::TooFewSamples { need, got });
    }
    let dot = |a: &[f64], b: &[f64]| rows.iter().cloned().flatten().map(|k| a[k] * b[k]).sum::<f64>();
    let n = columns.len();
    let normal = DMatrix::from_fn(n, n, |i, k| dot(columns[i], columns[k]));
    let score = DVector::from_fn(n, |i, _| dot(columns[i], target));

    // Unit columns, so that the condition number does not depend on units.
    let scale = DVector::from_fn(n, |i, _| normal[(i, i)].sqrt());
    if !scale.iter().all(|s| *s > 0.0 && s.is_finite()) {
        return Err(TorqueFitError::NotSeparable { condition: f64::INFINITY });
    }
    let scaled = DMatrix::from_fn(n, n, |i, k| normal[(i, k)] / (scale[i] * scale[k]));
    let eigenvalues = scaled.symmetric_eigenvalues();
    let condition = eigenvalues.max() / eigenvalues.min().max(0.0);
    let Some(factor) = scaled.cholesky().filter(|_| condition < MAX_CONDITION) else {
        return Err(TorqueFitError::NotSeparable { condition });
    };
    let solution = factor.solve(&score.component_div(&scale)).component_div(&scale);
    Ok(ColumnFit { coefficients: solution.iter().copied().collect(), condition })
}

#[cfg(test)]
#[allow(clippy::single_range_in_vec_init, reason = "one burst is one range")]
mod tests {
    use super::*;

    #[test]
    fn rows_outside_the_ranges_do_not_matter_and_twins_are_refused() {
        let x: Vec<f64> = (0..50).map(f64::from).collect();
        let mut y: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
        y[30] = f64::NAN;
        let fit = fit_columns(&[&x], &y, &[0..30, 31..50]).unwrap();
        assert!((fit.coefficients[0] - 2.0).abs() < 1e-13);
        assert!(matches!(fit_columns(&[&x, &x], &x, &[0..50]), Err(TorqueFitError::NotSeparable { .. })));
        let few = fit_columns(&[&x], &x, &[0..4, 8..11]);
        assert_eq!(few, Err(TorqueFitError::TooFewSamples { need: 10, got: 7 }));
    }
}
