//! Zero-phase smoothing and differentiation of a uniformly sampled signal.

/// Savitzky–Golay filter (savitzky1964): the derivative at the centre of a local quadratic fitted to 2m + 1 samples.
///
/// ```text
/// ẋ_k = Σ_{i=−m..m} i x_{k+i} / (dt Σ i²)
/// ```
///
/// For a quadratic the derivative kernel is that of a straight line. Zero phase; near the ends the window shrinks
/// symmetrically, and the very first and last sample use a one-sided difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SavitzkyGolay {
    /// Samples on each side of the centre, m ≥ 1.
    pub half_width: usize,
}

impl SavitzkyGolay {
    /// First derivative of x, sampled every `dt_s` (s). Same length as x; empty or single samples give zeros.
    pub fn derivative(&self, x: &[f64], dt_s: f64) -> Vec<f64> {
        let n = x.len();
        if n < 2 {
            return vec![0.0; n];
        }
        (0..n)
            .map(|k| {
                let m = self.half_width.min(k).min(n - 1 - k);
                if m == 0 {
                    let (a, b) = if k == 0 { (0, 1) } else { (n - 2, n - 1) };
                    return (x[b] - x[a]) / dt_s;
                }
                let (mut slope, mut weight) = (0.0, 0.0);
                for i in 1..=m {
                    let lever = i as f64;
                    slope += lever * (x[k + i] - x[k - i]);
                    weight += 2.0 * lever * lever;
                }
                slope / (weight * dt_s)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_on_quadratics() {
        let dt = 0.01;
        let x: Vec<f64> = (0..60).map(|k| 1.0 + 2.0 * (k as f64 * dt) - 3.0 * (k as f64 * dt).powi(2)).collect();
        let derivative = SavitzkyGolay { half_width: 10 }.derivative(&x, dt);
        for (k, value) in derivative.iter().enumerate().take(59).skip(1) {
            assert!((value - (2.0 - 6.0 * k as f64 * dt)).abs() < 1e-11);
        }
    }
}
