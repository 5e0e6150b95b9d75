//! A log on a uniform grid, burst by burst, so that digital filters mean what they say.
//!
//! ```text
//! t'_k = t_first + k·T  inside a burst;   x'_k = interpolant of the burst at t'_k
//! ```
//!
//! Positions (`q`, `theta`): cubic Hermite pieces whose slope at a row is that of the parabola through the row and its
//! two neighbours. Velocity is continuous, constant acceleration is reproduced exactly, reversals keep their shape, and
//! a bad stamp disturbs four intervals and no more. Logs slower than 400 Hz: positions by the polynomial through six
//! rows and torques by the cubic pieces, because motion between rows then outweighs noise (at 100 Hz and 4 Hz of motion a
//! line misses 0.8 % of the torque). Everything else, measured with noise: linear, which never amplifies noise.
//! Why neither monotone PCHIP nor a C² spline: PCHIP flattens reversals, where friction shows, and is only second order
//! on irregular stamps; the spline rings about stamps that jitter. On the Panda log of gaz2019, every second row held
//! out, the position error of joint 1 is 0.188 mrad (linear), 0.192 (this), 0.193 (PCHIP), 0.199 (spline): there the
//! jitter of the stamps decides, and no interpolant repairs it.
//! Leaves out: extrapolation, and anti-alias filtering when T is longer than the period of the log.

use tribo_files::LogError;

use crate::bursts::{GAP_TOLERANCE, bursts, median_period_s};
use crate::log::RobotLog;
use crate::quantity::Quantity;

/// How to resample. Its default is the median period of the log and the contract's gap tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resampling {
    /// Period of the grid (s); `None` takes the median period of the log.
    pub period_s: Option<f64>,
    /// Longest step to interpolate across, in median periods of the log (see [`bursts`](crate::bursts)).
    pub gap_tolerance: f64,
    /// Fewest grid rows of a burst worth keeping, at least 2.
    pub min_rows: usize,
}

impl Default for Resampling {
    fn default() -> Self {
        Self { period_s: None, gap_tolerance: GAP_TOLERANCE, min_rows: 2 }
    }
}

/// The bursts of a log on uniform grids of one period, each starting at its own first stamp.
#[derive(Debug, Clone, PartialEq)]
pub struct Resampled {
    /// Period of the grids (s).
    pub period_s: f64,
    /// One log per burst kept.
    pub bursts: Vec<RobotLog>,
    /// Bursts left out because they had fewer than `min_rows` grid rows.
    pub skipped_bursts: usize,
}

/// Resamples a log.
///
/// # Errors
/// [`LogError::OutOfRange`] for a setting outside its range.
pub fn resample(log: &RobotLog, settings: &Resampling) -> Result<Resampled, LogError> {
    let period_s = settings.period_s.or_else(|| median_period_s(&log.time_s)).unwrap_or(0.0);
    in_range("period_s", period_s, period_s.is_finite() && period_s >= SHORTEST_PERIOD_S, "[1e-6, inf) s")?;
    let tolerance = settings.gap_tolerance;
    in_range("gap_tolerance", tolerance, tolerance >= 1.0, "[1, inf] median periods")?;
    in_range("min_rows", settings.min_rows as f64, settings.min_rows >= 2, "[2, inf) rows")?;

    let mut resampled = Resampled { period_s, bursts: Vec::new(), skipped_bursts: 0 };
    for burst in bursts(&log.time_s, tolerance) {
        let time_s = &log.time_s[burst.clone()];
        let grid_s = grid(time_s, period_s);
        if grid_s.len() < settings.min_rows {
            resampled.skipped_bursts += 1;
            continue;
        }
        let places = places(time_s, &grid_s);
        let columns = log.map(|quantity, column| {
            let column = &column[burst.clone()];
            match quantity {
                Quantity::Time => grid_s.clone(),
                Quantity::Position | Quantity::MotorPosition if period_s > FAST_PERIOD_S => {
                    six_point(time_s, column, &grid_s, &places)
                }
                Quantity::Position | Quantity::MotorPosition => cubic(time_s, column, &places),
                Quantity::Torque | Quantity::LinkTorque if period_s > FAST_PERIOD_S => cubic(time_s, column, &places),
                _ => linear(column, &places),
            }
        });
        resampled.bursts.push(columns.validate()?);
    }
    Ok(resampled)
}

/// Period up to which motion is so slow between two rows that noise and jitter decide, not the interpolant (s).
const FAST_PERIOD_S: f64 = 2.5e-3;

/// Shortest grid period: a hundred times faster than any joint controller, and it bounds the memory.
const SHORTEST_PERIOD_S: f64 = 1e-6;

/// Part of a period by which rounding may push the last grid stamp past the last stamp of the burst.
const ROUNDING: f64 = 1e-6;

