//! The friction band from a log of contact-free strokes.

use nalgebra::{SVector, Vector2, Vector3};
use thiserror::Error;
use tribo_friction::{BandError, FrictionBand, JointBand};
use tribo_logs::{RobotLog, bursts};
use tribo_robot::{Arm, ControlTerms, LAMBDA_95, SensorFrame};

use super::likelihood::{JointRows, log_likelihood};
use super::nelder_mead::minimise;
use crate::MomentumObserver;

/// Classes of speed, of equally many rows each, in which a band must cover.
pub const SPEED_CLASSES: usize = 5;
/// Fewest rows, one memory of the observer apart, that make a band.
const FEWEST_ROWS: usize = 300;
/// Start of a burst that is left out, in units of 1/K: the observer forgets its start.
const SETTLE: f64 = 6.0;
/// Gaps up to this many periods are bridged: a logger on a busy computer skips a few rows at a time.
const LONGEST_GAP_PERIODS: f64 = 10.0;

/// The band of one joint and its evidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointBandFit {
    /// The band, its noise widened by `widened`.
    pub band: JointBand,
    /// Rows behind it, one memory of the observer apart.
    pub rows: usize,
    /// Mean log-likelihood of a row (ln 1/Nm), before widening.
    pub mean_log_likelihood: f64,
    /// Factor on σ that made every class of speed cover 95 %; 1 where the likelihood alone did.
    pub widened: f64,
}

/// Why a log gives no band.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum BandFitError {
    /// The log is of another arm.
    #[error("the log has {got} joints, the arm {need}")]
    JointCount {
        /// Joints of the log.
        got: usize,
        /// Joints of the arm.
        need: usize,
    },
    /// Too short, or in too many pieces.
    #[error("the log has {got} independent samples, a band needs {need}")]
    TooShort {
        /// Rows that count.
        got: usize,
        /// Fewest.
        need: usize,
    },
    /// A joint was not moved both ways.
    #[error("joint {joint} does not slide in both directions")]
    OneDirection {
        /// The joint, from 0.
        joint: usize,
    },
    /// The fit left the range of a band.
    #[error(transparent)]
    Band(#[from] BandError),
}

/// Cmin, Cmax, c, A, B, σ and k of each joint by maximum likelihood, from a log of strokes back and forth in free space.
///
/// The residual of a [`MomentumObserver`] of gain K is what [`crate::QpEstimator`] of the same gain will be given, and
/// the bounds pass the same low-pass here as there; K belongs to the band. Criterion: the likelihood of uniform friction
/// in the band plus normal noise, 1 % of the rows excepted, over rows 1/K apart (so nearly independent). It makes the
/// band as narrow as the rows allow, which the paper did by hand. Then σ is widened until, in each of five classes
/// of speed with equally many rows, 95 % of them lie within 1.96 σ of the band: the noise of a log need not be normal.
///
/// `arm` is on the side of the gears on which the log measured torque. The log must hold slow and fast strokes of every
/// joint; what it does not show (the speed beyond its fastest) is extrapolated. A is only found where B is not far below
/// the steps of the velocity: it is kept within A B = 1…40.
///
/// # Errors
/// [`BandFitError`], whichever is met first.
pub fn identify_band<const N: usize>(
    log: &RobotLog,
    arm: &Arm<N>,
    gain_rad_s: f64,
) -> Result<[JointBandFit; N], BandFitError> {
    let rows = joint_rows(log, arm, gain_rad_s)?;
    let got = rows.first().map_or(0, JointRows::count);
    if got < FEWEST_ROWS {
        return Err(BandFitError::TooShort { got, need: FEWEST_ROWS });
    }
    let unfitted = JointBandFit { band: JointBand::frictionless(1.0), rows: 0, mean_log_likelihood: 0.0, widened: 1.0 };
    let mut fits = [unfitted; N];
    for (joint, (fit, rows)) in fits.iter_mut().zip(&rows).enumerate() {
        *fit = fit_joint(rows).ok_or(BandFitError::OneDirection { joint })?;
        fit.band.validate(joint)?;
    }
    Ok(fits)
}

