//! Torque ripple: the order spectrum of the residual over the joint angle.

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::column::FineColumn;
use crate::least_squares::{fit_rows, inner, solve_truncated};
use crate::noise_level::median;
use crate::regression_data::{RegressionData, Sample};
use crate::whitening::Whitening;

/// A ripple of one joint, found at the full rate of the log: most of it may lie above the band of the residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RippleLine {
    /// The joint, from 0.
    pub joint: usize,
    /// Cycles per revolution [1/rev].
    pub cycles_per_rev: f64,
    /// Coefficient of sin(n q) (Nm).
    pub sine_nm: f64,
    /// Coefficient of cos(n q) (Nm).
    pub cosine_nm: f64,
    /// Standard error of either (Nm).
    pub standard_error_nm: f64,
    /// Standard error of the order [1/rev].
    pub order_error: f64,
    /// Evidence, after the price of order, amplitude and phase.
    pub evidence: f64,
}

impl RippleLine {
    /// Amplitude (Nm).
    pub fn amplitude_nm(&self) -> f64 {
        self.sine_nm.hypot(self.cosine_nm)
    }

    /// Its torque on the fine grid (Nm).
    pub fn torque<const N: usize>(&self, data: &RegressionData<N>) -> FineColumn<N> {
        let (n, a, b) = (self.cycles_per_rev, self.sine_nm, self.cosine_nm);
        data.joint_column(self.joint, |at| {
            let (sine, cosine) = (n * at.q[self.joint]).sin_cos();
            a * sine + b * cosine
        })
    }
}

/// Orders searched [1/rev]: below, position springs and gravity live.
const LOWEST_ORDER: f64 = 12.0;
const HIGHEST_ORDER: f64 = 1000.0;
/// Cells of the order resolution 2π/range that the lowest order must be away from zero.
const CELLS: f64 = 4.0;
/// Bins of the joint angle per period of the highest order.
const BINS_PER_PERIOD: f64 = 10.0;
/// Half-width of the spectrum's background, in cells.
const BACKGROUND_CELLS: f64 = 40.0;
/// Ripples per joint.
const MOST_LINES: usize = 3;
/// Relative distance of two orders of one joint: closer ones are one ripple whose strength varies with posture.
const DISTINCT: f64 = 0.05;
/// Least RMS of a ripple over the torque sensor's noise in the band.
const LEAST_OVER_NOISE: f64 = 0.25;
/// Least evidence: thousands of orders are tried, and the leavings of reversals are not white over the angle.
const LEAST_EVIDENCE: f64 = 60.0;
/// Least RMS (Nm).
const LEAST_RMS_NM: f64 = 2.5e-3;
/// Median of a chi-square of two degrees of freedom.
const CHI2_MEDIAN: f64 = 1.386_294_361_119_890_6;

/// Ripples of all joints in `measured − model − explained`, unfiltered; `explained` is what other causes explain.
pub fn ripples<const N: usize>(data: &RegressionData<N>, explained: &[nalgebra::SVector<f64, N>]) -> Vec<RippleLine> {
    (0..N).into_par_iter().flat_map_iter(|joint| joint_ripples(data, explained, joint)).collect()
}

fn joint_ripples<const N: usize>(
    data: &RegressionData<N>,
    explained: &[nalgebra::SVector<f64, N>],
    joint: usize,
) -> Vec<RippleLine> {
    let mut lines = Vec::new();
    if !data.moves(joint) {
        return lines;
    }
    let bursts: Vec<Range<usize>> = data.bursts.iter().map(|burst| burst.fine.clone()).collect();
    let q: Vec<f64> = data.motion.iter().map(|at| at.q[joint]).collect();
    let mut left = slow_part_removed(data, explained, joint);
    for _ in 0..MOST_LINES {
        let whitening = Whitening::of(&left, &bursts, 1e-9);
        let Some(line) = strongest_line(data, &whitening, &bursts, &q, &left, joint) else { break };
        left.iter_mut().zip(&q).for_each(|(left, q)| {
            let (sine, cosine) = (line.cycles_per_rev * q).sin_cos();
            *left -= line.sine_nm * sine + line.cosine_nm * cosine;
        });
        let seen =
            lines.iter().any(|other: &RippleLine| (line.cycles_per_rev / other.cycles_per_rev - 1.0).abs() < DISTINCT);
        if seen {
            break;
        }
        lines.push(line);
    }
    lines
}

