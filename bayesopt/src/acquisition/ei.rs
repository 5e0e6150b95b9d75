//! Expected improvement.

use super::AcquisitionSlope;
use super::normal::{normal_cdf, normal_pdf};

/// `EI = sd·(φ(z) + z Φ(z)),   z = (best − mean)/sd`   (mockus1975, jones1998), for minimisation.
///
/// `∂EI/∂mean = −Φ(z)`, `∂EI/∂sd = φ(z)`. All in target units, `sd > 0`.
pub fn expected_improvement(mean: f64, sd: f64, best: f64) -> AcquisitionSlope {
    let z = (best - mean) / sd;
    let (pdf, cdf) = (normal_pdf(z), normal_cdf(z));
    AcquisitionSlope { value: sd * (pdf + z * cdf).max(0.0), d_mean: -cdf, d_sd: pdf }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms() {
        // At z = 0, EI = sd/√(2π); far below the incumbent, EI = best − mean.
        let at_zero = expected_improvement(2.0, 3.0, 2.0);
        assert!((at_zero.value - 3.0 / (2.0 * std::f64::consts::PI).sqrt()).abs() < 1e-15);
        assert!((expected_improvement(-7.0, 0.1, 1.0).value - 8.0).abs() < 1e-14);
        // φ(1) + Φ(1), from tables.
        assert!((expected_improvement(0.0, 1.0, 1.0).value - 1.083_315_470_587_686_4).abs() < 1e-14);
    }

    #[test]
    fn quadrature_agrees() {
        // Second algorithm: ∫ max(best − y, 0) p(y) dy by the trapezoidal rule.
        let (mean, sd, best) = (0.4, 0.7, 0.1);
        let step = 1e-4;
        let integrand = |y: f64| (best - y) * normal_pdf((y - mean) / sd) / sd;
        let sum: f64 = (1..80_000).map(|k| integrand(best - k as f64 * step) * step).sum();
        assert!((sum - expected_improvement(mean, sd, best).value).abs() < 1e-8);
    }

    #[test]
    fn slopes_match_central_differences() {
        for (mean, sd, best) in [(0.3, 0.8, 0.1), (-1.0, 0.5, 0.2), (2.0, 0.9, -0.5)] {
            let at = expected_improvement(mean, sd, best);
            let h = 1e-6;
            let value = |mean, sd| expected_improvement(mean, sd, best).value;
            assert!(((value(mean + h, sd) - value(mean - h, sd)) / (2.0 * h) - at.d_mean).abs() < 1e-9);
            assert!(((value(mean, sd + h) - value(mean, sd - h)) / (2.0 * h) - at.d_sd).abs() < 1e-9);
        }
    }
}
