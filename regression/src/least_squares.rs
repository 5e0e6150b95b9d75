//! Least squares on few columns, from their Gram matrix: truncated to the directions that are worth it, or with a ridge.

use nalgebra::{DMatrix, DVector};

/// What columns explain.
#[derive(Clone, Debug)]
pub struct Gain {
    /// Decrease of the residual sum of squares.
    pub explained: f64,
    /// Directions that are worth it.
    pub directions: usize,
    /// Coefficient of each column.
    pub coefficients: Vec<f64>,
}

/// Least part of a column's square that must be its own.
pub const OWN_PART: f64 = 1e-3;

/// Least squares in the directions that are worth it: unit columns, eigenvalues above `own_part`.
pub fn solve_truncated(square: &DMatrix<f64>, score: &DVector<f64>, norms: &DVector<f64>, own_part: f64) -> Gain {
    let k = score.len();
    if k == 0 {
        return Gain { explained: 0.0, directions: 0, coefficients: Vec::new() };
    }
    let usable = |i: usize| norms[i] > ROUNDING * norms.max() && norms[i].is_finite();
    if k == 1 {
        let part = if usable(0) { square[(0, 0)] / norms[0].powi(2) } else { 0.0 };
        if part < own_part {
            return Gain { explained: 0.0, directions: 0, coefficients: vec![0.0] };
        }
        let coefficient = score[0] / square[(0, 0)];
        return Gain { explained: coefficient * score[0], directions: 1, coefficients: vec![coefficient] };
    }
    let inverse = DVector::from_fn(k, |i, _| if usable(i) { 1.0 / norms[i] } else { 0.0 });
    let unit = DMatrix::from_fn(k, k, |i, m| square[(i, m)] * inverse[i] * inverse[m]);
    let unit_score = score.component_mul(&inverse);
    let eigen = unit.symmetric_eigen();
    let mut gain = Gain { explained: 0.0, directions: 0, coefficients: vec![0.0; k] };
    for (i, &value) in eigen.eigenvalues.iter().enumerate() {
        if value > own_part {
            let direction = eigen.eigenvectors.column(i);
            let along = direction.dot(&unit_score);
            gain.explained += along * along / value;
            gain.directions += 1;
            for c in 0..k {
                gain.coefficients[c] += direction[c] * along / value * inverse[c];
            }
        }
    }
    gain
}

/// Least squares of unit columns with a ridge: directions that the data do not know stay near zero.
///
/// Columns that are nothing but rounding beside the others count as zero.
pub fn solve_ridge(square: &DMatrix<f64>, score: &DVector<f64>, ridge: &[f64]) -> Gain {
    let k = score.len();
    let norm = |i: usize| square[(i, i)].max(0.0).sqrt();
    let largest = (0..k).map(norm).fold(0.0, f64::max);
    let inverse = DVector::from_fn(k, |i, _| {
        let norm = norm(i);
        if norm > ROUNDING * largest && norm.is_finite() { 1.0 / norm } else { 0.0 }
    });
    let unit = DMatrix::from_fn(k, k, |i, m| {
        let value = square[(i, m)] * inverse[i] * inverse[m];
        if i == m { value + ridge[i] + RIDGE } else { value }
    });
    let unit_score = score.component_mul(&inverse);
    let Some(factor) = unit.cholesky() else {
        return Gain { explained: 0.0, directions: 0, coefficients: vec![0.0; k] };
    };
    let solution = factor.solve(&unit_score);
    Gain {
        explained: solution.dot(&unit_score),
        directions: k,
        coefficients: solution.component_mul(&inverse).as_slice().to_vec(),
    }
}

/// Ridge of a joint fit, relative to unit columns.
const RIDGE: f64 = 1e-7;
/// Norm of a column over the largest below which it is rounding.
pub(crate) const ROUNDING: f64 = 1e-9;

/// Least squares of a target on columns of the same length, see [`solve_truncated`].
pub(crate) fn fit_rows<C: AsRef<[f64]>>(columns: &[C], target: &[f64], own_part: f64) -> Gain {
    let k = columns.len();
    let square = DMatrix::from_fn(k, k, |a, b| inner(columns[a].as_ref(), columns[b].as_ref()));
    let score = DVector::from_fn(k, |a, _| inner(columns[a].as_ref(), target));
    let norms = DVector::from_fn(k, |a, _| square[(a, a)].sqrt());
    solve_truncated(&square, &score, &norms, own_part)
}

/// Inner product, in eight sums that the processor makes side by side.
pub fn inner(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len());
    let ((a, a_rest), (b, b_rest)) = (a[..count].as_chunks::<8>(), b[..count].as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for lane in 0..8 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}