/// The raw residual without what slow causes of the joint explain: sign, velocity, acceleration, load, angle, constant.
///
/// Their coefficients are those of the band: outside it the noise of the acceleration is in the residual and in the
/// regressor alike, and would pass for inertia.
fn slow_part_removed<const N: usize>(
    data: &RegressionData<N>,
    explained: &[nalgebra::SVector<f64, N>],
    j: usize,
) -> Vec<f64> {
    let residual = data.samples().enumerate();
    let y: Vec<f64> = residual
        .map(|(k, at)| at.measured_nm[j] - at.model_nm[j] - explained.get(k).map_or(0.0, |tau| tau[j]))
        .collect();
    let base = |value: &dyn Fn(&Sample<N>) -> f64| data.samples().map(|at| value(&at)).collect::<Vec<f64>>();
    let mut bases = vec![
        base(&|_| 1.0),
        base(&|at| at.sign[j]),
        base(&|at| at.qd[j]),
        base(&|at| at.qdd[j]),
        base(&|at| at.link_nm[j]),
        base(&|at| at.q[j]),
        base(&|at| at.q[j].sin()),
        base(&|at| at.q[j].cos()),
    ];
    bases.push(y);
    let mut in_band = data.filter_own_all(&bases);
    let (target, y) = (in_band.pop().unwrap_or_default(), bases.pop().unwrap_or_default());
    let fit = fit_rows(&in_band, &target, 1e-8);
    let slow = |row: usize| -> f64 { bases.iter().zip(&fit.coefficients).map(|(base, c)| c * base[row]).sum() };
    y.iter().enumerate().map(|(row, y)| y - slow(row)).collect()
}

