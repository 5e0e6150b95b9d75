//! A damped oscillator left alone.

/// Free motion of `ẍ + d ẋ + w² x = 0` over the time h, exactly: from and to [x, ẋ]. `w2` [1/s²], `d` [1/s].
pub fn oscillator_step([x, v]: [f64; 2], w2: f64, d: f64, h: f64) -> [f64; 2] {
    let a = 0.5 * d;
    let gap = a * a - w2;
    // Decayed cosine and sine, the sine over its frequency.
    let (c, s) = if gap < 0.0 {
        let w = (-gap).sqrt();
        let e = (-a * h).exp();
        (e * (w * h).cos(), e * (w * h).sin() / w)
    } else {
        let w = gap.sqrt().max(1e-6 * a);
        let (slow, fast) = ((-w2 / (a + w) * h).exp(), (-(a + w) * h).exp());
        (0.5 * (slow + fast), 0.5 * (slow - fast) / w)
    };
    [x * (c + a * s) + v * s, v * (c - a * s) - w2 * x * s]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Second algorithm: the exact step against ten thousand small Runge–Kutta steps, in all three kinds of damping.
    #[test]
    fn the_oscillator_step_is_exact() {
        for (w2, d) in [(4e4, 20.0), (4e4, 400.0), (4e4, 3000.0), (1e6, 0.0)] {
            let (mut x, mut v) = (1e-3_f64, 0.2_f64);
            let exact = oscillator_step([x, v], w2, d, 1e-2);
            let h = 1e-6;
            let f = |x: f64, v: f64| (v, -d * v - w2 * x);
            for _ in 0..10_000 {
                let (a, b) = f(x, v);
                let (c, e) = f(x + 0.5 * h * a, v + 0.5 * h * b);
                (x, v) = (x + h * c, v + h * e);
            }
            assert!((exact[0] - x).abs() < 1e-8 && (exact[1] - v).abs() < 1e-5, "{exact:?} {x} {v}");
        }
        let stiff = oscillator_step([1.0, 0.0], 1e6, 1e9, 1.0);
        assert!(stiff.iter().all(|value| value.is_finite()));
    }
}
