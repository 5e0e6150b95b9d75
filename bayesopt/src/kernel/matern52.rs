//! Matérn correlation of order 5/2.

/// `ρ = (1 + √5 r + 5r²/3) e^{−√5 r}`  and  `dρ/dr² = −(5/6)(1 + √5 r) e^{−√5 r}`.
///
/// rasmussen2006, eq. (4.17). `r2 = r² >= 0`, dimensionless.
#[inline]
pub fn correlation_and_slope(r2: f64) -> (f64, f64) {
    let s = (5.0 * r2).sqrt();
    let decay = (-s).exp();
    ((1.0 + s + s * s / 3.0) * decay, -(5.0 / 6.0) * (1.0 + s) * decay)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_at_unit_distance_is_the_closed_form() {
        // (1 + √5 + 5/3) e^{−√5} computed with 50 digits.
        assert!((correlation_and_slope(1.0).0 - 0.523_994_108_831_820_3).abs() < 1e-15);
    }
}
