//! White noise of a signal, from the signal itself.

use crate::least_squares::fit_rows;

/// Median of |x| over the standard deviation of a Gaussian.
const MEDIAN_OVER_SD: f64 = 0.674_489_750_196_081_7;
/// Steps that must be whole multiples of the smallest one for a signal to count as quantised.
const QUANTISED_SHARE: f64 = 0.98;

/// Standard deviation of the white noise on a smooth signal with stamps `time_s`.
///
/// ```text
/// e_k = x_k − cubic through (x_{k−2}, x_{k−1}, x_{k+1}, x_{k+2}) at t_k,   sd = median |e_k| / √(1 + Σ w²) / 0.6745
/// ```
///
/// The cubic leaves nothing of a motion that is slow against the sample rate (on regular stamps e is a fourth
/// difference); the median ignores reversals and impacts. Stamps that jitter show as noise, as they do in every
/// derivative. Repeated values are skipped: they are rows sent twice. At least resolution/√12 on a lattice.
pub fn white_noise_sd(time_s: &[f64], x: &[f64]) -> f64 {
    let mut fresh: Vec<(f64, f64)> = Vec::with_capacity(x.len());
    for (&t, &value) in time_s.iter().zip(x) {
        if fresh.last().is_none_or(|last| last.1 != value) {
            fresh.push((t, value));
        }
    }
    let mut errors: Vec<f64> = fresh
        .windows(5)
        .map(|w| {
            let (error, square) = interpolation_error([w[0], w[1], w[2], w[3], w[4]]);
            error.abs() / square.sqrt()
        })
        .collect();
    let from_errors = median(&mut errors).unwrap_or(0.0) / MEDIAN_OVER_SD;
    from_errors.max(resolution(x) / 12f64.sqrt())
}

/// Middle sample less the cubic through the four others, and the sum of the squared weights of all five.
fn interpolation_error(samples: [(f64, f64); 5]) -> (f64, f64) {
    let (at, value) = samples[2];
    let others = [samples[0], samples[1], samples[3], samples[4]];
    let (mut error, mut square) = (value, 1.0);
    for (i, (t, value)) in others.iter().enumerate() {
        let weight: f64 = others
            .iter()
            .enumerate()
            .filter(|(k, _)| *k != i)
            .map(|(_, (other, _))| (at - other) / (t - other))
            .product();
        error -= weight * value;
        square += weight * weight;
    }
    (error, square)
}

/// Periods after which a command may stand in the measured torque.
const COMMAND_LAGS: usize = 3;
/// Variance of the torque's noise that the command must explain for it to count as feedback.
const FEEDBACK_SHARE: f64 = 0.3;
/// Rows that are looked at.
const FEEDBACK_ROWS: usize = 6000;
/// Rows per coefficient.
const FEEDBACK_ROWS_PER_LAG: usize = 20;

/// Share of the amplitude of a torque's white noise that is its sensor's own, in (0, 1].
///
/// A stiff controller turns encoder noise into torque: torque that truly acts, and no reason to look at higher
/// frequencies. The errors of [`white_noise_sd`] of the measured torque are regressed on those of the commanded one:
///
/// ```text
/// e_tau(k) = Σ_{l=0..L} g_l e_command(k − l) + v(k),   share = sd(v) / sd(e_tau)
/// ```
pub(crate) fn sensor_share(time_s: &[f64], torque_nm: &[f64], command_nm: &[f64]) -> f64 {
    let rows: Vec<usize> =
        (0..time_s.len()).filter(|k| *k == 0 || torque_nm[*k] != torque_nm[*k - 1]).take(FEEDBACK_ROWS).collect();
    if rows.len() < FEEDBACK_ROWS_PER_LAG * (COMMAND_LAGS + 1) {
        return 1.0;
    }
    // Impacts and reversals are no noise.
    let errors = |x: &[f64]| -> Vec<f64> {
        let at = |row: usize| (time_s[row], x[row]);
        let mut errors: Vec<f64> = rows
            .windows(5)
            .map(|w| interpolation_error([at(w[0]), at(w[1]), at(w[2]), at(w[3]), at(w[4])]).0)
            .collect();
        let limit = FARTHEST_SD * robust_sd(errors.iter().copied());
        errors.iter_mut().for_each(|error| *error = error.clamp(-limit, limit));
        errors
    };
    let (torque, command) = (errors(torque_nm), errors(command_nm));
    let target = &torque[COMMAND_LAGS..];
    let columns: Vec<&[f64]> =
        (0..=COMMAND_LAGS).map(|lag| &command[COMMAND_LAGS - lag..command.len() - lag]).collect();
    let total: f64 = target.iter().map(|x| x * x).sum();
    let explained = fit_rows(&columns, target, 1e-8).explained / total.max(f64::MIN_POSITIVE);
    if explained > FEEDBACK_SHARE { (1.0 - explained).max(0.0).sqrt() } else { 1.0 }
}

