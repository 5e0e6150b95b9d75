//! `dq` held against the derivative of q.
//!
//! ```text
//! Δq_k = q(t_k + W) − q(t_k),   I_k = ∫ dq dt over the same window,   scale = Σ I Δq / Σ Δq²,   r = Σ I Δq / √(ΣI² ΣΔq²)
//! ```
//!
//! Integrals in place of derivatives: noise of the encoder counts twice per window and not once per row. The lag at which r is
//! largest is the delay of `dq`; scale and r are those at that lag.

use super::clock::unit_of;
use super::remark::joints_named;
use super::{Fault, Remark};
use crate::LogColumns;
use crate::bursts::median_period_s;

/// W (s), at least four rows.
const WINDOW_S: f64 = 0.1;
/// Longest lag that is tried (s).
const LONGEST_LAG_S: f64 = 0.25;
/// Lags per window.
const LAGS_PER_WINDOW: usize = 20;
/// Windows per length of a window.
const STARTS_PER_WINDOW: usize = 5;
/// Longest part of a log that is looked at, in windows.
const MOST_WINDOWS: usize = 6000;
/// Windows a judgement needs.
const LEAST_WINDOWS: usize = 30;
/// RMS speed (rad/s) above which a joint moves.
const MOVING_RAD_S: f64 = 0.01;
/// Δq over its noise below which a joint says nothing.
const LEAST_SIGNAL: f64 = 20.0;
/// Correlation below which `dq` has nothing to do with q, and above which it is judged by its scale.
const UNRELATED: f64 = 0.6;
const RELATED: f64 = 0.9;
/// Error of the scale that is named [-], and that cannot be right.
const SCALE_ERROR: f64 = 0.03;
const GROSS_SCALE: f64 = 1.3;
/// Standard errors that a scale error must have.
const STANDARD_ERRORS: f64 = 5.0;
/// Delay that is named (s), at least two rows.
const DELAY_S: f64 = 0.015;
const DELAY_ROWS: f64 = 2.0;
/// By how much 1 − r² must fall at the lag.
const DELAY_GAIN: f64 = 3.0;
/// Degrees per radian.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// What was measured of one joint.
#[derive(Clone, Copy, Debug)]
struct Fit {
    joint: usize,
    scale: f64,
    scale_error: f64,
    correlation: f64,
    /// 1 − r² without lag over that with it.
    gain: f64,
    delay_s: f64,
}

/// What is wrong with the velocities, joints that are `known` to be broken left out.
pub(super) fn against_position(log: &LogColumns, known: &[usize]) -> Vec<Remark> {
    let Some(windows) = Windows::of(log) else { return Vec::new() };
    let fits: Vec<Fit> =
        (0..log.joints()).filter(|joint| !known.contains(joint)).filter_map(|joint| windows.fit(log, joint)).collect();
    let mut remarks = Vec::new();
    let of = |wrong: &dyn Fn(&Fit) -> bool| fits.iter().copied().filter(|fit| wrong(fit)).collect::<Vec<Fit>>();
    let named = |fits: &[Fit]| fits.iter().map(|fit| fit.joint).collect::<Vec<usize>>();

    // No relation, the opposite sign, another clock, another unit.
    let other = of(&|fit| fit.correlation.abs() < UNRELATED);
    if let Some(worst) = other.iter().min_by(|a, b| a.correlation.abs().total_cmp(&b.correlation.abs())) {
        let evidence = format!(
            "dq of {} has nothing to do with the motion of q: correlation {:.2}",
            joints_named(&named(&other)),
            worst.correlation
        );
        let remedy = "leave the dq columns out: they are worked out from q".to_owned();
        remarks.push(Remark::refuse(Fault::VelocityOther, named(&other), evidence, remedy));
    }
    let opposite = of(&|fit| fit.correlation <= -UNRELATED);
    if let Some(worst) = opposite.iter().max_by(|a, b| a.correlation.total_cmp(&b.correlation)) {
        let evidence = format!(
            "dq of {} has the opposite sign of the derivative of q: correlation {:.2}",
            joints_named(&named(&opposite)),
            worst.correlation
        );
        let columns = opposite.iter().map(|fit| format!("dq_{}", fit.joint)).collect::<Vec<_>>().join(", ");
        let remedy = format!("multiply {columns} by -1, or q if that is what is wrong");
        remarks.push(Remark::refuse(Fault::VelocitySign, named(&opposite), evidence, remedy));
    }
    let off = of(&|fit| {
        fit.correlation > RELATED && (fit.scale - 1.0).abs() > SCALE_ERROR.max(STANDARD_ERRORS * fit.scale_error)
    });
    let gross = |fit: &Fit| fit.scale > GROSS_SCALE || fit.scale < GROSS_SCALE.recip();
    for wrong in
        [off.iter().copied().filter(gross).collect::<Vec<_>>(), off.iter().copied().filter(|f| !gross(f)).collect()]
    {
        remarks.extend(scale_remark(&wrong, fits.len()));
    }

    // Late.
    let row_s = windows.period_s;
    let late = of(&|fit| {
        fit.correlation > RELATED && fit.delay_s.abs() > DELAY_S.max(DELAY_ROWS * row_s) && fit.gain > DELAY_GAIN
    });
    if let Some(worst) = late.iter().max_by(|a, b| a.delay_s.abs().total_cmp(&b.delay_s.abs())) {
        let when = if worst.delay_s > 0.0 { "later" } else { "earlier" };
        let evidence = format!(
            "dq of {} comes up to {:.0} ms {when} than the derivative of q",
            joints_named(&named(&late)),
            1e3 * worst.delay_s.abs()
        );
        let remedy = "leave the dq columns out (they are worked out from q), or log both at one instant".to_owned();
        remarks.push(Remark::warn(Fault::VelocityDelay, named(&late), evidence, remedy));
    }
    remarks
}