/// Share of the rows of a log within 1.96 σ of the band, per joint and class of speed, slowest first.
///
/// # Errors
/// [`BandFitError`], whichever is met first.
pub fn band_coverage<const N: usize>(
    band: &FrictionBand<N>,
    log: &RobotLog,
    arm: &Arm<N>,
    gain_rad_s: f64,
) -> Result<[[f64; SPEED_CLASSES]; N], BandFitError> {
    let rows = joint_rows(log, arm, gain_rad_s)?;
    Ok(std::array::from_fn(|j| {
        classes(&rows[j], &band.joints()[j]).map(|excess| {
            let inside = excess.iter().filter(|&&z| z <= LAMBDA_95).count();
            inside as f64 / excess.len().max(1) as f64
        })
    }))
}

/// The observer's residual along the log, joint by joint.
fn joint_rows<const N: usize>(log: &RobotLog, arm: &Arm<N>, gain_rad_s: f64) -> Result<[JointRows; N], BandFitError> {
    if log.joints() != N {
        return Err(BandFitError::JointCount { got: log.joints(), need: N });
    }
    let mut rows: [JointRows; N] = std::array::from_fn(|_| JointRows::default());
    let mut observer = MomentumObserver::<N>::new(gain_rad_s);
    let at = |columns: &[Vec<f64>], k: usize| SVector::<f64, N>::from_fn(|j, _| columns[j][k]);
    for burst in bursts(&log.time_s, LONGEST_GAP_PERIODS) {
        let first = burst.start;
        let mut next_s = log.time_s[first] + SETTLE / gain_rad_s;
        for k in burst {
            let time_s = log.time_s[k];
            let (q, qd, tau) = (at(&log.q_rad, k), at(&log.dq_rad_s, k), at(&log.tau_j_nm, k));
            let (frame, terms) = (SensorFrame { time_s, q, qd, tau, theta: None }, ControlTerms::at(arm, &q, &qd));
            let share = if k == first {
                observer.start(&frame, &terms);
                1.0
            } else {
                let dt_s = time_s - log.time_s[k - 1];
                observer.step(&frame, &terms, &((tau + at(&log.tau_j_nm, k - 1)) * 0.5), dt_s);
                observer.share(dt_s)
            };
            let counts = time_s >= next_s;
            if counts {
                next_s = time_s + 1.0 / gain_rad_s;
            }
            for j in 0..N {
                rows[j].qd.push(qd[j]);
                rows[j].residual.push(observer.residual_nm()[j]);
                rows[j].share.push(share);
                rows[j].counts.push(counts);
            }
        }
    }
    Ok(rows)
}

/// Most likely band, then widened; `None` if the joint does not slide both ways.
fn fit_joint(rows: &JointRows) -> Option<JointBandFit> {
    let start = sliding_friction(rows)?;
    let used = |k: &usize| rows.counts[*k];
    let counted = || (0..rows.qd.len()).filter(used).map(|k| rows.residual[k]);
    let range_nm = counted().fold(f64::NEG_INFINITY, f64::max) - counted().fold(f64::INFINITY, f64::min);
    let mut cost = |x: &[f64; 7]| -log_likelihood(rows, &band_of(x), range_nm);

    // The likelihood has ridges in A and B: a coarse grid first.
    let mut best = (f64::INFINITY, [0.0; 7]);
    for doubt in [3e-4_f64, 1e-3, 3e-3, 1e-2, 3e-2, 0.1] {
        for product in [3.0_f64, 12.0] {
            let x = [start.middle, start.half.ln(), start.viscous, product.ln(), doubt.ln(), start.sd.ln(), 0.1];
            let value = cost(&x);
            if value < best.0 {
                best = (value, x);
            }
        }
    }
    let mut point = best.1;
    let step = [0.1 * start.half, 0.1, 0.1 * start.viscous.abs() + 0.02, 0.5, 0.5, 0.2, 0.3];
    let mut value = best.0;
    // A simplex may collapse on a ridge: begun anew, it goes on.
    for _ in 0..3 {
        (point, value) = minimise(&mut cost, point, step, 1e-3, 600);
    }

    let mut band = band_of(&point);
    let widened = classes(rows, &band).iter().map(|excess| quantile95(excess) / LAMBDA_95).fold(1.0, f64::max);
    band.noise_sd_nm *= widened;
    let count = rows.count();
    Some(JointBandFit { band, rows: count, mean_log_likelihood: -value / count as f64, widened })
}

