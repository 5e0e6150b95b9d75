//! Factor of a small symmetric positive definite matrix of fixed size.

use nalgebra::{SMatrix, SVector};

use crate::product::multiply_add;

/// `A = L D Lᵀ`, L unit lower triangular, D diagonal: Cholesky without square roots (golub2013, §4.1).
///
/// What nalgebra's `Cholesky` is for, with whole columns in the inner loops of the solutions, whose length the compiler then
/// knows: factor and `J A⁻¹` of a 7×7 A and a 6×7 J take 150 ns instead of 400, and every tick needs four such factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpdFactor<const N: usize> {
    /// L D in the lower triangle; above it nothing of use.
    lower: SMatrix<f64, N, N>,
    /// 1/D.
    reciprocal: SVector<f64, N>,
}

impl<const N: usize> SpdFactor<N> {
    /// Factors A, of which the lower triangle is read; `None` if a pivot is not positive and finite.
    #[inline]
    pub fn of(a: &SMatrix<f64, N, N>) -> Option<Self> {
        let mut lower = *a;
        let mut reciprocal = SVector::<f64, N>::zeros();
        let columns = &mut lower.data.0;
        for k in 0..N {
            let column = columns[k];
            let pivot = column[k];
            if !(pivot > 0.0 && pivot < f64::INFINITY) {
                return None;
            }
            reciprocal[k] = 1.0 / pivot;
            for c in k + 1..N {
                let factor = column[c] * reciprocal[k];
                for r in c..N {
                    columns[c][r] = multiply_add(-column[r], factor, columns[c][r]);
                }
            }
        }
        Some(Self { lower, reciprocal })
    }

    /// `(X, X D⁻¹)` with `X = B L⁻ᵀ`: half of the way to [`Self::right_solve`], and enough where only
    /// `B A⁻¹ Cᵀ = (B L⁻ᵀ D⁻¹) (C L⁻ᵀ)ᵀ` is wanted.
    #[inline]
    pub fn right_half<const R: usize>(&self, b: &SMatrix<f64, R, N>) -> (SMatrix<f64, R, N>, SMatrix<f64, R, N>) {
        let (mut half, mut scaled) = (SMatrix::<f64, R, N>::zeros(), SMatrix::<f64, R, N>::zeros());
        let (x, y, l) = (&mut half.data.0, &mut scaled.data.0, &self.lower.data.0);
        for c in 0..N {
            let mut column = b.data.0[c];
            for k in 0..c {
                for r in 0..R {
                    column[r] = multiply_add(-y[k][r], l[k][c], column[r]);
                }
            }
            x[c] = column;
            y[c] = column.map(|value| value * self.reciprocal[c]);
        }
        (half, scaled)
    }

    /// `B A⁻¹`.
    #[inline]
    pub fn right_solve<const R: usize>(&self, b: &SMatrix<f64, R, N>) -> SMatrix<f64, R, N> {
        let (_, mut solution) = self.right_half(b);
        let (x, l) = (&mut solution.data.0, &self.lower.data.0);
        for k in (0..N).rev() {
            let mut outboard = [0.0; R];
            for c in k + 1..N {
                for r in 0..R {
                    outboard[r] = multiply_add(x[c][r], l[k][c], outboard[r]);
                }
            }
            for r in 0..R {
                x[k][r] -= outboard[r] * self.reciprocal[k];
            }
        }
        solution
    }

    /// `L⁻¹ b`.
    #[inline]
    pub fn half(&self, b: &SVector<f64, N>) -> SVector<f64, N> {
        self.right_half(&b.transpose()).0.transpose()
    }

    /// `D⁻¹`, the reciprocals of the pivots.
    #[inline]
    pub fn reciprocal_pivots(&self) -> &SVector<f64, N> {
        &self.reciprocal
    }

    /// `A⁻¹ = L⁻ᵀ D⁻¹ L⁻¹`, symmetric; the zeros of `L⁻¹` cost nothing.
    #[inline]
    pub fn inverse(&self) -> SMatrix<f64, N, N> {
        let (l, d) = (&self.lower.data.0, &self.reciprocal);
        // Column c of L⁻¹, from the diagonal down.
        let mut unit = [[0.0; N]; N];
        for c in 0..N {
            unit[c][c] = 1.0;
            for k in c..N {
                let factor = unit[c][k] * d[k];
                for r in k + 1..N {
                    unit[c][r] = multiply_add(-l[k][r], factor, unit[c][r]);
                }
            }
        }
        let mut inverse = SMatrix::zeros();
        for c in 0..N {
            for r in 0..=c {
                let entry: f64 = (c..N).map(|k| unit[r][k] * d[k] * unit[c][k]).sum();
                inverse[(r, c)] = entry;
                inverse[(c, r)] = entry;
            }
        }
        inverse
    }

    /// `det A`.
    #[inline]
    pub fn determinant(&self) -> f64 {
        (0..N).map(|k| self.lower[(k, k)]).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> SMatrix<f64, 7, 7> {
        let root = SMatrix::<f64, 7, 7>::from_fn(|r, c| ((r * 7 + c) as f64 * 0.7).sin());
        root * root.transpose() + SMatrix::identity() * 0.1
    }

    /// Second algorithm: nalgebra's.
    #[test]
    fn solves_as_nalgebra_does() {
        let (a, b) = (some(), SMatrix::<f64, 7, 3>::from_fn(|r, c| ((r + 3 * c) as f64).cos()));
        let (ours, theirs) = (SpdFactor::of(&a).unwrap(), a.cholesky().unwrap());
        assert!((ours.right_solve(&b.transpose()).transpose() - theirs.solve(&b)).amax() < 1e-12);
        let column = b.column(0).into_owned();
        assert!((ours.right_solve(&column.transpose()).transpose() - theirs.solve(&column)).amax() < 1e-12);
        assert!((ours.inverse() - theirs.inverse()).amax() < 1e-12);
        let (half, scaled) = ours.right_half(&b.transpose());
        assert!((scaled * half.transpose() - b.transpose() * theirs.solve(&b)).amax() < 1e-12);
        let norm2 = ours.half(&column).component_mul(&ours.half(&column)).dot(ours.reciprocal_pivots());
        assert!((norm2 - column.dot(&theirs.solve(&column))).abs() < 1e-12);
        assert!((ours.determinant() / theirs.determinant() - 1.0).abs() < 1e-13);
    }

    #[test]
    fn what_has_no_factor_is_refused() {
        let indefinite = SMatrix::<f64, 2, 2>::new(1.0, 2.0, 2.0, 1.0);
        assert!(SpdFactor::of(&indefinite).is_none());
        assert!(SpdFactor::of(&SMatrix::<f64, 2, 2>::zeros()).is_none());
        assert!(SpdFactor::of(&(indefinite * f64::NAN)).is_none());
    }
}
