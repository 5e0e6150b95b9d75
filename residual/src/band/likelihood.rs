//! How well a band explains the torque of one joint.

use std::f64::consts::{PI, SQRT_2};

use tribo_friction::JointBand;

/// One joint along a contact-free log, as the observer sees it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct JointRows {
    /// Measured velocity (rad/s).
    pub qd: Vec<f64>,
    /// Residual: friction and noise through the low-pass (Nm).
    pub residual: Vec<f64>,
    /// Share of the row in the low-pass; 1 restarts it.
    pub share: Vec<f64>,
    /// Whether the row counts: settled, and far enough from the last that counts.
    pub counts: Vec<bool>,
}

impl JointRows {
    /// Calls `each(row, lower, upper)` with the low-passed bounds (Nm) of every row that counts.
    pub fn bounded(&self, band: &JointBand, each: &mut dyn FnMut(usize, f64, f64)) {
        let [mut lower, mut upper] = [0.0; 2];
        for k in 0..self.qd.len() {
            let [l, u] = band.limits_nm(self.qd[k]);
            lower += self.share[k] * (l - lower);
            upper += self.share[k] * (u - upper);
            if self.counts[k] {
                each(k, lower, upper);
            }
        }
    }

    /// Rows that count.
    pub fn count(&self) -> usize {
        self.counts.iter().filter(|&&counts| counts).count()
    }
}

/// Share of rows that may be anything: an unlucky bump must not open the band.
const CONTAMINATION: f64 = 0.01;

/// `Σ ln ((1 − ε) p(y | lower, upper, σ) + ε/range)` over the rows that count, p the density of uniform friction in the
/// band plus normal noise:
///
/// ```text
/// p = (Φ((y − lower)/σ) − Φ((y − upper)/σ)) / (upper − lower),   the normal density when the band has no width
/// ```
///
/// A band wider than needed pays ln(width) on every row inside, one too narrow pays for every row outside as far as
/// the contamination ε = 1 % does not take it.
pub(super) fn log_likelihood(rows: &JointRows, band: &JointBand, range_nm: f64) -> f64 {
    let floor = CONTAMINATION / range_nm;
    let mut sum = 0.0;
    rows.bounded(band, &mut |k, lower, upper| {
        let sd = band.noise_sd_nm(rows.qd[k]);
        sum += ((1.0 - CONTAMINATION) * density(rows.residual[k], lower, upper, sd) + floor).ln();
    });
    sum
}

/// Density (1/Nm) of uniform(lower, upper) + normal(0, sd) at y.
fn density(y: f64, lower: f64, upper: f64, sd: f64) -> f64 {
    let (a, b) = ((y - lower) / sd, (y - upper) / sd);
    let width = a - b;
    if width < 1e-5 {
        let z = 0.5 * (a + b);
        return (-0.5 * z * z).exp() / (sd * (2.0 * PI).sqrt());
    }
    // On the side of the tail, where the difference of two small numbers is exact.
    let tail = |z: f64| 0.5 * libm::erfc(z / SQRT_2);
    let mass = if b > 0.0 { tail(b) - tail(a) } else { tail(-a) - tail(-b) };
    mass / (width * sd)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quadrature of the convolution, and both limits.
    #[test]
    fn the_density_is_the_convolution() {
        for (lower, upper, sd) in [(-1.0, 2.0, 0.3), (0.0, 0.01, 0.3), (0.5, 0.5 + 1e-7, 0.2)] {
            for y in [-1.5, -0.9, 0.2, 0.7, 2.1, 3.0] {
                let n = 2000;
                let mean: f64 = (0..n)
                    .map(|k| lower + (upper - lower) * (f64::from(k) + 0.5) / f64::from(n))
                    .map(|t| (-0.5 * ((y - t) / sd).powi(2)).exp() / (sd * (2.0 * PI).sqrt()))
                    .sum::<f64>()
                    / f64::from(n);
                assert!((density(y, lower, upper, sd) - mean).abs() < 1e-6 * (1.0 + mean), "{lower} {y}");
            }
        }
    }
}
