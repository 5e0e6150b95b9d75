//! Cholesky factor with a jitter that is reported.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor;
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_inverse::invert_lower_triangular;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Mat, MatMut, Par};

use crate::BayesoptError;

/// First jitter tried, relative to the mean diagonal: a few hundred roundings.
const FIRST_JITTER: f64 = 1e-12;
/// Largest jitter tried, relative to the mean diagonal; beyond it the matrix is wrong, not ill-conditioned.
const LAST_JITTER: f64 = 1e-4;

/// Least pivot of a grown row, relative to the diagonal: below it are only roundings.
const LEAST_PIVOT: f64 = 1e-14;

/// `A + jitter·I = L Lᵀ`, n × n, sequential so that equal inputs give equal bits.
///
/// Only the lower triangle of A is read. Jitter is 0 where the factorisation succeeds by itself,
/// else the first of mean(diag)·{1e-12, 1e-10, …, 1e-4} that makes it succeed.
#[derive(Debug, Clone)]
pub struct Cholesky {
    lower: Mat<f64>,
    jitter: f64,
}

impl Cholesky {
    /// Factorises `matrix`.
    ///
    /// # Errors
    /// `NonPositivePivot` when the largest jitter does not help.
    pub fn new(matrix: &Mat<f64>) -> Result<Self, BayesoptError> {
        let mut cholesky = Self::unfilled(matrix.nrows());
        cholesky.refactor(|lower| lower.copy_from_triangular_lower(matrix))?;
        Ok(cholesky)
    }

    /// Room for a factor of n rows; [`Self::refactor`] fills it.
    pub(super) fn unfilled(n: usize) -> Self {
        Self { lower: Mat::zeros(n, n), jitter: 0.0 }
    }

    /// Factorises what `fill` writes, in the room of the old factor; `fill` is asked again where jitter is needed.
    ///
    /// # Errors
    /// As [`Self::new`]; the factor is then void.
    pub(super) fn refactor(&mut self, mut fill: impl FnMut(&mut Mat<f64>)) -> Result<(), BayesoptError> {
        let n = self.lower.nrows();
        let mut relative = 0.0;
        loop {
            fill(&mut self.lower);
            let mean_diagonal = (0..n).map(|i| self.lower[(i, i)]).sum::<f64>() / n.max(1) as f64;
            self.jitter = relative * mean_diagonal;
            for i in 0..n {
                self.lower[(i, i)] += self.jitter;
            }
            match factorise(&mut self.lower) {
                Ok(()) => return Ok(()),
                Err(index) if relative >= LAST_JITTER => return Err(BayesoptError::NonPositivePivot { index }),
                Err(_) => relative = if relative == 0.0 { FIRST_JITTER } else { relative * 100.0 },
            }
        }
    }

    /// Takes a row more of A, `row` and the diagonal entry after it, in n²: `L ← [L 0; lᵀ λ]`, `L l = row`, `λ² = diagonal + jitter − |l|²`.
    ///
    /// # Errors
    /// `NonPositivePivot` where λ² is lost in the rounding of its terms; the factor is then as it was.
    pub(super) fn grow(&mut self, row: &[f64], diagonal: f64) -> Result<(), BayesoptError> {
        let n = self.lower.nrows();
        let mut solved = Mat::from_fn(n, 1, |i, _| row[i]);
        self.forward_solve(solved.as_mut());
        let explained: f64 = solved.col(0).iter().map(|l| l * l).sum();
        let pivot = diagonal + self.jitter - explained;
        // NaN is no pivot either.
        if pivot.is_nan() || pivot <= LEAST_PIVOT * diagonal {
            return Err(BayesoptError::NonPositivePivot { index: n });
        }
        self.lower.resize_with(n + 1, n + 1, |i, j| match (i == n, j == n) {
            (true, true) => pivot.sqrt(),
            (true, false) => solved[(j, 0)],
            _ => 0.0,
        });
        Ok(())
    }

    /// What was added to the diagonal, in the units of the matrix.
    pub fn jitter(&self) -> f64 {
        self.jitter
    }

    /// `ln det(L Lᵀ) = 2 Σ ln L_ii`.
    pub fn log_determinant(&self) -> f64 {
        2.0 * (0..self.lower.nrows()).map(|i| self.lower[(i, i)].ln()).sum::<f64>()
    }

    /// L row by row, n × n, zero above the diagonal.
    pub(super) fn lower_rows(&self) -> Vec<f64> {
        let n = self.lower.nrows();
        let entry = |k: usize| if k % n <= k / n { self.lower[(k / n, k % n)] } else { 0.0 };
        (0..n * n).map(entry).collect()
    }

    /// `B ← L⁻¹ B`, n × m.
    pub fn forward_solve(&self, rhs: MatMut<'_, f64>) {
        solve_lower_triangular_in_place(self.lower.as_ref(), rhs, Par::Seq);
    }

    /// `B ← L⁻ᵀ B`, n × m.
    pub fn backward_solve(&self, rhs: MatMut<'_, f64>) {
        solve_upper_triangular_in_place(self.lower.as_ref().transpose(), rhs, Par::Seq);
    }

