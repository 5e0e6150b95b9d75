//! Differentiation on a uniform grid.

/// Weights of x_{k+i} − x_{k−i}, i = 1, 2, …, of the central differences of order 2, 4, 6 and 8 (fornberg1988).
const WEIGHTS: [&[f64]; 4] = [
    &[1.0 / 2.0],
    &[2.0 / 3.0, -1.0 / 12.0],
    &[3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0],
    &[4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0],
];

/// First derivative by the central difference of 8th order.
///
/// ```text
/// ẋ_k = Σ_{i=1..4} w_i (x_{k+i} − x_{k−i}) / dt,   w = 4/5, −1/5, 4/105, −1/280
/// ```
///
/// Its gain on a sinusoid falls short of 2πf by 3.5e-5 at a tenth of the sample rate, by 0.6 % at a fifth. Towards an end
/// the order shrinks to 6, 4 and 2; the first and the last sample take the one-sided difference. Same length as x; one sample gives zero.
pub fn central_difference(x: &[f64], dt_s: f64) -> Vec<f64> {
    let n = x.len();
    (0..n)
        .map(|k| {
            let reach = k.min(n - 1 - k).min(WEIGHTS.len());
            if reach == 0 {
                let (before, after) = if k == 0 { (0, 1.min(n - 1)) } else { (k - 1, k) };
                return (x[after] - x[before]) / dt_s;
            }
            let weights = WEIGHTS[reach - 1].iter().zip(1..);
            weights.map(|(w, i)| w * (x[k + i] - x[k - i])).sum::<f64>() / dt_s
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An order-p difference is exact on polynomials of degree p, wherever it stands.
    #[test]
    fn exact_on_polynomials_of_its_degree() {
        let dt = 0.1;
        for degree in 1..=8 {
            let x: Vec<f64> = (0..30).map(|k| (f64::from(k) * dt - 1.4).powi(degree)).collect();
            let derivative = central_difference(&x, dt);
            for k in 4..26 {
                let t = k as f64 * dt - 1.4;
                let exact = f64::from(degree) * t.powi(degree - 1);
                assert!((derivative[k] - exact).abs() < 1e-11, "degree {degree} at {t}: {} {exact}", derivative[k]);
            }
        }
        let line: Vec<f64> = (0..9).map(|k| 3.0 * f64::from(k)).collect();
        assert!(central_difference(&line, 1.0).iter().all(|slope| (slope - 3.0).abs() < 1e-12));
        assert_eq!(central_difference(&[5.0], 1.0), [0.0]);
        assert!(central_difference(&[], 1.0).is_empty());
    }

    #[test]
    fn error_falls_with_the_eighth_power_of_the_step() {
        let worst = |n: usize| {
            let dt = 1.0 / n as f64;
            let x: Vec<f64> = (0..=n).map(|k| (7.0 * k as f64 * dt).sin()).collect();
            let derivative = central_difference(&x, dt);
            (4..n - 3).map(|k| (derivative[k] - 7.0 * (7.0 * k as f64 * dt).cos()).abs()).fold(0.0, f64::max)
        };
        let order = (worst(20) / worst(40)).log2();
        assert!((7.8..8.3).contains(&order), "{order}");
    }
}