/// Joints of which `dq` is another multiple than 1.
fn scale_remark(wrong: &[Fit], judged: usize) -> Option<Remark> {
    let mut scales: Vec<f64> = wrong.iter().map(|fit| fit.scale).collect();
    let middle = scales.len() / 2;
    let median = *(!scales.is_empty()).then(|| scales.select_nth_unstable_by(middle, f64::total_cmp).1)?;
    let joints: Vec<usize> = wrong.iter().map(|fit| fit.joint).collect();
    let of_all = wrong.len() == judged && wrong.len() > 1;
    let alike = wrong.iter().all(|fit| (fit.scale / median).ln().abs() < 0.1);
    let evidence = format!("dq of {} is {median:.4} times the derivative of q", joints_named(&joints));
    let near = |scale: f64| (median / scale).ln().abs() < 0.05;
    if let (Some((unit, per_second)), true) = (unit_of(median), of_all && alike) {
        let remedy = format!("time is in {unit}, it seems: divide it by {per_second:e}");
        return Some(Remark::refuse(Fault::Clock, Vec::new(), evidence, remedy));
    }
    if near(DEGREES) {
        let remedy = "dq is in degrees/s, it seems: multiply it by pi/180".to_owned();
        return Some(Remark::refuse(Fault::VelocityScale, joints, evidence, remedy));
    }
    if near(DEGREES.recip()) {
        let remedy = "q is in degrees, it seems: multiply it by pi/180".to_owned();
        return Some(Remark::refuse(Fault::Degrees, joints, evidence, remedy));
    }
    let gross = median > GROSS_SCALE || median < GROSS_SCALE.recip();
    let remedy = if of_all && alike {
        "either dq or the time stamps are off by that factor; what uses the wrong one is off too".to_owned()
    } else {
        "dq is off by that factor; leave the dq columns out: they are worked out from q".to_owned()
    };
    let make = if gross { Remark::refuse } else { Remark::warn };
    Some(make(Fault::VelocityScale, joints, evidence, remedy))
}

/// The windows of a log.
struct Windows {
    period_s: f64,
    /// Rows of a window.
    rows: usize,
    /// First rows of windows without a gap, with their lags.
    starts: Vec<usize>,
    /// Rows of a lag step.
    lag: usize,
    /// Lags each way.
    lags: usize,
}

