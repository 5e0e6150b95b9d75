//! The pictures of a diagnosis as figures.

use tribo_figure::{Figure, Layer, Scale};
use tribo_robot::JointNames;

use crate::{Diagnosis, JointMisfit, NextExperiment, Plot};

/// Joints whose angle changes by more than this are drawn (rad).
const MOVES_RAD: f64 = 1e-3;
/// Colour of the sensor's noise: grey.
const NOISE_INK: usize = 6;

impl From<&Plot> for Figure {
    /// Clouds first: a curve explains the cloud behind it.
    fn from(plot: &Plot) -> Self {
        let y = Scale::of(&plot.y_label);
        let curves_only = !plot.series.is_empty() && plot.series.iter().all(|series| series.joined);
        let y = if curves_only { y.or_logarithmic() } else { y };
        let mut figure = Self::new(plot.title.clone(), Scale::of(&plot.x_label), y);
        for joined in [false, true] {
            for (k, series) in plot.series.iter().enumerate().filter(|(_, series)| series.joined == joined) {
                let (x, y) = (series.x.clone(), series.y.clone());
                figure.layers.push(match (joined, k >= 4) {
                    (false, _) => Layer::cloud(&series.name, k, x, y),
                    (true, false) => Layer::line(&series.name, k, x, y),
                    (true, true) => Layer::dashed(&series.name, k, x, y),
                });
            }
        }
        figure
    }
}

/// Residual of each joint on blocks that the fit has not seen, before and after, beside the sensor's noise.
pub fn held_out_bars(diagnosis: &Diagnosis) -> Figure {
    let joints = &diagnosis.joints;
    let column = |pick: fn(&JointMisfit) -> f64| joints.iter().map(pick).collect::<Vec<f64>>();
    // Names do not fit below the bars; the table beneath has them.
    let numbers = (0..joints.len()).map(|joint| joint.to_string()).collect();
    let at = |shift: f64| (0..joints.len()).map(|joint| joint as f64 + shift).collect::<Vec<f64>>();
    let (noise_x, noise_y) = joints
        .iter()
        .enumerate()
        .flat_map(|(k, joint)| {
            let (at, noise) = (k as f64, joint.noise_floor_nm);
            [(at - 0.42, noise), (at + 0.42, noise), (at + 0.42, f64::NAN)]
        })
        .unzip();
    Figure::new(
        "Residual on blocks that the fit has not seen",
        Scale::categories("joint", numbers),
        Scale::of("residual RMS [Nm]"),
    )
    .with(Layer::bars("before", 0, at(-0.18), column(|joint| joint.held_out_nm[0]), 0.34))
    .with(Layer::bars("with the findings", 1, at(0.18), column(|joint| joint.held_out_nm[1]), 0.34))
    .with(Layer::line("noise of the torque sensor", NOISE_INK, noise_x, noise_y))
}

/// The via points of the joints that move; none where none does.
pub fn via_points(next: &NextExperiment, names: &JointNames) -> Option<Figure> {
    let joints = next.via_points.iter().map(|(_, q)| q.len()).min().unwrap_or(0);
    let angle = |j: usize| next.via_points.iter().map(move |(_, q)| q[j]);
    let moves =
        |j: &usize| angle(*j).fold(f64::NEG_INFINITY, f64::max) - angle(*j).fold(f64::INFINITY, f64::min) > MOVES_RAD;
    let mut figure = Figure::new(
        format!("Via points of {}, joints that move", next.motion),
        Scale::of("time [s]"),
        Scale::of("joint angle [rad]"),
    );
    for j in (0..joints).filter(moves) {
        let time_s = next.via_points.iter().map(|(time_s, _)| *time_s).collect();
        let (name, angles) = (names.of(j).to_string(), angle(j).collect());
        figure.layers.push(if j < 4 {
            Layer::line(&name, j, time_s, angles)
        } else {
            Layer::dashed(&name, j, time_s, angles)
        });
    }
    (!figure.layers.is_empty()).then_some(figure)
}
