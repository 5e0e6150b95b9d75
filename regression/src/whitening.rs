//! Autoregressive whitening of residuals and regressors.

use std::ops::Range;

use crate::noise_level::robust_sd;

/// `w_k = (x_k − Σ a_i x_{k−i}) / σ` inside a burst; its first p samples are dropped.
///
/// Residuals of a robot log are strongly autocorrelated: without this step every p-value is fantasy. The coefficients
/// come from the autocovariance of the residual that is left when everything has been fitted, averaged over the
/// quietest pieces (Levinson–Durbin); σ is the robust scale of the innovations.
#[derive(Clone, Debug, PartialEq)]
pub struct Whitening {
    coefficients: Vec<f64>,
    /// Scale of the innovations (Nm).
    pub scale: f64,
}

/// Highest order.
const ORDER: usize = 12;
/// Samples of a piece.
const PIECE: usize = 150;
/// Share of the pieces, quietest first, that the colour is taken from.
const QUIET_SHARE: f64 = 0.7;
/// Samples per coefficient.
const SAMPLES_PER_COEFFICIENT: usize = 15;

impl Whitening {
    /// The whitening filter of a residual in bursts; its scale is at least `least_scale`.
    pub fn of(residual: &[f64], bursts: &[Range<usize>], least_scale: f64) -> Self {
        let order = ORDER.min(residual.len() / SAMPLES_PER_COEFFICIENT);
        let mut pieces: Vec<(f64, Vec<f64>)> = Vec::new();
        for burst in bursts {
            for piece in residual[burst.clone()].chunks(PIECE) {
                if piece.len() > 3 * order.max(1) {
                    let covariance = autocovariance(piece, order);
                    pieces.push((covariance[0], covariance));
                }
            }
        }
        pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
        pieces.truncate(((pieces.len() as f64 * QUIET_SHARE).ceil() as usize).max(1));
        let mut mean = vec![0.0; order + 1];
        for (_, covariance) in &pieces {
            mean.iter_mut().zip(covariance).for_each(|(sum, c)| *sum += c / pieces.len() as f64);
        }
        let coefficients = levinson_durbin(&mean);
        let unit = Self { coefficients, scale: 1.0 };
        let innovations = bursts.iter().flat_map(|burst| unit.apply(&residual[burst.clone()]));
        let scale = robust_sd(innovations).max(least_scale).max(f64::MIN_POSITIVE);
        Self { scale, ..unit }
    }

    /// Samples dropped at the start of a burst.
    pub fn order(&self) -> usize {
        self.coefficients.len()
    }

    /// One burst, whitened: `order` samples shorter, empty if it was no longer than that.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let order = self.order();
        (order..x.len())
            .map(|k| {
                let predicted: f64 = self.coefficients.iter().enumerate().map(|(i, a)| a * x[k - 1 - i]).sum();
                (x[k] - predicted) / self.scale
            })
            .collect()
    }

    /// The transpose of [`Self::apply`]: as long as the burst was.
    pub fn apply_adjoint(&self, white: &[f64]) -> Vec<f64> {
        let order = self.order();
        let mut x = vec![0.0; white.len() + if white.is_empty() { 0 } else { order }];
        for (k, w) in white.iter().enumerate() {
            x[k + order] += w / self.scale;
            for (i, a) in self.coefficients.iter().enumerate() {
                x[k + order - 1 - i] -= a * w / self.scale;
            }
        }
        x
    }

    /// Squared gain at an angle per sample (rad).
    pub fn power_gain(&self, angle: f64) -> f64 {
        let (mut real, mut imaginary) = (1.0, 0.0);
        for (i, a) in self.coefficients.iter().enumerate() {
            let (sine, cosine) = (angle * (i + 1) as f64).sin_cos();
            real -= a * cosine;
            imaginary += a * sine;
        }
        (real * real + imaginary * imaginary) / self.scale.powi(2)
    }
}

/// Biased autocovariance about zero up to lag `order`.
fn autocovariance(x: &[f64], order: usize) -> Vec<f64> {
    (0..=order).map(|lag| x.iter().zip(&x[lag..]).map(|(a, b)| a * b).sum::<f64>() / x.len() as f64).collect()
}

/// Coefficients of the autoregression with this autocovariance.
fn levinson_durbin(covariance: &[f64]) -> Vec<f64> {
    let order = covariance.len().saturating_sub(1);
    let mut a: Vec<f64> = Vec::with_capacity(order);
    let mut error = covariance.first().copied().unwrap_or(0.0);
    for m in 0..order {
        if error <= 1e-12 * covariance[0] || error <= 0.0 {
            break;
        }
        let predicted: f64 = a.iter().enumerate().map(|(i, a)| a * covariance[m - i]).sum();
        let reflection = (covariance[m + 1] - predicted) / error;
        let before = a.clone();
        for (i, a) in a.iter_mut().enumerate() {
            *a -= reflection * before[m - 1 - i];
        }
        a.push(reflection);
        error *= 1.0 - reflection * reflection;
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recovers_an_autoregression_and_whitens_it() {
        let mut gauss = crate::noise_level::gaussian(7);
        let mut x = vec![0.0, 0.0];
        for k in 2..30_000 {
            let next = 1.2 * x[k - 1] - 0.5 * x[k - 2] + 0.3 * gauss();
            x.push(next);
        }
        let whole = 0..x.len();
        let whitening = Whitening::of(&x, std::slice::from_ref(&whole), 0.0);
        assert!((whitening.coefficients[0] - 1.2).abs() < 0.05, "{:?}", whitening.coefficients);
        assert!((whitening.coefficients[1] + 0.5).abs() < 0.05);
        assert!((whitening.scale / 0.3 - 1.0).abs() < 0.05);
        let white = whitening.apply(&x);
        let lag_one = autocovariance(&white, 1);
        // 0.8 before. The quiet pieces are the less correlated ones, which leaves 0.06; the sign flips measure what is left.
        assert!((lag_one[1] / lag_one[0]).abs() < 0.08, "{lag_one:?}");
        assert!(Whitening::of(&[], &[], 1.0).apply(&[]).is_empty());
    }
}
