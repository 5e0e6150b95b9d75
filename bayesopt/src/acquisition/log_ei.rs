//! Logarithm of the expected improvement.

use std::f64::consts::PI;

use super::AcquisitionSlope;
use super::normal::{TAIL, normal_cdf, normal_pdf, tail_w};

/// `LogEI = ln sd + ln h(z),   h = φ(z) + z Φ(z),   z = (best − mean)/sd`   (ament2023, eq. 9).
///
/// `∂/∂mean = −h'/(h sd)`, `∂/∂sd = (1 − z h'/h)/sd`, h' = Φ. Finite for every finite z: where h
/// underflows, h = φ·w with w from its asymptotic series. Target units, `sd > 0`.
pub fn log_expected_improvement(mean: f64, sd: f64, best: f64) -> AcquisitionSlope {
    let z = (best - mean) / sd;
    let (log_h, ratio) = log_h_and_slope(z);
    AcquisitionSlope { value: sd.ln() + log_h, d_mean: -ratio / sd, d_sd: (1.0 - z * ratio) / sd }
}

/// `(ln h, h'/h)` with h = φ + zΦ and h' = Φ.
fn log_h_and_slope(z: f64) -> (f64, f64) {
    if z > -1.0 {
        let (h, cdf) = (normal_pdf(z) + z * normal_cdf(z), normal_cdf(z));
        return (h.ln(), cdf / h);
    }
    // h = φ w, w = 1 + z m, m = Φ/φ the Mills ratio.
    let (w, mills) = if z > TAIL {
        let mills = normal_cdf(z) / normal_pdf(z);
        (1.0 + z * mills, mills)
    } else {
        let w = tail_w(z);
        (w, (1.0 - w) / -z)
    };
    (-0.5 * z * z - 0.5 * (2.0 * PI).ln() + w.ln(), mills / w)
}

#[cfg(test)]
mod tests {
    use super::super::ei::expected_improvement;
    use super::*;

    #[test]
    fn it_is_the_logarithm_of_the_expected_improvement() {
        for k in -50..=50 {
            let mean = 0.1 * f64::from(k);
            let (log_ei, ei) = (log_expected_improvement(mean, 0.8, 0.2), expected_improvement(mean, 0.8, 0.2));
            // EI itself cancels to about z²·1e-16 relative at z = −6.
            assert!((log_ei.value - ei.value.ln()).abs() < 1e-9, "{mean}");
            assert!((log_ei.d_mean - ei.d_mean / ei.value).abs() < 1e-8 * (1.0 + log_ei.d_mean.abs()));
        }
    }

    #[test]
    fn reference_values() {
        // ln(φ(z) + zΦ(z)) with mpmath at 60 digits.
        for (z, want) in REFERENCE {
            let got = log_expected_improvement(-z, 1.0, 0.0).value;
            assert!((got / want - 1.0).abs() < 1e-13, "{z}: {got} {want}");
        }
    }

    /// Computed with mpmath 1.3, mp.dps = 60.
    const REFERENCE: [(f64, f64); 12] = [
        (2.0, 0.6973835457882284),
        (0.0, -0.9189385332046728),
        (-0.5, -1.6205162643873199),
        (-1.0, -2.4851210257126413),
        (-3.0, -7.869686059603029),
        (-10.0, -55.55312203612235),
        (-14.5, -111.40627414748852),
        (-15.5, -126.53792845584125),
        (-40.0, -808.29856835662),
        (-1000.0, -500014.73445209116),
        (-1000000.0, -500000000028.55),
        (-100000000.0, -5000000000000038.0),
    ];

    #[test]
    fn finite_and_monotone_over_sixteen_decades_of_z() {
        let mut previous = f64::INFINITY;
        for k in -800..=800 {
            let z = -(10.0_f64.powf(0.01 * f64::from(k)));
            let at = log_expected_improvement(-z, 1.0, 0.0);
            assert!(at.value.is_finite() && at.d_mean.is_finite() && at.d_sd.is_finite(), "{z}");
            assert!(at.value < previous, "{z}");
            assert!(at.d_mean < 0.0 && at.d_sd > 0.0, "{z}: {at:?}");
            previous = at.value;
        }
        assert!(log_expected_improvement(1e8, 1.0, 0.0).value < -4.9e15);
    }

    #[test]
    fn slopes_match_central_differences_in_every_branch() {
        for z in [1.5, -0.5, -0.999, -1.001, -5.0, -14.99, -15.01, -60.0, -1e3] {
            let at = log_expected_improvement(-z, 1.0, 0.0);
            let h = 1e-5;
            let value = |mean: f64, sd: f64| log_expected_improvement(mean, sd, 0.0).value;
            let d_mean = (value(-z + h, 1.0) - value(-z - h, 1.0)) / (2.0 * h);
            let d_sd = (value(-z, 1.0 + h) - value(-z, 1.0 - h)) / (2.0 * h);
            // Rounding of a value near z²/2 divided by the step.
            let tolerance = 1e-7 * (1.0 + z * z);
            assert!((d_mean - at.d_mean).abs() < tolerance, "{z}: {d_mean} {at:?}");
            assert!((d_sd - at.d_sd).abs() < tolerance, "{z}: {d_sd} {at:?}");
        }
    }
}
