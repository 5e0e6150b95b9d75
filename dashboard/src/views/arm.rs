//! The arm as capsules, following a trial or a log, with the wrench as an arrow.

use egui::{Color32, Pos2, Rect, RichText, Sense, Shape, Stroke, Ui, pos2, vec2};
use nalgebra::Vector3;
use tribo_figure::number::{fixed, significant};
use tribo_trial::EstimatorName;
use tribo_watch::arm_figures::ARROW_M_PER_N;

use crate::live_snapshot::LiveSnapshot;
use crate::snapshot::Snapshot;
use crate::theme::ink;

/// Length of a Panda along its links (m); longer arms are drawn from further away.
const PANDA_LENGTH_M: f64 = 1.33;
/// Radii of the capsules from link to link (m): base to flange.
const RADII_M: [f64; 8] = [0.075, 0.07, 0.065, 0.06, 0.055, 0.05, 0.045, 0.04];

/// The camera and the moment.
#[derive(Debug)]
pub struct ArmView {
    /// The moment that is shown, in the time of trial or log (s).
    pub cursor_s: f64,
    /// Whether time runs.
    pub playing: bool,
    speed: f64,
    yaw: f64,
    pitch: f64,
    zoom: f64,
    last_frame_s: Option<f64>,
}

impl Default for ArmView {
    fn default() -> Self {
        Self { cursor_s: 0.0, playing: false, speed: 1.0, yaw: -0.9, pitch: 0.35, zoom: 1.0, last_frame_s: None }
    }
}

/// What is drawn at one moment.
struct Moment {
    /// Joint positions (rad).
    q: Vec<f64>,
    /// Base, origins of the link frames, flange (m), base axes.
    points: Vec<Vector3<f64>>,
    /// Force then moment, by the robot on the environment, base axes.
    wrench: Option<[f64; 6]>,
}

/// A motion: its time span, and its moments.
struct Motion<'a> {
    name: String,
    span_s: [f64; 2],
    at: Box<dyn Fn(f64) -> Option<Moment> + 'a>,
    /// Origins of the flange (m), base axes.
    path: Vec<Vector3<f64>>,
}

/// Points of the path that is drawn.
const PATH_POINTS: usize = 200;

fn motion(snapshot: &Snapshot, estimator: EstimatorName) -> Option<Motion<'_>> {
    if let Some(trial) = &snapshot.trial {
        let log = &trial.log;
        let span_s = [*log.time_s.first()?, *log.time_s.last()?];
        let at = move |time_s: f64| {
            let row = trial.row_at(time_s);
            let h = log.wrench.get(row)?;
            let (q, points) = (log.q.iter().map(|q| q[row]).collect(), log.skeleton.get(row)?.clone());
            Some(Moment { q, points, wrench: Some([h[3], h[4], h[5], h[0], h[1], h[2]]) })
        };
        let flange = |points: &Vec<Vector3<f64>>| points.last().copied().unwrap_or_default();
        let path = log.skeleton.iter().step_by((log.len() / PATH_POINTS).max(1)).map(flange).collect();
        let name = format!("{}, trial {}", trial.tune.robot(), trial.watched.trial.number);
        return Some(Motion { name, span_s, at: Box::new(at), path });
    }
    let log = snapshot.log.as_ref()?;
    let at = move |time_s: f64| {
        let row = log.log.time_s.partition_point(|t| *t < time_s).min(log.log.rows() - 1);
        let wrench = snapshot.wrench(estimator).and_then(|wrench| wrench.as_ref().ok()?.at(row));
        Some(Moment { q: log.log.q_rad.iter().map(|q| q[row]).collect(), points: log.skeleton(row), wrench })
    };
    let rows = (0..log.log.rows()).step_by((log.log.rows() / PATH_POINTS).max(1));
    let path = rows.map(|row| log.skeleton(row).last().copied().unwrap_or_default()).collect();
    let name = format!("{}, log", log.model.robot());
    Some(Motion { name, span_s: log.signals.span_s(), at: Box::new(at), path })
}

impl ArmView {
    /// The view; the wrench along a log is that of `estimator`; `now_s` is the time of the frame (s).
    pub fn ui(&mut self, ui: &mut Ui, snapshot: &Snapshot, estimator: EstimatorName, now_s: f64) {
        let Some(motion) = motion(snapshot, estimator) else {
            super::empty(
                ui,
                "Nothing moves",
                "Open a campaign or a log; the arm follows the trial that is chosen in the view Trial.",
            );
            return;
        };
        let [first_s, last_s] = motion.span_s;
        let passed_s = self.last_frame_s.map_or(0.0, |last| now_s - last);
        self.last_frame_s = Some(now_s);
        if self.playing {
            self.cursor_s += self.speed * passed_s;
            if self.cursor_s > last_s {
                self.cursor_s = first_s;
            }
            ui.ctx().request_repaint();
        }
        self.cursor_s = self.cursor_s.clamp(first_s, last_s);
        self.controls(ui, &motion);
        let Some(moment) = (motion.at)(self.cursor_s) else { return };
        Self::figures(ui, &moment);
        self.scene(ui, &motion.path, &moment);
    }