fn strongest_line<const N: usize>(
    data: &RegressionData<N>,
    whitening: &Whitening,
    bursts: &[Range<usize>],
    q: &[f64],
    left: &[f64],
    joint: usize,
) -> Option<RippleLine> {
    let spectrum = Spectrum::of(data, whitening, bursts, q, left, joint)?;
    let bins = spectrum.binned(left);
    let power: Vec<f64> = spectrum.orders.iter().map(|order| spectrum.power_of(&bins, *order)).collect();
    // Short strokes smear a line over its surroundings, so that it need not be the one that stands out most from them.
    let peak = (0..power.len()).max_by(|a, b| power[*a].total_cmp(&power[*b]))?;
    let prominent = (0..power.len())
        .filter(|i| power[*i] > 0.2 * power[peak])
        .map(|i| (i, power[i] / spectrum.background(&power, i)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?
        .0;
    let mut peaks = vec![prominent, peak];
    peaks.dedup();
    let lines = peaks.into_iter().map(|peak| spectrum.line(&bins, peak));
    let line = lines.max_by(|a, b| a.evidence.total_cmp(&b.evidence))?;
    let rms = line.amplitude_nm() / 2f64.sqrt();
    let strong = rms > LEAST_RMS_NM && rms > LEAST_OVER_NOISE * data.torque_floor_nm[joint];
    (line.evidence > LEAST_EVIDENCE && strong).then_some(line)
}

/// Order spectrum of what is left of a joint: the score WᵀW r of every order, summed over bins of the angle, then a Fourier sum over the
/// bins.
struct Spectrum<'s> {
    whitening: &'s Whitening,
    bursts: &'s [Range<usize>],
    q: &'s [f64],
    left: &'s [f64],
    joint: usize,
    joints: usize,
    norm: OrderNorm,
    /// Least angle (rad) and width of a bin (rad).
    low: f64,
    width: f64,
    bins: usize,
    /// Order resolution 2π/range, and the step of the orders below.
    cell: f64,
    step: f64,
    orders: Vec<f64>,
}

impl<'s> Spectrum<'s> {
    /// The orders of a joint; `None` where it moves too little to tell any.
    fn of<const N: usize>(
        data: &RegressionData<N>,
        whitening: &'s Whitening,
        bursts: &'s [Range<usize>],
        q: &'s [f64],
        left: &'s [f64],
        joint: usize,
    ) -> Option<Self> {
        let (low, high) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), q| (l.min(*q), h.max(*q)));
        let range = high - low;
        let cell = 2.0 * PI / range.max(1e-3);
        let lowest = LOWEST_ORDER.max(CELLS * cell);
        if lowest > 0.5 * HIGHEST_ORDER {
            return None;
        }
        let width = 2.0 * PI / (HIGHEST_ORDER * BINS_PER_PERIOD);
        let bins = (range / width).ceil() as usize + 1;
        let step = 0.4 * cell;
        let orders = (0..).map(|i| lowest + f64::from(i) * step).take_while(|order| *order <= HIGHEST_ORDER).collect();
        let norm = OrderNorm::new(data, whitening, joint);
        Some(Self { whitening, bursts, q, left, joint, joints: N, norm, low, width, bins, cell, step, orders })
    }

    /// Scores of a residual, bin by bin of the angle.
    fn binned(&self, residual: &[f64]) -> Vec<f64> {
        let mut bins = vec![0.0; self.bins];
        let doubly = doubly_whitened(self.whitening, self.bursts, residual);
        self.q.iter().zip(doubly).for_each(|(q, value)| bins[((q - self.low) / self.width) as usize] += value);
        bins
    }

    fn power_of(&self, bins: &[f64], order: f64) -> f64 {
        let (sine, cosine) = fourier_sum(bins, order * self.width, order * (self.low + 0.5 * self.width));
        2.0 * (sine * sine + cosine * cosine) / self.norm.at(order)
    }

    /// Orders on either side of one that are its surroundings.
    fn half(&self) -> usize {
        ((BACKGROUND_CELLS * self.cell / self.step) as usize).max(20)
    }

    /// Power of the surroundings of an order, 1 for white noise.
    fn background(&self, power: &[f64], i: usize) -> f64 {
        let half = self.half();
        let mut around: Vec<f64> = power[i.saturating_sub(half)..(i + half).min(power.len())].to_vec();
        (median(&mut around).unwrap_or(CHI2_MEDIAN) / CHI2_MEDIAN).max(1.0)
    }

    /// The line at a peak: order refined between the neighbours, then both coefficients by least squares on the whitened columns.
    fn line(&self, bins: &[f64], peak: usize) -> RippleLine {
        let (q, left) = (self.q, self.left);
        let order = maximum_near(|order| self.power_of(bins, order), self.orders[peak], self.step);
        let columns = [
            q.iter().map(|q| (order * q).sin()).collect::<Vec<f64>>(),
            q.iter().map(|q| (order * q).cos()).collect::<Vec<f64>>(),
        ];
        let whiten = |x: &[f64]| {
            self.bursts.iter().flat_map(|burst| self.whitening.apply(&x[burst.clone()])).collect::<Vec<f64>>()
        };
        let (white, target) = (columns.each_ref().map(|column| whiten(column)), whiten(left));
        let square = DMatrix::from_fn(2, 2, |a, b| inner(&white[a], &white[b]));
        let score = DVector::from_fn(2, |a, _| inner(&white[a], &target));
        let norms = DVector::from_fn(2, |a, _| square[(a, a)].sqrt());
        let fit = solve_truncated(&square, &score, &norms, 1e-6);
        let clipped_target: Vec<f64> = target.iter().copied().map(clipped).collect();
        let clipped_score = DVector::from_fn(2, |a, _| inner(&white[a], &clipped_target));
        let explained = solve_truncated(&square, &clipped_score, &norms, 1e-6).explained;
        let n = target.len().max(2) as f64;

        // The background without the line itself: short strokes smear it over many orders.
        let rest: Vec<f64> = (0..left.len())
            .map(|k| left[k] - fit.coefficients[0] * columns[0][k] - fit.coefficients[1] * columns[1][k])
            .collect();
        let bins_rest = self.binned(&rest);
        let near = peak.saturating_sub(self.half())..(peak + self.half()).min(self.orders.len());
        let around: Vec<f64> = self.orders[near].iter().map(|order| self.power_of(&bins_rest, *order)).collect();
        let background = self.background(&around, around.len() / 2);
        let tried = (self.orders.len() as f64 * self.joints as f64).ln();
        let variance = 2.0 * background / square.trace().max(1e-300);
        RippleLine {
            joint: self.joint,
            cycles_per_rev: order,
            sine_nm: fit.coefficients[0],
            cosine_nm: fit.coefficients[1],
            standard_error_nm: variance.sqrt(),
            order_error: self.cell * 0.4 / (explained / background).max(1.0).sqrt(),
            evidence: explained / background - 3.0 * n.ln() - 2.0 * tried,
        }
    }
}

