//! How many samples of a correlated residual count as one.
//!
//! ```text
//! κ = max(τ_int, S_peak) R,   τ_int = 1 + 2 Σ ρ_k,   S_peak = max of the Welch spectrum over its mean
//! R = 1 + 2 ρ_T Σ_m (1 − m T/n),   T the lag, longer than the spectrum's segments, after which the residual comes again
//! ```
//!
//! What is left of a real log is error of the model, correlated over 3 to 100 samples. A likelihood that counts every sample
//! is sure of anything; one whitened by an autoregression weighs the high frequencies, where that error is not. So each
//! sample counts 1/κ.

use tribo_regression::least_squares::inner;

/// Lags that are summed, over τ_int itself (Sokal's window).
const WINDOW: f64 = 4.0;
/// Samples of a segment of the spectrum.
const SEGMENT: [usize; 2] = [32, 512];
/// Segments wanted.
const SEGMENTS: usize = 8;

/// Correlation with itself a cycle later from which on a residual comes again.
const AGAIN: f64 = 0.5;
/// The same over its standard deviation in noise.
const AGAIN_SD: f64 = 5.0;
/// Part of the largest correlation from which on an earlier one is of the same cycle.
const AS_MUCH: f64 = 0.95;
/// Most means of which it is asked.
const MOST_MEANS: usize = 4000;
/// Cycles that a log must hold for one of them to be seen again.
const LEAST_CYCLES: f64 = 1.5;

/// κ of a residual, at least 1.
pub fn kappa(residual: &[f64]) -> f64 {
    let time = correlation_time(residual);
    time.max(spectral_peak(residual)) * repetition(residual, time)
}

/// Samples of a segment of the spectrum of so many.
fn segment(samples: usize) -> usize {
    (samples / SEGMENTS).clamp(SEGMENT[0], SEGMENT[1])
}

/// How often a residual of correlation time `time` (samples) says the same again, cycle after cycle; 1 of one that never does. A robot that
/// repeats its path repeats the error of its model. Shorter cycles than the segments of `spectral_peak` are seen there.
pub fn repetition(x: &[f64], time: f64) -> f64 {
    // Means over half a correlation time hold all that comes again.
    let block = ((0.5 * time).round() as usize).max(x.len().div_ceil(MOST_MEANS)).max(1);
    let means: Vec<f64> = x.chunks_exact(block).map(|chunk| chunk.iter().sum::<f64>() / block as f64).collect();
    let n = means.len();
    let first = (((WINDOW * time).max(segment(x.len()) as f64) / block as f64).ceil() as usize).max(2);
    let last = (n as f64 / LEAST_CYCLES) as usize;
    let mut energy = vec![0.0];
    means.iter().for_each(|mean| energy.push(energy[energy.len() - 1] + mean * mean));
    let correlation = |lag: usize| {
        let both = energy[n - lag] * (energy[n] - energy[lag]);
        inner(&means[..n - lag], &means[lag..]) / both.sqrt().max(f64::MIN_POSITIVE)
    };
    let surely = |(lag, correlation): &(usize, f64)| *correlation > AGAIN.max(AGAIN_SD / ((n - lag) as f64).sqrt());
    let all: Vec<(usize, f64)> = (first..last).map(|lag| (lag, correlation(lag))).collect();
    let Some(most) = all.iter().max_by(|a, b| a.1.total_cmp(&b.1)).filter(|best| surely(best)) else { return 1.0 };
    // Two cycles later it comes again as well: the first of the peaks counts.
    let is_peak = |(_, correlation): &&(usize, f64)| *correlation > AS_MUCH * most.1;
    let (lag, correlation) = all.iter().find(is_peak).copied().unwrap_or(*most);
    let shares = (1..).map(|cycle| 1.0 - (cycle * lag) as f64 / n as f64).take_while(|share| *share > 0.0);
    1.0 + 2.0 * correlation * shares.sum::<f64>()
}

/// τ_int (samples), at least 1.
pub fn correlation_time(x: &[f64]) -> f64 {
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
    let m = segment(n);
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
        let mut gauss = crate::gaussian::gaussian(5);
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

    /// Four times the same error under noise counts four times less, as far as it is error; what never comes again counts as before.
    #[test]
    fn a_cycle_that_comes_again_says_nothing_new() {
        let mut gauss = crate::gaussian::gaussian(6);
        let mut error = vec![0.0];
        for k in 1..500 {
            error.push(0.9 * error[k - 1] + gauss());
        }
        let share = 0.9_f64;
        let size = tribo_regression::rms(&error) * (1.0 / share - 1.0).sqrt();
        let again: Vec<f64> = (0..2000).map(|k| error[k % 500] + size * gauss()).collect();
        let factor = repetition(&again, correlation_time(&again));
        assert!((factor / (1.0 + 3.0 * share) - 1.0).abs() < 0.15, "{factor}");
        let mut once = vec![0.0];
        for k in 1..2000 {
            once.push(0.9 * once[k - 1] + gauss());
        }
        assert_eq!(repetition(&once, correlation_time(&once)), 1.0);
        assert_eq!(repetition(&[], 1.0), 1.0);
    }
}
