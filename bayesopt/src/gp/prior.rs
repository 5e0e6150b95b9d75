//! Priors of the hyper-parameters.

use std::f64::consts::{PI, SQRT_2};

use serde::{Deserialize, Serialize};

/// `ln p(x) = −(ln x − μ)²/(2σ²) − ln x − ln(σ√(2π))`, the density of x with ln x ~ N(μ, σ²).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogNormal {
    /// μ, location of ln x.
    pub location: f64,
    /// σ, scale of ln x.
    pub scale: f64,
}

impl LogNormal {
    /// `(ln p, d ln p / d ln x)` at ln x.
    pub fn log_density(self, log_x: f64) -> (f64, f64) {
        let z = (log_x - self.location) / self.scale;
        (-0.5 * z * z - log_x - (self.scale * (2.0 * PI).sqrt()).ln(), -z / self.scale - 1.0)
    }

    /// ln of the mode of x:  `μ − σ²`.
    pub fn log_mode(self) -> f64 {
        self.location - self.scale * self.scale
    }
}

/// Which prior stands before the marginal likelihood.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HyperPrior {
    /// None: ML-II, the marginal likelihood alone.
    Flat,
    /// ℓ_i ~ LogNormal(√2 + ½ ln d, √3), σ_n² ~ LogNormal(−8, 3), σ_f² ~ LogNormal(0, 1).
    ///
    /// The noise prior is wide, from 1e-6 to 0.1 of the variance of the costs: the usual LogNormal(−4, 1)
    /// insists on noise and stops a repeatable cost far from its minimum (branin2: 1.1e-2 instead of 3e-4,
    /// median of 8 seeds of `examples/regret.rs`).
    ///
    /// The length-scale grows as √d, as the distance of random points does, so that the model
    /// stays as simple in 50-D as in 2-D (hvarfner2024). Costs are standardised, hence σ_f² near 1.
    ///
    /// The length-scales are pooled: times `exp(−½ Σ ((ln ℓ_i − mean ln ℓ)/0.3)²)`. Fifty trials cannot tell 14 relevances
    /// apart, and those that a likelihood finds by chance mislead (ackley14: 8.6 instead of 9.1 at 0.5, median of 20 seeds).
    /// The variances of a trend are LogNormal(0, 3) each.
    DimensionScaled,
}

/// How far length-scales lie apart before the data speak, in ln ℓ.
const POOLING_SCALE: f64 = 0.3;

impl HyperPrior {
    /// Prior of each length-scale in `dimension` coordinates.
    pub fn lengthscale(self, dimension: usize) -> Option<LogNormal> {
        self.informed(SQRT_2 + 0.5 * (dimension as f64).ln(), 3.0_f64.sqrt())
    }

    /// Prior of the noise variance σ_n² of standardised targets.
    pub fn noise(self) -> Option<LogNormal> {
        self.informed(-8.0, 3.0)
    }

    /// Prior of the signal variance σ_f² of standardised targets.
    pub fn signal(self) -> Option<LogNormal> {
        self.informed(0.0, 1.0)
    }

    /// Prior of the variances of a trend.
    pub fn trend(self) -> Option<LogNormal> {
        self.informed(0.0, 3.0)
    }

    /// `−½ Σ ((ln ℓ_i − mean)/s)²`, its slopes added to `gradient`.
    pub(super) fn pooling(self, log_lengthscales: &[f64], gradient: &mut [f64]) -> f64 {
        if self == Self::Flat {
            return 0.0;
        }
        let mean = log_lengthscales.iter().sum::<f64>() / log_lengthscales.len() as f64;
        let mut sum = 0.0;
        for (l, gradient) in log_lengthscales.iter().zip(gradient) {
            let z = (l - mean) / POOLING_SCALE;
            sum -= 0.5 * z * z;
            *gradient -= z / POOLING_SCALE;
        }
        sum
    }

    /// Least noise variance that is searched: a repeatable cost is followed down to rounding.
    pub(super) fn least_noise(self) -> f64 {
        match self {
            Self::Flat => 1e-6,
            Self::DimensionScaled => 1e-9,
        }
    }

    fn informed(self, location: f64, scale: f64) -> Option<LogNormal> {
        (self == Self::DimensionScaled).then_some(LogNormal { location, scale })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_integrates_to_one_and_its_slope_is_its_derivative() {
        let prior = LogNormal { location: -0.3, scale: 0.8 };
        // ∫ p(x) dx = ∫ p(e^t) e^t dt by the trapezoidal rule, exact to rounding for a Gaussian.
        let mass: f64 =
            (-2000..=2000).map(|k| k as f64 * 5e-3).map(|t| (prior.log_density(t).0 + t).exp() * 5e-3).sum();
        assert!((mass - 1.0).abs() < 1e-12);
        let (h, t) = (1e-5, 0.4);
        let slope = (prior.log_density(t + h).0 - prior.log_density(t - h).0) / (2.0 * h);
        assert!((slope - prior.log_density(t).1).abs() < 1e-9);
        assert!(prior.log_density(prior.log_mode()).1.abs() < 1e-15);
    }
}
