//! Noise in which the motion, or the torque that moves it, is lost.
//!
//! ```text
//! σ = median |Δ⁴x| / (0.6745 √70),     what is left of it in a tenth of a second:  q: σ √(12/n),   τ: σ/√n,   n rows
//! ```
//!
//! Δ⁴ takes out what is smooth (all up to a cubic), its coefficients' squares sum to 70; the median leaves out reversals and single jumps.
//! q: the rise of a line through n rows, against the rise of q; τ: a mean of n rows, against the spread of such means.
//! Leaves out: rows that are sent twice hide their noise.

use super::remark::joints_named;
use super::{Fault, Remark};
use crate::LogColumns;
use crate::bursts::median_period_s;

/// What is judged lasts as long as a reversal of friction, about (s).
const WINDOW_S: f64 = 0.1;
/// Fewest rows of a window, fewest windows.
const LEAST_ROWS: usize = 2;
const LEAST_WINDOWS: usize = 30;
/// RMS speed (rad/s) above which a joint moves, and which every encoder has to tell from rest.
const MOVING_RAD_S: f64 = 0.01;
/// Share of the signal above which it is lost.
const LOST: f64 = 0.5;
/// Noise (rad) of a position that no encoder of an arm has.
const NO_ENCODER_RAD: f64 = 0.01;
/// Noise of a torque that does no harm, over the RMS torque of the joint that carries most: about vertical axes there is little to see.
const HARMLESS: f64 = 0.01;

/// Noise and signal of one column over a tenth of a second, in its unit.
#[derive(Clone, Copy, Debug)]
struct Level {
    noise: f64,
    /// Noise of a row.
    row: f64,
    signal: f64,
}

impl Level {
    fn share(self) -> f64 {
        self.noise / self.signal
    }
}

/// Positions in which the motion is lost, refused where no encoder is so bad, and moving joints whose torques are noise for the most part.
pub(super) fn drowned(log: &LogColumns, known: &[usize]) -> Vec<Remark> {
    let Some(period_s) = median_period_s(&log.time_s).filter(|period| *period > 0.0) else { return Vec::new() };
    let rows = ((WINDOW_S / period_s).round() as usize).clamp(LEAST_ROWS, 10_000);
    if log.rows() < rows * LEAST_WINDOWS {
        return Vec::new();
    }
    let joints = (0..log.joints()).filter(|joint| !known.contains(joint));
    let positions: Vec<(usize, Level)> = joints.filter_map(|j| Some((j, of_position(&log.q_rad[j], rows)?))).collect();
    let slow = MOVING_RAD_S * period_s * rows as f64;
    let moving = positions.iter().filter(|(_, level)| level.signal > slow);
    let largest_nm = log.tau_j_nm.iter().map(|tau| rms(tau)).fold(0.0, f64::max);
    let torques: Vec<(usize, Level)> = moving
        .filter_map(|&(j, _)| Some((j, of_torque(&log.tau_j_nm[j], rows)?)))
        .filter(|(_, level)| level.row > HARMLESS * largest_nm)
        .collect();
    let least = |(j, level): (usize, Level)| (j, Level { signal: level.signal.max(slow), ..level });
    let positions: Vec<(usize, Level)> = positions.into_iter().map(least).collect();
    let remedy = |what: &str| {
        format!(
            "what is computed from it is uncertain or wrong: move faster or farther, or log the {what} with less noise"
        )
    };
    let of_positions = lost(&positions).map(|(joints, worst)| {
        let evidence = format!(
            "the position of {} jitters from row to row, by up to {:.1e} rad rms: slow motion is lost in it",
            joints_named(&joints),
            worst.row
        );
        let make = if worst.row > NO_ENCODER_RAD { Remark::refuse } else { Remark::warn };
        make(Fault::Noise, joints, evidence, remedy("position"))
    });
    let of_torques = lost(&torques).map(|(joints, worst)| {
        let evidence = format!(
            "the torque of {} is mostly noise: up to {:.2} Nm rms from row to row, of {:.2} Nm by which it changes with the motion",
            joints_named(&joints),
            worst.row,
            worst.signal
        );
        Remark::warn(Fault::Noise, joints, evidence, remedy("torque"))
    });
    of_positions.into_iter().chain(of_torques).collect()
}

/// The joints of which the signal is lost, and the worst of them.
fn lost(levels: &[(usize, Level)]) -> Option<(Vec<usize>, Level)> {
    let lost = || levels.iter().filter(|(_, level)| level.share() > LOST);
    let (_, worst) = lost().max_by(|a, b| a.1.share().total_cmp(&b.1.share()))?;
    Some((lost().map(|(joint, _)| *joint).collect(), *worst))
}

