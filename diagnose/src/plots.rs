//! The evidence in pictures and shares: what the residual goes with.

use nalgebra::{DMatrix, DVector};
use tribo_regression::cause::Candidate;
use tribo_regression::deflection::DeflectionFinding;
use tribo_regression::least_squares::solve_truncated;
use tribo_regression::ripple::RippleLine;
use tribo_regression::{CauseLabel, Column, FineColumn, Location, RegressionData, add_scaled};
use tribo_robot::{Arm, JointNames, gravity_torque, inverse_dynamics_regressor};

use crate::diagnosis::{CrossJointPattern, Plot, Series};
use crate::report::cause_at;

/// Points of a cloud.
const MOST_POINTS: usize = 1500;
/// Bins of a mean curve.
const BINS: usize = 40;
/// Way after a reversal that presliding is drawn over (rad): some distances of any bristle.
const PRESLIDING_WAY_RAD: f64 = 0.03;
/// Fewest samples of a bin.
const LEAST_IN_BIN: usize = 3;

/// What a torque is drawn against.
fn abscissa(label: CauseLabel) -> (&'static str, &'static str) {
    match label {
        CauseLabel::TorqueRipple | CauseLabel::PositionSpring => ("position", "q [rad]"),
        CauseLabel::TorqueGain | CauseLabel::LoadFriction => ("load", "link torque [Nm]"),
        CauseLabel::RotorInertia => ("acceleration", "qdd [rad/s²]"),
        CauseLabel::Coulomb
        | CauseLabel::Viscous
        | CauseLabel::Stribeck
        | CauseLabel::CoulombAsymmetry
        | CauseLabel::TorqueOffset => ("velocity", "qd [rad/s]"),
        CauseLabel::Presliding => ("the way since it turned back", "way since it turned back [rad]"),
        _ => ("time", "time [s]"),
    }
}

