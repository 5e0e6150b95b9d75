//! The arm of a trial as a drawing to scale.

use nalgebra::Vector3;
use tribo_figure::number::{fixed, significant};
use tribo_figure::{Figure, Layer, Scale};

use super::TrialSnapshot;

/// Length of the arrow of a force (m per N).
pub const ARROW_M_PER_N: f64 = 0.02;
/// Length of the two strokes of an arrow's head (m).
const HEAD_M: f64 = 0.03;
/// Colours of the poses: grey for the first, blue for the one that matters.
const POSE_INKS: [usize; 2] = [6, 0];

/// The arm from the side and from above, at the beginning and at the moment of the largest force, with that force on the
/// environment as an arrow at the flange.
pub fn arm(trial: &TrialSnapshot) -> Vec<Figure> {
    let log = &trial.log;
    let force = |row: usize| log.wrench[row].fixed_rows::<3>(3).norm();
    let finite = (0..log.len()).filter(|row| force(*row).is_finite());
    let Some(largest) = finite.max_by(|a, b| force(*a).total_cmp(&force(*b))) else { return Vec::new() };
    let views = [("The arm from the side", [0, 2]), ("The arm from above", [0, 1])];
    views.into_iter().map(|(title, axes)| view(trial, title, axes, [0, largest])).collect()
}

fn view(trial: &TrialSnapshot, title: &str, axes: [usize; 2], rows: [usize; 2]) -> Figure {
    let log = &trial.log;
    let [across, up] = axes.map(|k| Scale::of(["x [m], base axes", "y [m], base axes", "z [m], base axes"][k]));
    let seen = |points: &[Vector3<f64>]| -> (Vec<f64>, Vec<f64>) {
        points.iter().map(|point| (point[axes[0]], point[axes[1]])).unzip()
    };
    let mut figure = Figure::new(title, across, up).to_scale();
    for (row, ink) in rows.into_iter().zip(POSE_INKS) {
        let points = &log.skeleton[row];
        let (x, y) = seen(points);
        let name = format!("at {} s", fixed(log.time_s[row], 1));
        figure.layers.push(Layer::line(&name, ink, x, y));
        if row == rows[1] {
            let at = points.last().copied().unwrap_or_default();
            let force = log.wrench[row].fixed_rows::<3>(3) * ARROW_M_PER_N;
            let (x, y) = arrow(seen(&[at, at + force]));
            let newton = significant(force.norm() / ARROW_M_PER_N, 3);
            let scale = significant(0.1 / ARROW_M_PER_N, 2);
            let name = format!("largest force: {newton} N (10 cm = {scale} N)");
            figure.layers.push(Layer::line(&name, 1, x, y));
        }
    }
    let flange = |points: &Vec<Vector3<f64>>| points.last().copied().unwrap_or_default();
    let (x, y) = seen(&log.skeleton.iter().step_by((log.len() / 400).max(1)).map(flange).collect::<Vec<_>>());
    figure.with(Layer::line("path of the flange", 2, x, y))
}

/// The points of an arrow drawn in one stroke.
fn arrow((x, y): (Vec<f64>, Vec<f64>)) -> (Vec<f64>, Vec<f64>) {
    let (dx, dy) = (x[1] - x[0], y[1] - y[0]);
    let length = dx.hypot(dy).max(1e-9);
    let head = HEAD_M.min(length) / length;
    let barb = |side: f64| (x[1] - head * (dx - 0.5 * side * dy), y[1] - head * (dy + 0.5 * side * dx));
    let ((lx, ly), (rx, ry)) = (barb(1.0), barb(-1.0));
    (vec![x[0], x[1], lx, x[1], rx], vec![y[0], y[1], ly, y[1], ry])
}

#[cfg(test)]
mod tests {
    use nalgebra::SVector;
    use tribo_robot::presets;

    use super::*;
    use crate::skeleton;

    /// At zero angles the Panda stands upright: its flange is 88 mm in front of the base and 926 mm above it.
    #[test]
    fn the_skeleton_ends_at_the_flange() {
        let points = skeleton(&presets::panda(), &SVector::zeros());
        let flange = points.last().copied().unwrap_or_default();
        assert_eq!(points.len(), 9);
        assert!((flange - Vector3::new(0.088, 0.0, 0.926)).norm() < 1e-9, "{flange}");
    }

    #[test]
    fn an_arrow_points_where_it_goes() {
        let (x, y) = arrow((vec![0.0, 0.0], vec![0.0, 0.1]));
        assert_eq!((x[1], y[1]), (0.0, 0.1));
        assert!(x[2] > 0.0 && x[4] < 0.0 && (y[2] - 0.07).abs() < 1e-12 && (y[4] - 0.07).abs() < 1e-12, "{x:?} {y:?}");
    }
}
