//! Triangular factor of a chosen block of a covariance.

use nalgebra::{SMatrix, SVector};

/// `C_AA = L D Lᵀ` for the coordinates A of a bit mask (bit i = coordinate i), L unit lower triangular, on the stack.
///
/// No square root: a division a row is all that waits for the row above.
#[derive(Clone, Copy, Debug)]
pub(super) struct SubsetFactor<const N: usize> {
    mask: u64,
    valid: bool,
    count: usize,
    index: [usize; N],
    /// Rows of L below its diagonal.
    rows: [[f64; N]; N],
    /// 1/D.
    inverse_pivots: [f64; N],
}

impl<const N: usize> SubsetFactor<N> {
    /// The factor of nothing.
    pub fn empty() -> Self {
        Self { mask: 0, valid: true, count: 0, index: [0; N], rows: [[0.0; N]; N], inverse_pivots: [0.0; N] }
    }

    /// Forgets the factor, since C has changed.
    #[inline]
    pub fn invalidate(&mut self) {
        self.valid = false;
    }

    /// The coordinates of A in ascending order.
    #[inline]
    pub fn coordinates(&self) -> &[usize] {
        &self.index[..self.count]
    }

    /// Factors the block of `mask`, unless it is at hand; false if a pivot is not positive.
    #[inline]
    pub fn factor(&mut self, c: &SMatrix<f64, N, N>, mask: u64) -> bool {
        if self.valid && self.mask == mask {
            return true;
        }
        // Rows above the first coordinate that differs are those of the old factor.
        let keep = if self.valid { ((1_u64 << (self.mask ^ mask).trailing_zeros()) - 1) & mask } else { 0 };
        let kept = keep.count_ones() as usize;
        (self.mask, self.valid, self.count) = (mask, false, kept);
        for i in (0..N).filter(|&i| mask >> i & 1 == 1).skip(kept) {
            let n = self.count;
            self.index[n] = i;
            // L_nk D_k, then L_nk.
            let mut scaled = [0.0; N];
            let mut pivot = c[(i, i)];
            for k in 0..n {
                let mut sum = c[(i, self.index[k])];
                for l in 0..k {
                    sum -= scaled[l] * self.rows[k][l];
                }
                scaled[k] = sum;
                self.rows[n][k] = sum * self.inverse_pivots[k];
                pivot -= sum * self.rows[n][k];
            }
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            self.inverse_pivots[n] = 1.0 / pivot;
            self.count += 1;
        }
        self.valid = true;
        true
    }

    /// `L⁻¹ x_A`, packed in the first entries; the rest is zero.
    #[inline]
    fn forward(&self, x: &SVector<f64, N>) -> SVector<f64, N> {
        let mut y = SVector::zeros();
        for n in 0..self.count {
            let mut sum = x[self.index[n]];
            for k in 0..n {
                sum -= self.rows[n][k] * y[k];
            }
            y[n] = sum;
        }
        y
    }

    /// `D^(−1/2) L⁻¹ x_A`, packed in the first entries: its squared norm is `x_Aᵀ C_AA⁻¹ x_A`.
    #[inline]
    pub fn whitened(&self, x: &SVector<f64, N>) -> SVector<f64, N> {
        let mut y = self.forward(x);
        for n in 0..self.count {
            y[n] *= self.inverse_pivots[n].sqrt();
        }
        y
    }

    /// `C_AA⁻¹ x_A`, unpacked: zero outside A.
    #[inline]
    pub fn solve(&self, x: &SVector<f64, N>) -> SVector<f64, N> {
        let mut y = self.forward(x);
        for n in 0..self.count {
            y[n] *= self.inverse_pivots[n];
        }
        let mut solution = SVector::zeros();
        for n in (0..self.count).rev() {
            let value = y[n];
            for k in 0..n {
                y[k] -= self.rows[n][k] * value;
            }
            solution[self.index[n]] = value;
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Second algorithm: nalgebra's Cholesky of the block, for every block, in an order that reuses rows.
    #[test]
    fn every_block_is_solved() {
        let root = SMatrix::<f64, 5, 5>::from_fn(|r, c| ((r * 5 + c) as f64 * 1.3).sin());
        let c = root * root.transpose() + SMatrix::<f64, 5, 5>::identity() * 0.1;
        let x = SVector::<f64, 5>::from_fn(|i, _| (i as f64 + 0.5).cos());
        let mut factor = SubsetFactor::empty();
        for step in 0..64_u64 {
            let mask = (step * 11) % 32;
            assert!(factor.factor(&c, mask));
            let mut block = SMatrix::<f64, 5, 5>::identity();
            let mut rhs = SVector::<f64, 5>::zeros();
            for &i in factor.coordinates() {
                rhs[i] = x[i];
                for &k in factor.coordinates() {
                    block[(i, k)] = c[(i, k)];
                }
            }
            let expected = block.cholesky().unwrap().solve(&rhs);
            assert!((factor.solve(&x) - expected).amax() < 1e-12, "{mask:b}");
            assert!((factor.whitened(&x).norm_squared() - rhs.dot(&expected)).abs() < 1e-12, "{mask:b}");
        }
        let mut indefinite = c;
        indefinite[(3, 3)] = -1.0;
        factor.invalidate();
        assert!(!factor.factor(&indefinite, 0b11000));
        assert!(factor.factor(&c, 0b00111));
    }
}