/// A whitened residual no farther out than a few standard deviations: what reversals leave over is no ripple.
fn clipped(white: f64) -> f64 {
    white.clamp(-FARTHEST_SD, FARTHEST_SD)
}

/// Standard deviations.
const FARTHEST_SD: f64 = 3.5;

/// WᵀW x per burst, clipped between: scores of any column are then plain sums.
fn doubly_whitened(whitening: &Whitening, bursts: &[Range<usize>], x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; x.len()];
    for burst in bursts {
        let white: Vec<f64> = whitening.apply(&x[burst.clone()]).into_iter().map(clipped).collect();
        let adjoint = whitening.apply_adjoint(&white);
        out[burst.clone()].iter_mut().zip(adjoint).for_each(|(out, value)| *out = value);
    }
    out
}

/// `Σ_k bins_k (sin, cos)(k step + start)` by rotation.
fn fourier_sum(bins: &[f64], step: f64, start: f64) -> (f64, f64) {
    let (turn_sine, turn_cosine) = step.sin_cos();
    let (mut sine, mut cosine) = start.sin_cos();
    let (mut sum_sine, mut sum_cosine) = (0.0, 0.0);
    for value in bins {
        sum_sine += value * sine;
        sum_cosine += value * cosine;
        (sine, cosine) = (sine * turn_cosine + cosine * turn_sine, cosine * turn_cosine - sine * turn_sine);
    }
    (sum_sine, sum_cosine)
}

/// Square of a whitened `e^{inq}`: the whitening's gain at the frequency n qd, summed over the samples.
struct OrderNorm {
    /// Angle per sample at n = 1, and how many samples share it.
    angles: Vec<(f64, f64)>,
    gain: Vec<f64>,
}

impl OrderNorm {
    fn new<const N: usize>(data: &RegressionData<N>, whitening: &Whitening, joint: usize) -> Self {
        const TABLE: usize = 1024;
        const KEPT: usize = 1500;
        let gain = (0..=TABLE).map(|i| whitening.power_gain(PI * i as f64 / TABLE as f64)).collect();
        let every = (data.motion.len() / KEPT).max(1);
        let dt = |burst: &crate::logged_motion::Burst| data.period_s(burst);
        let angles = data
            .bursts
            .iter()
            .flat_map(|burst| burst.fine.clone().step_by(every).map(move |k| (k, dt(burst))))
            .map(|(k, dt_s)| ((data.motion[k].qd[joint] * dt_s).abs(), every as f64))
            .collect();
        Self { angles, gain }
    }

    fn at(&self, order: f64) -> f64 {
        let table = (self.gain.len() - 1) as f64;
        let sum: f64 = self
            .angles
            .iter()
            .map(|(angle, count)| {
                // Folded at the Nyquist frequency: without anti-alias filter the samples are exact all the same.
                let turns = (order * angle / (2.0 * PI)).fract();
                let folded = 2.0 * turns.min(1.0 - turns);
                count * self.gain[(folded * table) as usize]
            })
            .sum();
        sum.max(1e-300)
    }
}

/// Maximum of a smooth function near x, by golden section over ± step.
fn maximum_near(value: impl Fn(f64) -> f64, x: f64, step: f64) -> f64 {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut left, mut right) = (x - step, x + step);
    for _ in 0..30 {
        let (a, b) = (right - golden * (right - left), left + golden * (right - left));
        if value(a) > value(b) { right = b } else { left = a }
    }
    0.5 * (left + right)
}
