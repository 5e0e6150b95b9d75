//! Figures of one trial.

use nalgebra::{SVector, Vector6};
use tribo_figure::{Figure, Layer, Scale};

use super::{LoopTimes, TrialSnapshot};

/// Axes of a wrench in file order, with their place in `[moment; force]`.
pub const WRENCH_AXES: [(&str, usize); 6] = [
    ("force x [N]", 3),
    ("force y [N]", 4),
    ("force z [N]", 5),
    ("moment x [Nm]", 0),
    ("moment y [Nm]", 1),
    ("moment z [Nm]", 2),
];

/// 97.5 % quantile of the standard normal.
const Z95: f64 = 1.96;
/// Grey: what something is compared with.
const GREY: usize = 6;

fn time_axis() -> Scale {
    Scale::of("time in the judged part [s]")
}

fn column<const R: usize>(rows: &[SVector<f64, R>], place: usize, factor: f64) -> Vec<f64> {
    rows.iter().map(|row| factor * row[place]).collect()
}

/// One component of the estimated wrench with its 95 % band, over what it is without compensation.
pub fn wrench(trial: &TrialSnapshot, component: usize) -> Figure {
    let (axis, place) = WRENCH_AXES[component.min(5)];
    let log = &trial.log;
    let title = format!("Wrench on the environment, {}", axis.split(" [").next().unwrap_or(axis));
    let mut figure = Figure::new(title, time_axis(), Scale::of(&format!("{axis}, base axes")));
    if let Some(without) = &trial.uncompensated {
        let values = column(&without.wrench, place, 1.0);
        figure.layers.push(Layer::line("no compensation", GREY, without.time_s.clone(), values));
    }
    let end = |sign: f64| {
        let pairs = log.wrench.iter().zip(&log.wrench_sd);
        pairs.map(|(h, sd): (&Vector6<f64>, &Vector6<f64>)| h[place] + sign * Z95 * sd[place]).collect::<Vec<f64>>()
    };
    figure.with(Layer::band("95 %", 0, log.time_s.clone(), end(-1.0), end(1.0))).with(Layer::line(
        "estimate",
        0,
        log.time_s.clone(),
        column(&log.wrench, place, 1.0),
    ))
}

/// Names of the directions of space.
const XYZ: [&str; 3] = ["x", "y", "z"];

/// Path of the flange beside its reference.
pub fn tracking(trial: &TrialSnapshot) -> Figure {
    let log = &trial.log;
    let mut figure =
        Figure::new("Position of the flange", time_axis(), Scale::of("position from the start [mm], base axes"));
    let first = log.reference_position.first().copied().unwrap_or_default();
    for (k, axis) in XYZ.into_iter().enumerate() {
        let wanted: Vec<f64> = log.reference_position.iter().map(|p| 1e3 * (p[k] - first[k])).collect();
        let is = wanted.iter().zip(&log.error).map(|(wanted, error)| wanted + 1e3 * error[3 + k]).collect();
        figure.layers.push(Layer::dashed(&format!("{axis} reference"), k, log.time_s.clone(), wanted));
        figure.layers.push(Layer::line(axis, k, log.time_s.clone(), is));
    }
    figure
}

/// Error of the position (mm) or of the orientation (mrad).
pub fn error(trial: &TrialSnapshot, rotation: bool) -> Figure {
    let (title, label, first) = match rotation {
        false => ("Position error", "position error [mm], base axes", 3),
        true => ("Orientation error", "orientation error [mrad], base axes", 0),
    };
    let mut figure = Figure::new(title, time_axis(), Scale::of(label));
    for (k, axis) in XYZ.into_iter().enumerate() {
        let values = column(&trial.log.error, first + k, 1e3);
        figure.layers.push(Layer::line(axis, k, trial.log.time_s.clone(), values));
    }
    figure
}

/// The terms of one joint's motor torque.
pub fn torque_terms(trial: &TrialSnapshot, joint: usize) -> Figure {
    let log = &trial.log;
    let terms = [
        ("command", 6, &log.tau_command),
        ("gravity", 0, &log.tau_gravity),
        ("task", 2, &log.tau_task),
        ("Coriolis", 3, &log.tau_coriolis),
        ("null space", 4, &log.tau_nullspace),
        ("friction", 1, &log.tau_friction),
    ];
    let named = trial.tune.joint_names().of(joint);
    let label = format!("motor torque, {named} [Nm]");
    let mut figure = Figure::new(format!("Torque by term, {named}"), time_axis(), Scale::of(&label));
    for (name, ink, rows) in terms {
        figure.layers.push(Layer::line(name, ink, log.time_s.clone(), rows[joint].clone()));
    }
    figure
}

/// Friction of one joint against velocity: what the rigid-body model leaves unexplained, and the compensator's law.
pub fn friction(trial: &TrialSnapshot, joint: usize) -> Figure {
    /// Points of the curve.
    const POINTS: usize = 201;
    let named = trial.tune.joint_names().of(joint);
    let (qd, seen) = (trial.log.qd[joint].clone(), trial.log.friction_torque[joint].clone());
    let fastest = qd.iter().fold(1e-3_f64, |most, v| most.max(v.abs()));
    let v: Vec<f64> = (0..POINTS).map(|k| fastest * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0)).collect();
    let law = v.iter().map(|v| trial.friction[joint].torque(*v, 1e-3)).collect();
    Figure::new(
        format!("Friction, {named}"),
        Scale::of(&format!("velocity of {named} [rad/s]")),
        Scale::of(&format!("friction torque, {named} [Nm]")),
    )
    .with(Layer::cloud("command − rigid-body model", GREY, qd, seen))
    .with(Layer::line("compensator's law", 1, v, law))
}

/// How often the loop took how long, in bins of equal width up to the 99.9 % quantile, at most five medians; slower ticks
/// are in the last bin.
pub fn loop_time(times: &LoopTimes) -> Figure {
    const BINS: usize = 60;
    let label = "time of a tick on this computer [µs]";
    let figure =
        Figure::new("Loop time: estimator, controller, limits", Scale::of(label), Scale::of("part of the ticks [%]"));
    let [least, median, most] = [0.0, 0.5, 0.999].map(|p| times.quantile(p).unwrap_or(0.0));
    if times.tick_us.is_empty() {
        return figure;
    }
    let most = most.min(5.0 * median);
    let width = ((most - least) / BINS as f64).max(1e-3);
    let mut bins = vec![0.0; BINS];
    for tick_us in &times.tick_us {
        bins[(((tick_us - least) / width) as usize).min(BINS - 1)] += 100.0 / times.tick_us.len() as f64;
    }
    let middles = (0..BINS).map(|k| least + (k as f64 + 0.5) * width).collect();
    figure.with(Layer::bars("", 0, middles, bins, width))
}

/// All six components of the wrench.
pub fn wrenches(trial: &TrialSnapshot) -> Vec<Figure> {
    (0..6).map(|component| wrench(trial, component)).collect()
}

/// Position and errors of the flange.
pub fn tracked(trial: &TrialSnapshot) -> Vec<Figure> {
    vec![tracking(trial), error(trial, false), error(trial, true)]
}