    /// The newest moment of a robot that lives.
    pub(super) fn live(&mut self, ui: &mut Ui, live: &LiveSnapshot) {
        let Some(newest) = &live.newest else { return };
        let moment = Moment { q: newest.q_rad.clone(), points: live.skeleton.clone(), wrench: newest.wrench };
        Self::figures(ui, &moment);
        self.scene(ui, &[], &moment);
    }

    fn controls(&mut self, ui: &mut Ui, motion: &Motion<'_>) {
        ui.horizontal(|ui| {
            ui.label(RichText::new(&motion.name).heading());
            if ui.button(if self.playing { "Pause" } else { "Play" }).on_hover_text("Space").clicked() {
                self.playing = !self.playing;
            }
            for (speed, name) in [(0.25, "¼"), (1.0, "1"), (4.0, "4")] {
                ui.selectable_value(&mut self.speed, speed, format!("{name}×"));
            }
            let label = ui.label("time [s]");
            ui.spacing_mut().slider_width = (ui.available_width() - 230.0).max(120.0);
            let slider = egui::Slider::new(&mut self.cursor_s, motion.span_s[0]..=motion.span_s[1]).fixed_decimals(2);
            ui.add(slider).labelled_by(label.id);
            if ui.button("Reset view").clicked() {
                (self.yaw, self.pitch, self.zoom) = (-0.9, 0.35, 1.0);
            }
        });
    }

    fn figures(ui: &mut Ui, moment: &Moment) {
        let q: Vec<String> = moment.q.iter().map(|q| fixed(*q, 3)).collect();
        ui.label(format!("q [rad]: {}", q.join(", ")));
        if let Some(h) = moment.wrench {
            let part = |k: usize| h[k..k + 3].iter().map(|h| significant(*h, 3)).collect::<Vec<_>>().join(", ");
            let size = |k: usize| significant(h[k..k + 3].iter().map(|h| h * h).sum::<f64>().sqrt(), 3);
            ui.label(format!(
                "force [N], base axes: {} (|F| = {}); moment [Nm]: {} (|M| = {})",
                part(0),
                size(0),
                part(3),
                size(3)
            ));
        } else {
            ui.weak("no wrench at this moment: the estimator is settling");
        }
    }

    fn scene(&mut self, ui: &mut Ui, path: &[Vector3<f64>], moment: &Moment) {
        let size = ui.available_size().max(vec2(200.0, 200.0));
        let (response, painter) = ui.allocate_painter(size, Sense::click_and_drag());
        let drag = response.drag_delta();
        self.yaw -= f64::from(drag.x) * 0.008;
        self.pitch = (self.pitch + f64::from(drag.y) * 0.008).clamp(-1.5, 1.5);
        if response.hovered() {
            self.zoom = (self.zoom * f64::from(ui.input(|input| input.zoom_delta()))).clamp(0.3, 5.0);
        }
        let response = response.on_hover_text_at_pointer("Drag to turn, Ctrl + wheel to zoom");
        let dark = ui.visuals().dark_mode;
        let points = &moment.points;
        let length_m: f64 = points.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum();
        let size = (length_m / PANDA_LENGTH_M).max(1.0);
        let camera = Camera::new(response.rect, self.yaw, self.pitch, self.zoom, size);
        ground(&painter, &camera, ui.visuals().widgets.noninteractive.bg_stroke.color);

        // The links, back to front, then the path of the flange.
        let Some((flange, joints)) = points.split_last().map(|(flange, rest)| (*flange, &rest[1..])) else { return };
        let mut capsules: Vec<(f64, usize)> = (0..points.len() - 1)
            .filter(|k| (points[k + 1] - points[*k]).norm() > 1e-6)
            .map(|k| (camera.project(&((points[k] + points[k + 1]) * 0.5)).1, k))
            .collect();
        capsules.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, k) in capsules {
            let radius_m = size * RADII_M[k.min(RADII_M.len() - 1)];
            capsule(&painter, &camera, [&points[k], &points[k + 1]], radius_m, dark);
        }
        let seen = |point: &Vector3<f64>| camera.project(point).0;
        painter.add(Shape::line(path.iter().map(seen).collect(), Stroke::new(1.2, ink(2, dark))));
        for origin in joints {
            let (centre, _) = camera.project(origin);
            painter.circle_filled(centre, 3.0, if dark { Color32::WHITE } else { Color32::BLACK });
        }
        frame_axes(&painter, &camera, dark);
        if let Some(h) = moment.wrench {
            let tip = flange + Vector3::new(h[0], h[1], h[2]) * ARROW_M_PER_N;
            let (from, to) = (camera.project(&flange).0, camera.project(&tip).0);
            painter.arrow(from, to - from, Stroke::new(3.0, ink(1, dark)));
            let corner = response.rect.left_bottom() + vec2(12.0, -24.0);
            let text = format!(
                "arrow: force on the environment, 10 cm = {} N{}",
                significant(0.1 / ARROW_M_PER_N, 2),
                if path.is_empty() { "" } else { " · green: path of the flange" }
            );
            painter.text(
                corner,
                egui::Align2::LEFT_CENTER,
                text,
                egui::FontId::proportional(12.0),
                ui.visuals().weak_text_color(),
            );
        }
    }
}