/// The rise of q from the mean of a window to that of the next; its square is noise in part, which is taken out.
fn of_position(q: &[f64], rows: usize) -> Option<Level> {
    let row = row_noise(q)?;
    let rises: Vec<f64> = means(q, rows).windows(2).map(|pair| pair[1] - pair[0]).collect();
    let signal = (rms(&rises).powi(2) - 2.0 * row * row / rows as f64).max(0.0).sqrt();
    finite(Level { noise: row * (12.0 / rows as f64).sqrt(), row, signal })
}

/// The spread of the means of windows, likewise.
fn of_torque(tau: &[f64], rows: usize) -> Option<Level> {
    let row = row_noise(tau)?;
    let means = means(tau, rows);
    let mean = means.iter().sum::<f64>() / means.len().max(1) as f64;
    let deviations: Vec<f64> = means.iter().map(|x| x - mean).collect();
    let noise = row / (rows as f64).sqrt();
    finite(Level { noise, row, signal: (rms(&deviations).powi(2) - noise * noise).max(0.0).sqrt() })
}

fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

fn means(x: &[f64], rows: usize) -> Vec<f64> {
    x.chunks_exact(rows).map(|window| window.iter().sum::<f64>() / rows as f64).collect()
}

fn finite(level: Level) -> Option<Level> {
    (level.noise.is_finite() && level.signal.is_finite() && level.noise > 0.0).then_some(level)
}

/// Standard deviation of the noise of a row.
fn row_noise(x: &[f64]) -> Option<f64> {
    let mut fourth: Vec<f64> =
        x.windows(5).map(|w| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).abs()).collect();
    let middle = fourth.len() / 2;
    (!fourth.is_empty()).then(|| *fourth.select_nth_unstable_by(middle, f64::total_cmp).1 / (0.6745 * 70f64.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twenty seconds of two joints that swing by 0.2 rad and 10 Nm, the second noisy, and of one that stands.
    fn log(rate_hz: f64, encoders_rad: [f64; 2], torque_nm: f64) -> LogColumns {
        // Xorshift: sums of twelve numbers of ±0.5 are normal, almost.
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut uniform = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut white = move |scale: f64| scale * (0..12).map(|_| uniform()).sum::<f64>();
        let time_s: Vec<f64> = (0..(20.0 * rate_hz) as usize).map(|k| k as f64 / rate_hz).collect();
        let mut swing = |amplitude: f64, noise: f64| -> Vec<f64> {
            time_s.iter().map(|t| amplitude * (2.0 * t).sin() + white(noise)).collect()
        };
        let q_rad = vec![swing(0.2, 2e-5), swing(0.2, encoders_rad[0]), swing(0.0, encoders_rad[1])];
        let tau_j_nm = vec![swing(10.0, 0.05), swing(10.0, torque_nm), swing(0.0, torque_nm)];
        let dq_rad_s = vec![swing(0.4, 1e-3), swing(0.4, 1e-3), swing(0.0, 1e-3)];
        LogColumns { time_s, q_rad, dq_rad_s, tau_j_nm, ..LogColumns::default() }
    }

    #[test]
    fn motion_and_torque_that_are_lost_in_noise_are_named_and_a_standing_joint_is_not() {
        let refused = |remark: &Remark| remark.refuses(crate::recognise::Use::Diagnosis);
        for rate_hz in [30.0, 125.0, 1000.0] {
            assert_eq!(drowned(&log(rate_hz, [2e-5; 2], 0.3), &[]), [], "{rate_hz} Hz");
            let coarse = drowned(&log(rate_hz, [0.05, 2e-5], 0.3), &[]);
            assert_eq!(coarse.len(), 1, "{rate_hz} Hz: {coarse:?}");
            assert_eq!(coarse[0].joints, [1]);
            assert!(coarse[0].evidence.starts_with("the position of joint 1 jitters"), "{}", coarse[0]);
            assert!(refused(&coarse[0]));
            // A joint that stands, by an encoder that could not tell slow motion from it.
            let fine = drowned(&log(rate_hz, [2e-5, 2e-3], 0.3), &[]);
            assert!(
                matches!(&fine[..], [remark] if remark.joints == [2] && !refused(remark)),
                "{rate_hz} Hz: {fine:?}"
            );
            assert_eq!(
                drowned(&log(rate_hz, [0.05, 2e-5], 0.3), &[1]),
                [],
                "a joint that is known to be broken is not named twice"
            );
            let loud = drowned(&log(rate_hz, [2e-5; 2], 60.0), &[]);
            assert_eq!(loud.len(), 1, "{rate_hz} Hz: {loud:?}");
            assert_eq!(loud[0].joints, [1]);
            assert!(loud[0].evidence.starts_with("the torque of joint 1 is mostly noise"), "{}", loud[0]);
        }
    }
}