/// `[middle, ln half, c, ln A B, ln B, ln σ, k]`, signs of c and k dropped.
fn band_of(x: &[f64; 7]) -> JointBand {
    let (half, doubt) = (x[1].exp(), x[4].exp());
    JointBand {
        coulomb_min_nm: x[0] - half,
        coulomb_max_nm: x[0] + half,
        viscous_nm_s_per_rad: x[2].abs(),
        steepness_s_per_rad: x[3].exp().clamp(1.0, 40.0) / doubt,
        doubt_rad_s: doubt,
        noise_sd_nm: x[5].exp(),
        noise_growth_s_per_rad: x[6].abs(),
    }
}

struct Sliding {
    middle: f64,
    half: f64,
    viscous: f64,
    sd: f64,
}

/// `y = middle + half sign(v) + c v` by least squares on the faster half of the rows that count.
fn sliding_friction(rows: &JointRows) -> Option<Sliding> {
    let mut counted: Vec<usize> = (0..rows.qd.len()).filter(|&k| rows.counts[k]).collect();
    counted.sort_by(|&a, &b| rows.qd[a].abs().total_cmp(&rows.qd[b].abs()));
    let fast = &counted[counted.len() / 2..];
    let ways = Vector2::new(1.0, -1.0).map(|way| fast.iter().filter(|&&k| rows.qd[k] * way > 0.0).count());
    if ways.min() * 10 < fast.len() {
        return None;
    }
    let column = |k: usize| Vector3::new(1.0, rows.qd[k].signum(), rows.qd[k]);
    let (mut gram, mut moment) = (nalgebra::Matrix3::zeros(), Vector3::zeros());
    for &k in fast {
        gram += column(k) * column(k).transpose();
        moment += column(k) * rows.residual[k];
    }
    let x = gram.cholesky()?.solve(&moment);
    let square: f64 = fast.iter().map(|&k| (rows.residual[k] - column(k).dot(&x)).powi(2)).sum();
    let sd = (square / fast.len() as f64).sqrt().max(1e-6);
    Some(Sliding { middle: x[0], half: x[1].max(sd), viscous: x[2].max(0.0), sd })
}

/// Distance of each row that counts from the band, in σ, by class of speed; negative inside.
fn classes(rows: &JointRows, band: &JointBand) -> [Vec<f64>; SPEED_CLASSES] {
    let mut all = Vec::with_capacity(rows.count());
    rows.bounded(band, &mut |k, lower, upper| {
        let (y, v) = (rows.residual[k], rows.qd[k]);
        all.push((v.abs(), (lower - y).max(y - upper) / band.noise_sd_nm(v)));
    });
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let edge = |class: usize| class * all.len() / SPEED_CLASSES;
    std::array::from_fn(|class| all[edge(class)..edge(class + 1)].iter().map(|row| row.1).collect())
}

