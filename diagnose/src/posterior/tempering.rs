//! How many samples of a correlated residual count as one.
//!
//! ```text
//! κ = max(τ_int, S_peak),   τ_int = 1 + 2 Σ ρ_k,   S_peak = max of the Welch spectrum over its mean
//! ```
//!
//! What is left of a real log is error of the model, correlated over 3 to 100 samples. A likelihood that counts every sample
//! is sure of anything; one whitened by an autoregression weighs the high frequencies, where that error is not. So each
//! sample counts 1/κ.

use crate::evidence::inner;

/// Lags that are summed, over τ_int itself (Sokal's window).
const WINDOW: f64 = 4.0;
/// Samples of a segment of the spectrum.
const SEGMENT: [usize; 2] = [32, 512];
/// Segments wanted.
const SEGMENTS: usize = 8;

/// κ of a residual, at least 1.
pub(crate) fn kappa(residual: &[f64]) -> f64 {
    correlation_time(residual).max(spectral_peak(residual))
}

/// τ_int (samples), at least 1.
pub(crate) fn correlation_time(x: &[f64]) -> f64 {
    let n = x.len();
    let square = inner(x, x);
    if square <= 0.0 {
        return 1.0;
    }
    let mut time = 1.0;
    for lag in 1..n / 3 {
        time += 2.0 * inner(&x[..n - lag], &x[lag..]) / square;
        if lag as f64 >= WINDOW * f64::max(time, 1.0) {
            break;
        }
    }
    time.max(1.0)
}

/// Largest value of the averaged spectrum over that of white noise of the same power, at least 1.
pub(crate) fn spectral_peak(x: &[f64]) -> f64 {
    let n = x.len();
    let m = (n / SEGMENTS).clamp(SEGMENT[0], SEGMENT[1]);
    let square = x.iter().map(|x| x * x).sum::<f64>() / n.max(1) as f64;
    if n < m || square <= 0.0 {
        return 1.0;
    }
    let window: Vec<f64> =
        (0..m).map(|k| 0.5 - 0.5 * (2.0 * std::f64::consts::PI * k as f64 / (m - 1) as f64).cos()).collect();
    let window_square: f64 = window.iter().map(|w| w * w).sum();
    let mut power = vec![0.0; m / 2 + 1];
    let mut segments = 0.0;
    for start in (0..=n - m).step_by(m / 2) {
        let windowed: Vec<f64> = x[start..start + m].iter().zip(&window).map(|(x, w)| x * w).collect();
        for (chunk, power) in power.chunks_mut(LANES).enumerate() {
            let angle = |lane: usize| 2.0 * std::f64::consts::PI * (LANES * chunk + lane) as f64 / m as f64;
            let squares = goertzel(&windowed, std::array::from_fn(angle));
            power.iter_mut().zip(squares).for_each(|(power, square)| *power += square);
        }
        segments += 1.0;
    }
    let largest = power.into_iter().fold(0.0, f64::max) / (segments * window_square);
    (largest / square).max(1.0)
}

/// Frequencies side by side.
const LANES: usize = 8;

/// Squared magnitudes of the Fourier sum at some angles per sample (rad), by Goertzel's recursion.
fn goertzel(x: &[f64], angles: [f64; LANES]) -> [f64; LANES] {
    let twice = angles.map(|angle| 2.0 * angle.cos());
    let (mut last, mut before) = ([0.0; LANES], [0.0; LANES]);
    for x in x {
        for lane in 0..LANES {
            (last[lane], before[lane]) = (x + twice[lane] * last[lane] - before[lane], last[lane]);
        }
    }
    std::array::from_fn(|l| last[l] * last[l] + before[l] * before[l] - twice[l] * last[l] * before[l])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form of the first-order autoregression: τ_int = (1 + a)/(1 − a).
    #[test]
    fn correlation_of_an_autoregression() {
        let mut gauss = crate::noise_level::gaussian(5);
        let mut x = vec![0.0];
        for k in 1..60_000 {
            let next = 0.9 * x[k - 1] + gauss();
            x.push(next);
        }
        let (time, peak) = (correlation_time(&x), spectral_peak(&x));
        assert!((time / 19.0 - 1.0).abs() < 0.15, "{time}");
        assert!((peak / 19.0 - 1.0).abs() < 0.35, "{peak}");
        let white: Vec<f64> = (0..60_000).map(|_| gauss()).collect();
        assert!(kappa(&white) < 1.6, "{}", kappa(&white));
        assert_eq!(kappa(&[]), 1.0);
    }
}
