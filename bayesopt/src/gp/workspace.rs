//! Matrices that the evaluations of a likelihood share.

use faer::Mat;

use super::cholesky::Cholesky;
use super::hyper::HyperParameters;
use crate::BayesoptError;
use crate::kernel::{KernelFamily, KernelShape, trend_correlations};

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
    /// (dρ/dr²)·r² of the coordinates by themselves at r² = d r_i², coordinate by coordinate within each column of pairs;
    /// empty for a joint kernel.
    alone: Vec<f64>,
    /// Correlations of the linear and of the quadratic trend; empty without one.
    trend: Vec<Mat<f64>>,
    inverse_factor: Mat<f64>,
    inverse: Mat<f64>,
    /// A number per point.
    column: Vec<f64>,
    weights: Vec<f64>,
}

impl Workspace {
    /// For a kernel of this shape on `points` of `dimension` coordinates.
    pub(super) fn new(points: &[Vec<f64>], dimension: usize, shape: KernelShape) -> Self {
        let n = points.len();
        let pairs = if shape.structure.additive_share() > 0.0 { n * n.saturating_sub(1) / 2 } else { 0 };
        let part = |k: usize| {
            Mat::from_fn(n, n, |i, j| if i < j { 0.0 } else { trend_correlations(&points[i], &points[j])[k] })
        };
        let stride = dimension.next_multiple_of(LANES);
        Self {
            scaled: vec![0.0; n * dimension],
            rows: vec![0.0; n * stride],
            stride,
            cholesky: Cholesky::unfilled(n),
            covariance: Mat::zeros(n, n),
            slopes: Mat::zeros(n, n),
            alone: vec![0.0; pairs * dimension],
            trend: if shape.trend { vec![part(0), part(1)] } else { vec![] },
            inverse_factor: Mat::zeros(n, n),
            inverse: Mat::zeros(n, n),
            column: vec![0.0; n],
            weights: Vec::with_capacity(n),
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

    /// Factorises the covariance of the targets, and keeps its stationary part and the slopes of the kernel.
    ///
    /// # Errors
    /// `NonPositivePivot`.
    pub(super) fn factor(&mut self, shape: KernelShape, hyper: &HyperParameters) -> Result<(), BayesoptError> {
        let n = self.column.len();
        let (signal, noise) = (hyper.signal_variance, hyper.noise_variance);
        let (family, share) = (shape.family, shape.structure.additive_share());
        let d = self.scaled.len() / n.max(1);
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
            if share > 0.0 {
                self.add_alone(j, d, family, share, signal);
            }
        }
        let parts = hyper.trend.map_or([0.0; 2], |trend| [trend.linear, trend.quadratic]);
        self.cholesky.refactor(|lower| {
            lower.copy_from_triangular_lower(&self.covariance);
            for (variance, part) in parts.iter().zip(&self.trend) {
                for j in 0..n {
                    let rows = &mut lower.col_as_slice_mut(j)[j..];
                    rows.iter_mut().zip(&part.col_as_slice(j)[j..]).for_each(|(k, p)| *k += variance * p);
                }
            }
        })
    }

    /// Turns column j of the joint kernel into that of the additive one, and keeps the slopes of its terms.
    fn add_alone(&mut self, j: usize, d: usize, family: KernelFamily, share: f64, signal: f64) {
        let n = self.column.len();
        let rows = n - j - 1;
        let first = j * (2 * n - j - 1) / 2 * d;
        let sums = &mut self.column[j + 1..];
        sums.fill(0.0);
        for (c, z) in self.scaled.chunks_exact(n).enumerate() {
            let kept = &mut self.alone[first + c * rows..first + (c + 1) * rows];
            for ((sum, kept), other) in sums.iter_mut().zip(kept).zip(&z[j + 1..]) {
                let r2 = d as f64 * (other - z[j]) * (other - z[j]);
                let (rho, slope) = family.correlation_and_slope(r2);
                *sum += rho;
                *kept = slope * r2;
            }
        }
        let scale = signal * share / d as f64;
        let covariance = &mut self.covariance.col_as_slice_mut(j)[j + 1..];
        for (covariance, sum) in covariance.iter_mut().zip(&*sums) {
            *covariance = (1.0 - share) * *covariance + scale * sum;
        }
    }

    /// `½ tr((α αᵀ − A⁻¹) ∂A/∂θ)` for θ = ln ℓ of every coordinate, then ln σ_f², ln σ_n² and the trend's two.
    pub(super) fn traces(&mut self, shape: KernelShape, hyper: &HyperParameters, alpha: &[f64]) -> Vec<f64> {
        let (signal, noise) = (hyper.signal_variance, hyper.noise_variance);
        let share = shape.structure.additive_share();
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
            if share > 0.0 {
                let d = self.scaled.len() / n;
                let (rows, first) = (n - j - 1, j * (2 * n - j - 1) / 2 * d);
                // The weights again, since `column` holds them times the slope of the joint term.
                let scale = -2.0 * signal * share / d as f64;
                self.weights.clear();
                self.weights.extend((j + 1..n).map(|i| scale * (alpha[i] * alpha[j] - inverse[i])));
                for (c, sum) in by_lengthscale[..d].iter_mut().enumerate() {
                    let kept = &self.alone[first + c * rows..first + (c + 1) * rows];
                    *sum += self.weights.iter().zip(kept).map(|(weight, pull)| weight * pull).sum::<f64>();
                }
                self.column[j + 1..].iter_mut().for_each(|weight| *weight *= 1.0 - share);
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
        let parts = hyper.trend.map_or([0.0; 2], |trend| [trend.linear, trend.quadratic]);
        for (variance, part) in parts.iter().zip(&self.trend) {
            let column = |j: usize| {
                let (part, inverse) = (part.col_as_slice(j), self.inverse.col_as_slice(j));
                let weighted = |i: usize| (alpha[i] * alpha[j] - inverse[i]) * part[i];
                0.5 * weighted(j) + (j + 1..n).map(weighted).sum::<f64>()
            };
            by_lengthscale.push(variance * (0..n).map(column).sum::<f64>());
        }
        by_lengthscale
    }
}
