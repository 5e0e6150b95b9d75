//! Normal equations of friction in a wrench.

use nalgebra::{DMatrix, DVector, Matrix6, Vector6};

use super::gls_rows::{Layout, error_covariance, fill_rows};
use super::{GlsError, GlsSample, GlsSettings, minimize_in_box};

/// `A = Σ Rᵀ S⁻¹ R`, `b = Σ Rᵀ S⁻¹ y`, `c = Σ yᵀ S⁻¹ y` of rows R = W Φ, targets y and error covariances S: all that a fit and its
/// residual need to know of a block of samples. Blocks add up.
#[derive(Clone, Debug)]
pub(super) struct NormalEquations {
    information: DMatrix<f64>,
    score: DVector<f64>,
    /// c.
    pub square: f64,
}

/// Coefficients and their covariance, bounds ignored.
pub(super) struct Solution {
    pub theta: DVector<f64>,
    pub covariance: DMatrix<f64>,
}

impl NormalEquations {
    /// Of no samples.
    pub fn zero(unknowns: usize) -> Self {
        Self { information: DMatrix::zeros(unknowns, unknowns), score: DVector::zeros(unknowns), square: 0.0 }
    }

    /// Of a block whose first sample has the index `first` in its log.
    pub fn of<'a, const N: usize>(
        block: impl IntoIterator<Item = &'a GlsSample<N>>,
        first: usize,
        settings: &GlsSettings<N>,
        layout: &Layout,
    ) -> Result<Self, GlsError> {
        let mut sum = Self::zero(layout.total);
        let mut rows = DMatrix::<f64>::zeros(6, layout.total);
        // One covariance and its inverse for all samples without a stuck joint.
        let mut known: Option<(Matrix6<f64>, Matrix6<f64>)> = None;
        for (k, sample) in block.into_iter().enumerate() {
            let broken = GlsError::NotFinite { index: first + k };
            let y: Vector6<f64> = sample.wrench + sample.wrench_from_torque * sample.tau_compensation;
            if !y.iter().chain(sample.qd.iter()).all(|value| value.is_finite()) {
                return Err(broken);
            }
            let covariance = error_covariance(sample, settings);
            let weight = match known {
                Some((same, weight)) if same == covariance => weight,
                _ => covariance.cholesky().ok_or(broken)?.inverse(),
            };
            known = Some((covariance, weight));
            fill_rows(&mut rows, sample, settings, layout);
            // In place, column by column: thousands of samples, six rows each.
            for c in 0..layout.total {
                let weighted = weight * rows.fixed_view::<6, 1>(0, c);
                for r in c..layout.total {
                    sum.information[(r, c)] += weighted.dot(&rows.fixed_view::<6, 1>(0, r));
                }
                sum.score[c] += weighted.dot(&y);
            }
            sum.square += y.dot(&(weight * y));
        }
        sum.information.fill_upper_triangle_with_lower_triangle();
        Ok(sum)
    }

    /// Adds another block, or takes it away (`sign` −1).
    pub fn add(&mut self, other: &Self, sign: f64) {
        self.information += &other.information * sign;
        self.score += &other.score * sign;
        self.square += sign * other.square;
    }

    /// The coefficients within their bounds, with prior; neighbours count as the few samples they are worth.
    pub fn solve(&self, correlated_samples: f64, layout: &Layout) -> Solution {
        let mut information = &self.information / correlated_samples;
        let score = &self.score / correlated_samples;
        for (k, sd) in layout.prior_sd.iter().enumerate() {
            information[(k, k)] += 1.0 / (sd * sd);
        }
        let theta = minimize_in_box(&information, &score, &layout.lower, &layout.upper).x;
        let covariance = information.try_inverse().unwrap_or_else(|| DMatrix::zeros(layout.total, layout.total));
        Solution { theta, covariance }
    }

    /// `Σ |y − R θ|²` weighted by S⁻¹: what coefficients leave of this block.
    pub fn square_left(&self, theta: &DVector<f64>) -> f64 {
        (self.square - 2.0 * theta.dot(&self.score) + theta.dot(&(&self.information * theta))).max(0.0)
    }
}