/// Uniform stamps from the first to the last of `time_s`.
fn grid(time_s: &[f64], period_s: f64) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (time_s.first(), time_s.last()) else { return Vec::new() };
    let steps = ((last - first) / period_s + ROUNDING).floor() as usize;
    (0..=steps).map(|k| first + k as f64 * period_s).collect()
}

/// A point between rows `row` and `row + 1`: `fraction` of the way, in [0, 1].
struct Place {
    row: usize,
    fraction: f64,
}

/// Where each grid stamp lies among the stamps of the burst.
fn places(time_s: &[f64], grid_s: &[f64]) -> Vec<Place> {
    let last_row = time_s.len().saturating_sub(2);
    let mut row = 0;
    grid_s
        .iter()
        .map(|&t_s| {
            while row < last_row && time_s[row + 1] <= t_s {
                row += 1;
            }
            let fraction = (t_s - time_s[row]) / (time_s[row + 1] - time_s[row]);
            Place { row, fraction: fraction.clamp(0.0, 1.0) }
        })
        .collect()
}

fn linear(values: &[f64], places: &[Place]) -> Vec<f64> {
    places.iter().map(|&Place { row, fraction: s }| (1.0 - s) * values[row] + s * values[row + 1]).collect()
}

/// Cubic Hermite interpolation with the slopes of [`parabola_slopes`]. Equal rows give exactly that value between.
fn cubic(time_s: &[f64], values: &[f64], places: &[Place]) -> Vec<f64> {
    let slopes = parabola_slopes(time_s, values);
    let at = |&Place { row, fraction: s }: &Place| {
        let h = time_s[row + 1] - time_s[row];
        let (rise, rise0, rise1) = (values[row + 1] - values[row], h * slopes[row], h * slopes[row + 1]);
        values[row] + s * (rise0 + s * (3.0 * rise - 2.0 * rise0 - rise1 + s * (rise0 + rise1 - 2.0 * rise)))
    };
    places.iter().map(at).collect()
}

/// Slope at each row of the parabola through it and its neighbours; at the ends of the parabola next to them.
fn parabola_slopes(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let steps: Vec<f64> = time_s.windows(2).map(|t| t[1] - t[0]).collect();
    let secants: Vec<f64> = values.windows(2).zip(&steps).map(|(y, h)| (y[1] - y[0]) / h).collect();
    let (&[first, ..], &[.., last]) = (secants.as_slice(), secants.as_slice()) else { return vec![0.0; values.len()] };
    let mut slopes = vec![first];
    for (h, d) in steps.windows(2).zip(secants.windows(2)) {
        slopes.push((h[1] * d[0] + h[0] * d[1]) / (h[0] + h[1]));
    }
    slopes.push(last);
    // A parabola's secant is the mean of the slopes at its two rows.
    if let [_, second, .., before_last, _] = slopes[..] {
        slopes[0] = 2.0 * first - second;
        slopes[values.len() - 1] = 2.0 * last - before_last;
    } else if let [_, middle, _] = slopes[..] {
        slopes = vec![2.0 * first - middle, middle, 2.0 * last - middle];
    }
    slopes
}

/// Lagrange polynomial through the six nearest rows; near an end, or in a short burst, through fewer.
fn six_point(time_s: &[f64], values: &[f64], grid_s: &[f64], places: &[Place]) -> Vec<f64> {
    let n = values.len();
    let at = |(t, place): (&f64, &Place)| {
        let start = (place.row + 1).saturating_sub(3).min(n.saturating_sub(6));
        let end = (start + 6).min(n);
        (start..end)
            .map(|i| {
                let others = (start..end).filter(|k| *k != i);
                let weight: f64 = others.map(|k| (t - time_s[k]) / (time_s[i] - time_s[k])).product();
                weight * values[i]
            })
            .sum()
    };
    grid_s.iter().zip(places).map(at).collect()
}