impl Windows {
    fn of(log: &LogColumns) -> Option<Self> {
        let period_s = median_period_s(&log.time_s).filter(|period| *period > 0.0)?;
        let rows = ((WINDOW_S / period_s).round() as usize).clamp(4, 10_000);
        let lag = (rows / LAGS_PER_WINDOW).max(1);
        let lags = ((LONGEST_LAG_S / period_s) as usize / lag).clamp(2, 5 * LAGS_PER_WINDOW);
        let (margin, last) = (lag * lags, log.rows().checked_sub(rows + 1)?);
        let stride = (rows / STARTS_PER_WINDOW).max(1);
        let longest_s = 1.5 * period_s * (rows + 2 * margin) as f64;
        let t = &log.time_s;
        let whole = |k: &usize| t[k + rows + margin] - t[k - margin] < longest_s;
        let all: Vec<usize> = (margin..last.saturating_sub(margin)).step_by(stride).filter(whole).collect();
        let keep = all.len().div_ceil(MOST_WINDOWS).max(1);
        let starts: Vec<usize> = all.into_iter().step_by(keep).collect();
        (starts.len() >= LEAST_WINDOWS).then_some(Self { period_s, rows, starts, lag, lags })
    }

    /// Scale, correlation and delay of one joint; `None` if it hardly moves.
    fn fit(&self, log: &LogColumns, joint: usize) -> Option<Fit> {
        let (t, q, dq) = (&log.time_s, &log.q_rad[joint], &log.dq_rad_s[joint]);
        let mut integral = Vec::with_capacity(q.len());
        let mut sum = 0.0;
        for k in 0..q.len() {
            if k > 0 {
                sum += 0.5 * (dq[k] + dq[k - 1]) * (t[k] - t[k - 1]);
            }
            integral.push(sum);
        }
        let moved: Vec<f64> = self.starts.iter().map(|&k| q[k + self.rows] - q[k]).collect();
        let count = moved.len() as f64;
        let moved_square: f64 = moved.iter().map(|x| x * x).sum();
        let rms = (moved_square / count).sqrt();
        // Second differences a few rows apart: noise and resolution of the encoder, and little of the motion.
        let noise = |k: usize| q[k + 2] - 2.0 * q[k + 1] + q[k];
        let noise_square: f64 = self.starts.iter().map(|&k| noise(k).powi(2)).sum::<f64>() / 6.0;
        let enough =
            rms > MOVING_RAD_S * self.period_s * self.rows as f64 && rms > LEAST_SIGNAL * (noise_square / count).sqrt();
        if !(enough && rms.is_finite()) {
            return None;
        }
        let at = |lag: isize| -> (f64, f64) {
            let (mut cross, mut square) = (0.0, 0.0);
            for (&k, moved) in self.starts.iter().zip(&moved) {
                let from = k.saturating_add_signed(lag);
                let claimed = integral[from + self.rows] - integral[from];
                cross += claimed * moved;
                square += claimed * claimed;
            }
            let correlation = cross / (square * moved_square).sqrt();
            (cross / moved_square, if correlation.is_finite() { correlation } else { 0.0 })
        };
        let (lags, step) = (self.lags as isize, self.lag as isize);
        let tried: Vec<(isize, f64, f64)> = (-lags..=lags)
            .map(|n| {
                let (scale, correlation) = at(n * step);
                (n, scale, correlation)
            })
            .collect();
        let best = tried.iter().enumerate().max_by(|a, b| a.1.2.abs().total_cmp(&b.1.2.abs()))?.0;
        let (n, scale, correlation) = tried[best];
        let unexplained = |r: f64| (1.0 - r * r).max(1e-9);
        // A parabola through the three values around the best.
        let shift = match (best.checked_sub(1).and_then(|k| tried.get(k)), tried.get(best + 1)) {
            (Some(before), Some(after)) => {
                let (a, b, c) = (unexplained(before.2), unexplained(correlation), unexplained(after.2));
                let bend = a - 2.0 * b + c;
                if bend > 0.0 { (0.5 * (a - c) / bend).clamp(-0.5, 0.5) } else { 0.0 }
            }
            _ => 0.0,
        };
        let independent = (count / STARTS_PER_WINDOW as f64).max(1.0);
        Some(Fit {
            joint,
            scale,
            scale_error: scale.abs() * (unexplained(correlation) / independent).sqrt(),
            correlation,
            gain: unexplained(tried[self.lags].2) / unexplained(correlation),
            delay_s: (n as f64 + shift) * step as f64 * self.period_s,
        })
    }
}