/// The residual that a member of the findings explains, against what it goes with, and its fit.
pub(crate) fn of_member<const N: usize>(
    data: &RegressionData<N>,
    candidate: &dyn Candidate<N>,
    plain: &[Column<N>],
    coefficients: &[f64],
    residual_after: &[Vec<f64>; N],
) -> Vec<Plot> {
    let torque = |j: usize| -> Vec<f64> {
        let mut sum = vec![0.0; data.time_s.len()];
        for (column, c) in plain.iter().zip(coefficients) {
            if let Some(values) = &column.rows[j] {
                add_scaled(&mut sum, values, *c);
            }
        }
        sum
    };
    let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let joint = match candidate.location() {
        Location::Joint(joint) => joint,
        _ => (0..N).max_by(|a, b| square(&torque(*a)).total_cmp(&square(&torque(*b)))).unwrap_or(0),
    };
    let mut fit = torque(joint);
    let mut partial: Vec<f64> = residual_after[joint].iter().zip(&fit).map(|(r, x)| r + x).collect();
    let (name, x_label) = abscissa(candidate.label());
    let mut x = natural_abscissa(data, name, joint);
    let mut y_label = "torque that the other findings leave [Nm]";
    if candidate.label() == CauseLabel::Presliding {
        // Both ways alike: along the motion, and only as far as bristles bend.
        let near: Vec<usize> = (0..x.len()).filter(|k| x[*k] < PRESLIDING_WAY_RAD).collect();
        let along = |y: &[f64]| near.iter().map(|k| y[*k] * data.qd[joint][*k].signum()).collect();
        (fit, partial) = (along(&fit), along(&partial));
        x = near.iter().map(|k| x[*k]).collect();
        y_label = "torque along the motion [Nm]";
    }
    let measured = cloud("measured − model", &x, &partial);
    // Against time there is nothing to average: the fit itself, joined where the log has no gap.
    let curves = if name == "time" {
        vec![Series { joined: data.bursts.len() == 1, ..cloud("fit", &x, &fit) }]
    } else {
        vec![mean_curve("mean", &x, &partial), mean_curve("fit", &x, &fit)]
    };
    let names = &data.nominal.arm.joint_names;
    let what = cause_at(candidate.label(), candidate.location(), names);
    vec![Plot {
        title: format!("{}: torque of {} against {name}", capital(&what), names.of(joint)),
        x_label: x_label.to_owned(),
        y_label: y_label.to_owned(),
        series: [vec![measured], curves].concat(),
    }]
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn natural_abscissa<const N: usize>(data: &RegressionData<N>, name: &str, joint: usize) -> Vec<f64> {
    let filtered = |column: FineColumn<N>| data.filter(&column).rows[joint].as_deref().cloned().unwrap_or_default();
    match name {
        "velocity" => data.qd[joint].clone(),
        "position" => data.q[joint].clone(),
        "load" => filtered(data.joint_column(joint, |at| at.link_nm[joint])),
        "acceleration" => filtered(data.joint_column(joint, |at| at.qdd[joint])),
        "the way since it turned back" => way_since_reversal(data, joint),
        _ => data.time_s.clone(),
    }
}

/// Way of a joint (rad) since its velocity last changed sign, or since its burst began.
fn way_since_reversal<const N: usize>(data: &RegressionData<N>, joint: usize) -> Vec<f64> {
    let (q, qd) = (&data.q[joint], &data.qd[joint]);
    let mut way = Vec::with_capacity(q.len());
    for burst in &data.bursts {
        let mut turned_at = q.get(burst.out.start).copied().unwrap_or_default();
        for k in burst.out.clone() {
            if k > burst.out.start && qd[k] * qd[k - 1] < 0.0 {
                turned_at = q[k];
            }
            way.push((q[k] - turned_at).abs());
        }
    }
    way
}

fn cloud(name: &str, x: &[f64], y: &[f64]) -> Series {
    let every = (x.len() / MOST_POINTS).max(1);
    let thin = |values: &[f64]| values.iter().step_by(every).copied().collect();
    Series { name: name.to_owned(), x: thin(x), y: thin(y), joined: false }
}

/// Means over equal bins of x.
fn mean_curve(name: &str, x: &[f64], y: &[f64]) -> Series {
    let (low, high) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let width = (high - low) / BINS as f64;
    let mut sums = vec![(0.0, 0.0, 0usize); BINS];
    if width > 0.0 {
        for (x, y) in x.iter().zip(y) {
            let bin = &mut sums[(((x - low) / width) as usize).min(BINS - 1)];
            *bin = (bin.0 + x, bin.1 + y, bin.2 + 1);
        }
    }
    let filled = sums.iter().filter(|bin| bin.2 >= LEAST_IN_BIN);
    let (x, y) = filled.map(|(x, y, count)| (x / *count as f64, y / *count as f64)).unzip();
    Series { name: name.to_owned(), x, y, joined: true }
}

/// A ripple, folded into one cycle at the full rate of the log.
pub(crate) fn of_ripple<const N: usize>(data: &RegressionData<N>, line: &RippleLine) -> Vec<Plot> {
    let j = line.joint;
    let turn = 2.0 * std::f64::consts::PI;
    let x: Vec<f64> = data.motion.iter().map(|at| (line.cycles_per_rev * at.q[j]).rem_euclid(turn)).collect();
    let mut y: Vec<f64> = data.samples().map(|at| at.measured_nm[j] - at.model_nm[j]).collect();
    let mean_nm = y.iter().sum::<f64>() / y.len().max(1) as f64;
    y.iter_mut().for_each(|y| *y -= mean_nm);
    let fit: Vec<f64> = x.iter().map(|x| line.sine_nm * x.sin() + line.cosine_nm * x.cos()).collect();
    vec![Plot {
        title: format!(
            "Torque ripple at {}: {:.1} cycles per revolution, folded",
            data.nominal.arm.joint_names.of(j),
            line.cycles_per_rev
        ),
        x_label: "phase of the cycle [rad]".to_owned(),
        y_label: "measured − model, less its mean [Nm]".to_owned(),
        series: vec![mean_curve("mean", &x, &y), mean_curve("fit", &x, &fit)],
    }]
}

/// The deflection between two encoders against the load.
pub(crate) fn of_deflection(found: &DeflectionFinding, names: &JointNames) -> Vec<Plot> {
    let [load, deflection, fit] = &found.cloud;
    let milli = |x: &[f64]| x.iter().map(|x| 1e3 * x).collect::<Vec<f64>>();
    vec![Plot {
        title: format!(
            "{}: theta − q against the load",
            capital(&cause_at(found.label, Location::Joint(found.joint), names))
        ),
        x_label: "link torque [Nm]".to_owned(),
        y_label: "theta − q [mrad]".to_owned(),
        series: vec![cloud("measured", load, &milli(deflection)), mean_curve("fit", load, &milli(fit))],
    }]
}

/// Residual against velocity, position, load and time for every joint, and its spectrum.
pub(crate) fn overview<const N: usize>(data: &RegressionData<N>, residual: &[Vec<f64>; N]) -> Vec<Plot> {
    let mut plots = Vec::new();
    for j in 0..N {
        for (name, x_label) in
            [("time", "time [s]"), ("velocity", "qd [rad/s]"), ("position", "q [rad]"), ("load", "link torque [Nm]")]
        {
            let x = natural_abscissa(data, name, j);
            plots.push(Plot {
                title: format!("Residual against {name}, {}", data.nominal.arm.joint_names.of(j)),
                x_label: x_label.to_owned(),
                y_label: "measured − model [Nm]".to_owned(),
                series: vec![cloud("residual", &x, &residual[j]), mean_curve("mean", &x, &residual[j])],
            });
        }
        plots.push(spectrum(data, &residual[j], j));
    }
    plots
}

/// Frequencies of the spectrum.
const FREQUENCIES: usize = 120;

/// Amplitude spectrum of the residual over time: direct Fourier sums on a logarithmic grid, Hann window.
fn spectrum<const N: usize>(data: &RegressionData<N>, residual: &[f64], joint: usize) -> Plot {
    let longest = data.bursts.iter().map(|burst| burst.out.clone()).max_by_key(ExactSizeIterator::len).unwrap_or(0..0);
    let rate_hz = data.chains.first().map_or(1.0, |chain| chain.output_rate_hz());
    let (x, n) = (&residual[longest.clone()], longest.len() as f64);
    let (low, high) = (2.0 * rate_hz / n.max(4.0), 0.5 * rate_hz);
    let (mut frequency, mut amplitude) = (Vec::new(), Vec::new());
    for i in 0..FREQUENCIES {
        let f = low * (high / low).powf(i as f64 / (FREQUENCIES - 1) as f64);
        let (mut re, mut im) = (0.0, 0.0);
        for (k, x) in x.iter().enumerate() {
            let window = 1.0 - (2.0 * std::f64::consts::PI * (k as f64 + 0.5) / n).cos();
            let (sine, cosine) = (2.0 * std::f64::consts::PI * f * k as f64 / rate_hz).sin_cos();
            (re, im) = (re + window * x * cosine, im + window * x * sine);
        }
        frequency.push(f);
        amplitude.push(2.0 * re.hypot(im) / n.max(1.0));
    }
    Plot {
        title: format!("Spectrum of the residual, {}", data.nominal.arm.joint_names.of(joint)),
        x_label: "frequency [Hz]".to_owned(),
        y_label: "amplitude [Nm]".to_owned(),
        series: vec![Series { name: "residual".to_owned(), x: frequency, y: amplitude, joined: true }],
    }
}

/// Share of the residual's variance that means over bins of velocity, position, load and time explain, and the share
/// that lies in the tenth of a second after reversals beyond their share of time.
pub(crate) fn goes_with<const N: usize>(
    data: &RegressionData<N>,
    residual: &[f64],
    joint: usize,
) -> [(&'static str, f64); 5] {
    let share = |name: &str| correlation_ratio(&natural_abscissa(data, name, joint), residual);
    let rate_hz = data.chains.first().map_or(1.0, |chain| chain.output_rate_hz());
    let after = ((0.1 * rate_hz).ceil() as usize).max(1);
    let qd = &data.qd[joint];
    let mut since = usize::MAX;
    let (mut near, mut total, mut count) = (0.0, 0.0, 0usize);
    for k in 1..residual.len() {
        since = if qd[k] * qd[k - 1] <= 0.0 { 0 } else { since.saturating_add(1) };
        total += residual[k].powi(2);
        if since < after {
            near += residual[k].powi(2);
            count += 1;
        }
    }
    let time_share = count as f64 / residual.len().max(1) as f64;
    let reversal = if total > 0.0 { (near / total - time_share).max(0.0) } else { 0.0 };
    [
        ("velocity", share("velocity")),
        ("position", share("position")),
        ("load", share("load")),
        ("time", share("time")),
        ("reversal", reversal),
    ]
}

/// η²: variance of the bin means over the whole variance.
fn correlation_ratio(x: &[f64], y: &[f64]) -> f64 {
    let n = y.len().max(1) as f64;
    let mean = y.iter().sum::<f64>() / n;
    let total: f64 = y.iter().map(|y| (y - mean).powi(2)).sum();
    let (low, high) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let width = (high - low) / 20.0;
    if !(width > 0.0 && total > 0.0) {
        return 0.0;
    }
    let mut bins = [(0.0, 0.0); 20];
    for (x, y) in x.iter().zip(y) {
        let bin = &mut bins[(((x - low) / width) as usize).min(19)];
        *bin = (bin.0 + y, bin.1 + 1.0);
    }
    let between: f64 = bins.iter().filter(|bin| bin.1 > 0.0).map(|(s, c)| c * (s / c - mean).powi(2)).sum();
    (between / total).clamp(0.0, 1.0)
}

/// Samples of the cross-joint pattern.
const PATTERN_SAMPLES: usize = 2000;

/// How much of the residual of all joints one constant wrench, one change of gravity, or masses explain.
pub(crate) fn cross_joint_pattern<const N: usize>(
    data: &RegressionData<N>,
    residual: &[Vec<f64>; N],
) -> CrossJointPattern {
    let every = (data.motion.len() / PATTERN_SAMPLES).max(1);
    let thin: Vec<_> = data.samples().step_by(every).collect();
    let sum: f64 = residual.iter().flatten().map(|r| r * r).sum();
    if sum == 0.0 || thin.is_empty() {
        return CrossJointPattern::default();
    }
    // Unfiltered samples: motion is slow against the band, noise averages out.
    let share = |count: usize, block: &dyn Fn(&tribo_regression::Sample<N>) -> DMatrix<f64>| {
        let (mut square, mut score, mut total) = (DMatrix::zeros(count, count), DVector::zeros(count), 0.0);
        for at in &thin {
            let (x, y) = (block(at), DVector::from_fn(N, |j, _| at.measured_nm[j] - at.model_nm[j]));
            square += x.transpose() * &x;
            score += x.transpose() * &y;
            total += y.norm_squared();
        }
        let norms = DVector::from_fn(count, |i, _| square[(i, i)].max(0.0).sqrt());
        (solve_truncated(&square, &score, &norms, 1e-6).explained / total).clamp(0.0, 1.0)
    };
    let axes = [nalgebra::Vector3::x(), nalgebra::Vector3::y(), nalgebra::Vector3::z()];
    let arms = axes.map(|axis| Arm { gravity_m_s2: axis, ..data.nominal.arm.clone() });
    CrossJointPattern {
        wrench: share(6, &|at| {
            let jacobian = data.jacobian(at.q);
            DMatrix::from_fn(N, 6, |j, c| jacobian[(c, j)])
        }),
        gravity: share(3, &|at| {
            let columns = [0, 1, 2].map(|axis| gravity_torque(&arms[axis], at.q));
            DMatrix::from_fn(N, 3, |j, c| columns[c][j])
        }),
        inertial: share(10 * N, &|at| {
            let blocks = inverse_dynamics_regressor(&data.nominal.arm, at.q, at.qd, at.qdd);
            DMatrix::from_fn(N, 10 * N, |j, c| blocks[c / 10][(j, c % 10)])
        }),
    }
}