fn in_range(field: &'static str, value: f64, inside: bool, allowed: &'static str) -> Result<(), LogError> {
    if inside { Ok(()) } else { Err(LogError::OutOfRange { field, value, allowed }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::LogColumns;

    /// A joint that swings as sin t, stamped with a period that varies by 30 %.
    fn swing(period_s: f64) -> RobotLog {
        let time_s: Vec<f64> = (0..400).map(|k| period_s * (f64::from(k) + 0.3 * f64::from(k * k % 7) / 7.0)).collect();
        LogColumns {
            q_rad: vec![time_s.iter().map(|t| t.sin()).collect()],
            dq_rad_s: vec![time_s.iter().map(|t| t.cos()).collect()],
            tau_j_nm: vec![time_s.iter().map(|t| 3.0 * t - 1.0).collect()],
            time_s,
            ..LogColumns::default()
        }
        .validate()
        .unwrap()
    }

    #[test]
    fn irregular_stamps_become_uniform_and_values_follow() {
        let log = swing(0.01);
        let resampled = resample(&log, &Resampling { gap_tolerance: 2.0, ..Resampling::default() }).unwrap();
        let burst = &resampled.bursts[0];
        let worst = |f: &dyn Fn(usize) -> f64| (0..burst.rows()).map(f).fold(0.0, f64::max);
        // Linear would leave h²/8 = 1.4e-5 for h = 10.5 ms; third order on irregular stamps leaves a tenth of h³.
        let error = worst(&|k| (burst.q_rad[0][k] - burst.time_s[k].sin()).abs());
        assert!(error < 2e-7, "{error}");
        assert!(worst(&|k| (burst.tau_j_nm[0][k] - (3.0 * burst.time_s[k] - 1.0)).abs()) < 1e-13);
        assert!(worst(&|k| (burst.time_s[k] - k as f64 * resampled.period_s).abs()) < 1e-12);
        assert!(log.duration_s() - burst.duration_s() < resampled.period_s);
    }

    /// Third order for the cubic pieces of a fast grid, sixth for the polynomials of a slow one.
    #[test]
    fn halving_the_period_divides_the_error_by_eight_or_by_sixty_four() {
        let error = |period_s: f64| {
            let log = swing(period_s);
            let settings = Resampling { period_s: Some(period_s / 3.0), gap_tolerance: 2.0, min_rows: 2 };
            let burst = resample(&log, &settings).unwrap().bursts.remove(0);
            let inner = (0..burst.rows()).filter(|&k| (0.1..1.0).contains(&burst.time_s[k]));
            inner.map(|k| (burst.q_rad[0][k] - burst.time_s[k].sin()).abs()).fold(0.0, f64::max)
        };
        let fast = error(0.006) / error(0.003);
        assert!((7.0..9.5).contains(&fast), "{fast}");
        let slow = error(0.02) / error(0.01);
        assert!((50.0..80.0).contains(&slow), "{slow}");
    }

    /// Both torques are measured alike, and `tau_J − tau_link` must not come from two interpolants.
    #[test]
    fn link_torque_is_resampled_as_torque() {
        for period_s in [0.001, 0.01] {
            let mut columns = swing(period_s).into_columns();
            columns.tau_j_nm = columns.q_rad.clone();
            columns.tau_link_nm = Some(columns.q_rad.clone());
            let settings = Resampling { period_s: Some(0.7 * period_s), gap_tolerance: 2.0, min_rows: 2 };
            let resampled = resample(&columns.validate().unwrap(), &settings).unwrap();
            let burst = &resampled.bursts[0];
            assert_eq!(burst.tau_link_nm.as_ref(), Some(&burst.tau_j_nm));
        }
    }

    #[test]
    fn constant_acceleration_is_exact_up_to_the_ends() {
        let time_s = [0.0, 1.0, 1.5, 3.0, 3.2];
        let fall = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t;
        for rows in 3..=5 {
            let (time_s, q): (Vec<f64>, Vec<f64>) = time_s[..rows].iter().map(|&t| (t, fall(t))).unzip();
            let fine = grid(&time_s, 0.01);
            for (t, v) in fine.iter().zip(cubic(&time_s, &q, &places(&time_s, &fine))) {
                assert!((v - fall(*t)).abs() < 1e-14, "{rows} rows, t = {t}");
            }
        }
        assert_eq!(cubic(&[0.0, 2.0], &[1.0, 3.0], &places(&[0.0, 2.0], &[0.5])), [1.5]);
    }

    #[test]
    fn own_stamps_give_own_values_and_rest_stays_rest() {
        let time_s: Vec<f64> = (0..6).map(f64::from).collect();
        let q = vec![0.1, 0.1, 0.1, 0.1, 1.0, 1.0];
        let at_rows = places(&time_s, &time_s);
        assert_eq!(cubic(&time_s, &q, &at_rows), q);
        assert_eq!(linear(&q, &at_rows), q);
        let rest = grid(&time_s[..3], 0.01);
        assert!(cubic(&time_s, &q, &places(&time_s, &rest)).iter().all(|&v| v == 0.1));
    }

    #[test]
    fn gaps_are_not_bridged_and_short_bursts_are_counted() {
        let mut columns = swing(0.01).into_columns();
        for k in 200..400 {
            columns.time_s[k] += if k < 201 { 0.2 } else { 1.0 };
        }
        let log = columns.validate().unwrap();
        let resampled = resample(&log, &Resampling { gap_tolerance: 2.0, ..Resampling::default() }).unwrap();
        assert_eq!((resampled.bursts.len(), resampled.skipped_bursts), (2, 1));
    }

    #[test]
    fn settings_outside_their_range_are_named() {
        let log = swing(0.01);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = resample(&log, &Resampling { period_s: Some(bad), ..Resampling::default() }).unwrap_err();
            assert_eq!(error.to_string(), format!("period_s: {bad} is outside [1e-6, inf) s"));
        }
    }
}
