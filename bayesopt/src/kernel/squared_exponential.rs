//! Squared-exponential correlation.

/// `ρ = e^{−r²/2}`  and  `dρ/dr² = −ρ/2`.
///
/// rasmussen2006, eq. (4.9). `r2 = r² >= 0`, dimensionless.
#[inline]
pub fn correlation_and_slope(r2: f64) -> (f64, f64) {
    let rho = (-0.5 * r2).exp();
    (rho, -0.5 * rho)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_at_unit_distance_is_the_closed_form() {
        assert!((correlation_and_slope(1.0).0 - 0.606_530_659_712_633_4).abs() < 1e-15);
    }
}