    /// `(L Lᵀ)⁻¹ b` for one right-hand side.
    pub fn solve(&self, rhs: &[f64]) -> Vec<f64> {
        let mut column = Mat::from_fn(rhs.len(), 1, |i, _| rhs[i]);
        self.forward_solve(column.as_mut());
        self.backward_solve(column.as_mut());
        column.col(0).iter().copied().collect()
    }

    /// Lower triangles of `L⁻¹` and of `(L Lᵀ)⁻¹ = L⁻ᵀ L⁻¹`, n × n; what lies above them is left as it was.
    pub(super) fn invert(&self, inverse_factor: &mut Mat<f64>, inverse: &mut Mat<f64>) {
        invert_lower_triangular(inverse_factor.as_mut(), self.lower.as_ref(), Par::Seq);
        let (upper, lower) = (BlockStructure::TriangularUpper, BlockStructure::TriangularLower);
        let factor = inverse_factor.as_ref();
        matmul(inverse.as_mut(), lower, Accum::Replace, factor.transpose(), upper, factor, lower, 1.0, Par::Seq);
    }
}

/// In-place factorisation; the index of the first pivot that is not positive is the error.
/// faer stops at a NaN pivot too, since NaN is not positive.
fn factorise(matrix: &mut Mat<f64>) -> Result<(), usize> {
    let n = matrix.nrows();
    let mut memory = MemBuffer::new(factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, faer::Spec::default()));
    let stack = MemStack::new(&mut memory);
    match factor::cholesky_in_place(matrix.as_mut(), Default::default(), Par::Seq, stack, faer::Spec::default()) {
        Ok(_) => match (0..n).find(|&i| !(matrix[(i, i)] > 0.0 && matrix[(i, i)].is_finite())) {
            Some(index) => Err(index),
            None => Ok(()),
        },
        Err(factor::LltError::NonPositivePivot { index }) => Err(index),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn symmetric(rows: &[&[f64]]) -> Mat<f64> {
        Mat::from_fn(rows.len(), rows.len(), |i, j| rows[i][j])
    }

    #[test]
    fn factor_solve_inverse_and_determinant_agree_with_hand_computation() {
        let cholesky = Cholesky::new(&symmetric(&[&[4.0, 2.0], &[2.0, 3.0]])).unwrap();
        assert_eq!(cholesky.jitter(), 0.0);
        assert!((cholesky.log_determinant() - 8.0_f64.ln()).abs() < 1e-15);
        let x = cholesky.solve(&[8.0, 7.0]);
        assert!((x[0] - 1.25).abs() < 1e-15 && (x[1] - 1.5).abs() < 1e-15, "{x:?}");
        let (mut of_factor, mut inverse) = (Mat::zeros(2, 2), Mat::zeros(2, 2));
        cholesky.invert(&mut of_factor, &mut inverse);
        for (at, want) in [((0, 0), 0.375), ((1, 0), -0.25), ((1, 1), 0.5)] {
            assert!((inverse[at] - want).abs() < 1e-15);
        }
    }

    #[test]
    fn a_grown_factor_is_that_of_the_larger_matrix() {
        let entry = |i: usize, j: usize| (-0.3 * (i as f64 - j as f64).powi(2)).exp() + if i == j { 0.1 } else { 0.0 };
        let mut grown = Cholesky::new(&Mat::from_fn(3, 3, entry)).unwrap();
        for n in 3..30 {
            grown.grow(&(0..n).map(|j| entry(n, j)).collect::<Vec<_>>(), entry(n, n)).unwrap();
        }
        let whole = Cholesky::new(&Mat::from_fn(30, 30, entry)).unwrap();
        for (a, b) in grown.lower_rows().iter().zip(whole.lower_rows()) {
            assert!((a - b).abs() < 1e-13, "{a} {b}");
        }
        let last = (0..30).map(|j| entry(29, j)).collect::<Vec<_>>();
        let again = grown.grow(&last, entry(29, 29) - 0.1);
        assert!(matches!(again, Err(BayesoptError::NonPositivePivot { index: 30 })), "{again:?}");
        assert_eq!(grown.lower_rows().len(), 900);
    }

    #[test]
    fn singular_matrices_get_a_reported_jitter_and_indefinite_ones_an_error() {
        let singular = Cholesky::new(&Mat::from_fn(3, 3, |_, _| 1.0)).unwrap();
        assert!(singular.jitter() > 0.0 && singular.jitter() <= LAST_JITTER);
        let indefinite = Cholesky::new(&symmetric(&[&[1.0, 2.0], &[2.0, 1.0]]));
        assert!(matches!(indefinite, Err(BayesoptError::NonPositivePivot { index: 1 })));
        let poisoned = Cholesky::new(&symmetric(&[&[1.0, 0.0], &[f64::NAN, 1.0]]));
        assert!(matches!(poisoned, Err(BayesoptError::NonPositivePivot { .. })));
    }
}