fn quantile95(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get((0.95 * sorted.len() as f64) as usize).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64;

    /// Rows drawn from the model itself, without a low-pass.
    fn drawn(band: &JointBand, count: usize, seed: u64) -> JointRows {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut rows = JointRows::default();
        for k in 0..count {
            let amplitude = if k % 2 == 0 { 0.6 } else { 0.03 };
            let v = amplitude * (0.37 * k as f64).sin();
            let [lower, upper] = band.limits_nm(v);
            let friction = lower + (upper - lower) * rng.random_range(0.0..1.0);
            rows.qd.push(v);
            rows.residual.push(friction + band.noise_sd_nm(v) * rng.sample::<f64, _>(StandardNormal));
            rows.share.push(1.0);
            rows.counts.push(true);
        }
        rows
    }

    fn truth() -> JointBand {
        JointBand {
            coulomb_min_nm: -0.7,
            coulomb_max_nm: 0.9,
            viscous_nm_s_per_rad: 0.8,
            steepness_s_per_rad: 600.0,
            doubt_rad_s: 0.01,
            noise_sd_nm: 0.05,
            noise_growth_s_per_rad: 3.0,
        }
    }

    /// Parameters come back, without a bias beyond half of what a single log is allowed.
    #[test]
    fn a_band_that_made_the_rows_is_found_again() {
        let pick = |b: &JointBand| {
            [
                b.coulomb_min_nm,
                b.coulomb_max_nm,
                b.viscous_nm_s_per_rad,
                b.doubt_rad_s.ln(),
                b.steepness_s_per_rad.ln(),
                b.noise_sd_nm.ln(),
                b.noise_growth_s_per_rad,
            ]
        };
        // Absolute for the torques and k, relative for B, A, σ.
        let allowed = [0.02, 0.02, 0.03, 0.10, 0.5, 0.10, 0.6];
        let expected = pick(&truth());
        let seeds = 6;
        let mut mean = [0.0; 7];
        for seed in 0..seeds {
            let fit = fit_joint(&drawn(&truth(), 4000, seed)).unwrap();
            let unwidened = JointBand { noise_sd_nm: fit.band.noise_sd_nm / fit.widened, ..fit.band };
            let got = pick(&unwidened);
            println!("{got:.3?} of {expected:.3?}, widened {:.3}", fit.widened);
            for i in 0..7 {
                mean[i] += got[i] / seeds as f64;
                assert!((got[i] - expected[i]).abs() < allowed[i], "seed {seed}, {i}: {} {}", got[i], expected[i]);
            }
            assert!(fit.widened < 1.12, "{}", fit.widened);
        }
        for i in 0..7 {
            assert!((mean[i] - expected[i]).abs() < 0.5 * allowed[i], "{i}: {} {}", mean[i], expected[i]);
        }
    }

    /// One row in two hundred far off does not open the band.
    #[test]
    fn outliers_do_not_open_the_band() {
        let mut rows = drawn(&truth(), 4000, 9);
        for k in (0..4000).step_by(200) {
            rows.residual[k] += 3.0;
        }
        let band = fit_joint(&rows).unwrap().band;
        assert!((band.doubt_rad_s / 0.01).ln().abs() < 0.2, "{band:?}");
        assert!((band.coulomb_max_nm - 0.9).abs() < 0.03, "{band:?}");
        assert!(band.noise_sd_nm < 1.3 * 0.05, "{band:?}");
    }

    /// Sliding friction behind the low-pass lags every reversal by 1/K, 19 mrad/s at this acceleration: the fit knows the
    /// low-pass and does not take that for doubt about the sign, of which there is 1 mrad/s of noise.
    #[test]
    fn the_lag_of_the_observer_is_not_taken_for_doubt() {
        let (mut rng, mut rows) = (Pcg64::seed_from_u64(4), JointRows::default());
        let share = 1.0 - (-50.0_f64 * 2e-3).exp();
        let mut residual = 0.0;
        for k in 0..20_000 {
            let v = 0.3 * (6.3e-3 * k as f64).sin();
            residual += share * (0.8 * v.signum() + 0.5 * v - residual);
            rows.qd.push(v + 1e-3 * rng.sample::<f64, _>(StandardNormal));
            rows.residual.push(residual + 0.03 * rng.sample::<f64, _>(StandardNormal));
            rows.share.push(if k == 0 { 1.0 } else { share });
            rows.counts.push(k > 100 && k % 10 == 0);
        }
        let fit = fit_joint(&rows).unwrap();
        println!("{fit:?}");
        assert!(fit.band.doubt_rad_s < 6e-3 && fit.band.noise_sd_nm < 0.04, "{fit:?}");
        assert!((fit.band.coulomb_max_nm - 0.8).abs() < 0.01, "{fit:?}");
    }

    #[test]
    fn one_direction_is_not_enough() {
        let mut rows = drawn(&truth(), 1000, 1);
        rows.qd.iter_mut().for_each(|v| *v = v.abs());
        assert_eq!(fit_joint(&rows), None);
    }
}