/// Parallel projection: no part of the arm hides by being far.
struct Camera {
    centre: Pos2,
    /// Point that is looked at, in base axes (m).
    target_m: Vector3<f64>,
    scale: f64,
    right: Vector3<f64>,
    up: Vector3<f64>,
    forward: Vector3<f64>,
}

impl Camera {
    /// Middle of what is looked at of an arm as long as a Panda, in base axes (m).
    const TARGET_M: [f64; 3] = [0.25, 0.0, 0.4];

    fn new(rect: Rect, yaw: f64, pitch: f64, zoom: f64, size: f64) -> Self {
        let forward = Vector3::new(pitch.cos() * yaw.cos(), pitch.cos() * yaw.sin(), -pitch.sin());
        let right = Vector3::new(yaw.sin(), -yaw.cos(), 0.0);
        let up = right.cross(&forward);
        let scale = zoom * f64::from(rect.height().min(rect.width() * 0.8)) / (1.05 * size);
        let target_m = Vector3::from(Self::TARGET_M) * size;
        Self { centre: rect.center(), target_m, scale, right, up, forward }
    }

    /// Place on the screen, and depth (m).
    fn project(&self, point: &Vector3<f64>) -> (Pos2, f64) {
        let from_target = point - self.target_m;
        let (x, y) = (self.right.dot(&from_target) * self.scale, self.up.dot(&from_target) * self.scale);
        (pos2(self.centre.x + x as f32, self.centre.y - y as f32), self.forward.dot(&from_target))
    }
}

/// A grid on the floor, 20 cm wide.
fn ground(painter: &egui::Painter, camera: &Camera, colour: Color32) {
    for k in -3..=5 {
        let at = 0.2 * f64::from(k);
        for (from, to) in [
            (Vector3::new(at, -0.6, 0.0), Vector3::new(at, 0.6, 0.0)),
            (Vector3::new(-0.6, at - 0.2, 0.0), Vector3::new(1.0, at - 0.2, 0.0)),
        ] {
            painter.line_segment([camera.project(&from).0, camera.project(&to).0], Stroke::new(1.0, colour));
        }
    }
}

/// The axes of the base, with their names.
fn frame_axes(painter: &egui::Painter, camera: &Camera, dark: bool) {
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        let mut tip = Vector3::zeros();
        tip[k] = 0.25;
        let (from, to) = (camera.project(&Vector3::zeros()).0, camera.project(&tip).0);
        let colour = ink([1, 2, 0][k], dark);
        painter.arrow(from, to - from, Stroke::new(2.0, colour));
        painter.text(
            to + (to - from) * 0.08,
            egui::Align2::CENTER_CENTER,
            name,
            egui::FontId::proportional(13.0),
            colour,
        );
    }
}

/// A link: a thick line with round ends and an outline.
fn capsule(painter: &egui::Painter, camera: &Camera, ends: [&Vector3<f64>; 2], radius_m: f64, dark: bool) {
    let [from, to] = ends.map(|end| camera.project(end).0);
    let radius = (radius_m * camera.scale) as f32;
    let (body, edge) = if dark {
        (Color32::from_rgb(0x4a, 0x53, 0x5e), Color32::from_rgb(0x86, 0x90, 0x9b))
    } else {
        (Color32::from_rgb(0xe3, 0xe7, 0xec), Color32::from_rgb(0x8a, 0x93, 0x9c))
    };
    for (grow, colour) in [(1.5, edge), (0.0, body)] {
        painter.line_segment([from, to], Stroke::new(2.0 * (radius + grow), colour));
        painter.circle_filled(from, radius + grow, colour);
        painter.circle_filled(to, radius + grow, colour);
    }
}