/// Errors farther out than this many standard deviations are cut off.
const FARTHEST_SD: f64 = 4.0;

/// Spacing of the lattice on which the values lie, or 0.
pub fn resolution(x: &[f64]) -> f64 {
    let steps: Vec<f64> = x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0).collect();
    let Some(smallest) = steps.iter().copied().min_by(f64::total_cmp) else { return 0.0 };
    let whole = steps.iter().filter(|step| ((*step / smallest) - (*step / smallest).round()).abs() < 1e-3).count();
    if whole as f64 >= QUANTISED_SHARE * steps.len() as f64 { smallest } else { 0.0 }
}

/// Median of the values, which are reordered; `None` for none.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Root mean square; 0 for no values.
pub fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

/// Robust standard deviation about zero: median |x| / 0.6745.
pub fn robust_sd(x: impl Iterator<Item = f64>) -> f64 {
    median(&mut x.map(f64::abs).collect::<Vec<f64>>()).unwrap_or(0.0) / MEDIAN_OVER_SD
}

/// Numbers of mean 0 and standard deviation 1, each the sum of twelve uniform ones less 6.
#[cfg(test)]
pub(crate) fn gaussian(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_feedback_from_the_sensors_own_noise() {
        let mut gauss = gaussian(3);
        let time: Vec<f64> = (0..4000).map(|k| f64::from(k) * 1e-3).collect();
        let command: Vec<f64> = time.iter().map(|t| t.sin() + 0.07 * gauss()).collect();
        let own: Vec<f64> = time.iter().map(|_| 0.02 * gauss()).collect();
        let measured: Vec<f64> =
            (0..command.len()).map(|k| own[k] + if k < 1 { 0.0 } else { command[k - 1] }).collect();
        let share = sensor_share(&time, &measured, &command);
        assert!((share - 0.02 / 0.02f64.hypot(0.07)).abs() < 0.04, "{share}");
        assert_eq!(sensor_share(&time, &own, &command), 1.0);
    }

    #[test]
    fn finds_the_noise_under_a_motion_and_the_lattice() {
        let mut gauss = gaussian(1);
        let x: Vec<f64> = (0..20_000).map(|k| (f64::from(k) * 0.003).sin() + 0.01 * gauss()).collect();
        let time: Vec<f64> = (0..20_000).map(|k| f64::from(k) * 1e-3).collect();
        let sd = white_noise_sd(&time, &x);
        assert!((sd / 0.01 - 1.0).abs() < 0.03, "{sd}");
        assert_eq!(resolution(&x), 0.0);
        let coarse: Vec<f64> = (0..20_000).map(|k| ((f64::from(k) * 1e-3).sin() * 1e3).round() * 1e-3).collect();
        assert!((resolution(&coarse) - 1e-3).abs() < 1e-9);
        assert!(white_noise_sd(&time, &coarse) >= 1e-3 / 12f64.sqrt() * 0.999);
        assert_eq!(white_noise_sd(&[], &[]), 0.0);
    }
}
