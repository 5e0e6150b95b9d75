//! Matrices that the evaluations of a likelihood share.

use faer::Mat;

use super::cholesky::Cholesky;
use crate::BayesoptError;
use crate::kernel::KernelFamily;

/// Coordinates that are summed side by side; a point is padded to whole lanes.
const LANES: usize = 4;

/// Room for K,  `A = K + σ_n² I = L Lᵀ`,  L⁻¹, A⁻¹ and the slopes of the kernel, n × n, lower triangles.
///
/// Five matrices of a thousand rows are 38 MB: to ask the system for them at every evaluation of an ascent costs a fifth
/// of it.
#[derive(Debug, Clone)]
pub(super) struct Workspace {
    /// z = x/ℓ, coordinate by coordinate: n numbers each, so that one loop runs along the points.
    scaled: Vec<f64>,
    /// z point by point, padded with zeros to `stride` numbers each.
    rows: Vec<f64>,
    stride: usize,
    /// L.
    pub(super) cholesky: Cholesky,
    covariance: Mat<f64>,
    /// dρ/dr² of each pair.
    slopes: Mat<f64>,
    inverse_factor: Mat<f64>,
    inverse: Mat<f64>,
    /// A number per point.
    column: Vec<f64>,
}

impl Workspace {
    /// For n points of `dimension` coordinates.
    pub(super) fn new(n: usize, dimension: usize) -> Self {
        let stride = dimension.next_multiple_of(LANES);
        Self {
            scaled: vec![0.0; n * dimension],
            rows: vec![0.0; n * stride],
            stride,
            cholesky: Cholesky::unfilled(n),
            covariance: Mat::zeros(n, n),
            slopes: Mat::zeros(n, n),
            inverse_factor: Mat::zeros(n, n),
            inverse: Mat::zeros(n, n),
            column: vec![0.0; n],
        }
    }

    /// Takes `points` in units of `lengthscales`.
    pub(super) fn scale(&mut self, points: &[Vec<f64>], lengthscales: &[f64]) {
        let (n, stride) = (points.len(), self.stride);
        for (c, l) in lengthscales.iter().enumerate() {
            for (k, x) in points.iter().enumerate() {
                let z = x[c] / l;
                self.scaled[c * n + k] = z;
                self.rows[k * stride + c] = z;
            }
        }
    }

    /// Factorises the covariance of the targets, and keeps it and the slopes of the kernel.
    ///
    /// # Errors
    /// `NonPositivePivot`.
    pub(super) fn factor(&mut self, family: KernelFamily, signal: f64, noise: f64) -> Result<(), BayesoptError> {
        let n = self.column.len();
        for j in 0..n {
            let squares = &mut self.column[j + 1..];
            squares.fill(0.0);
            for z in self.scaled.chunks_exact(n) {
                let at = z[j];
                squares.iter_mut().zip(&z[j + 1..]).for_each(|(r2, z)| *r2 += (z - at) * (z - at));
            }
            let covariance = &mut self.covariance.col_as_slice_mut(j)[j..];
            covariance[0] = signal + noise;
            let slopes = &mut self.slopes.col_as_slice_mut(j)[j + 1..];
            for ((covariance, slope), r2) in covariance[1..].iter_mut().zip(slopes).zip(squares) {
                let (rho, d_rho) = family.correlation_and_slope(*r2);
                *covariance = signal * rho;
                *slope = d_rho;
            }
        }
        self.cholesky.refactor(|lower| lower.copy_from_triangular_lower(&self.covariance))
    }

    /// `½ tr((α αᵀ − A⁻¹) ∂A/∂θ)` for θ = ln ℓ of every coordinate, then ln σ_f², then ln σ_n².
    pub(super) fn traces(&mut self, alpha: &[f64], signal: f64, noise: f64) -> Vec<f64> {
        self.cholesky.invert(&mut self.inverse_factor, &mut self.inverse);
        let (n, stride) = (self.column.len(), self.stride);
        let mut by_lengthscale = vec![0.0; stride];
        let (mut by_signal, mut by_noise) = (0.0, 0.0);
        for j in 0..n {
            let (slopes, inverse) = (self.slopes.col_as_slice(j), self.inverse.col_as_slice(j));
            let covariance = self.covariance.col_as_slice(j);
            let weight = alpha[j] * alpha[j] - inverse[j];
            by_signal += 0.5 * weight * signal;
            by_noise += 0.5 * weight * noise;
            // Pairs below the diagonal stand for both, which cancels the ½.
            for i in j + 1..n {
                let weight = alpha[i] * alpha[j] - inverse[i];
                by_signal += weight * covariance[i];
                self.column[i] = -2.0 * signal * slopes[i] * weight;
            }
            let at = &self.rows[j * stride..(j + 1) * stride];
            for lane in (0..stride).step_by(LANES) {
                let first: [f64; LANES] = std::array::from_fn(|c| at[lane + c]);
                let mut sums: [f64; LANES] = std::array::from_fn(|c| by_lengthscale[lane + c]);
                let others = self.rows[(j + 1) * stride..].chunks_exact(stride);
                for (weight, other) in self.column[j + 1..].iter().zip(others) {
                    let other = &other[lane..lane + LANES];
                    for c in 0..LANES {
                        sums[c] += weight * (other[c] - first[c]) * (other[c] - first[c]);
                    }
                }
                by_lengthscale[lane..lane + LANES].copy_from_slice(&sums);
            }
        }
        by_lengthscale.truncate(self.scaled.len() / n);
        by_lengthscale.extend([by_signal, by_noise]);
        by_lengthscale
    }
}
