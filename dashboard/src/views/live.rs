//! A robot that lives: arm, wrench, torques, loop times.

use egui::{RichText, ScrollArea, Ui};
use tribo_figure::number::significant;

use super::arm::ArmView;
use super::signal_plot::{Curve, cells, signal_plot};
use super::{channels, empty};
use crate::live_snapshot::LiveSnapshot;
use crate::snapshot::Snapshot;
use crate::theme;

/// Part of the width that the arm takes.
const ARM_PART: f32 = 0.34;
/// Grey: what something is compared with.
const GREY: usize = 6;

/// What is beside the arm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Part {
    #[default]
    Wrench,
    Joints,
    LoopTimes,
}

/// What the user has chosen.
#[derive(Debug, Default)]
pub struct LiveView {
    part: Part,
    arm: ArmView,
    /// Whether the picture stands still while the robot goes on.
    pub held: bool,
}

impl LiveView {
    /// The view.
    pub fn ui(&mut self, ui: &mut Ui, snapshot: &Snapshot) {
        let Some(live) = snapshot.live.clone() else {
            empty(
                ui,
                "No robot is watched",
                "Start with: tribo dashboard --live HOST, the address of a Panda or an FR3.",
            );
            return;
        };
        head(ui, &live);
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.part, Part::Wrench, "Wrench");
            ui.selectable_value(&mut self.part, Part::Joints, "Joints");
            ui.selectable_value(&mut self.part, Part::LoopTimes, "Loop times");
            ui.separator();
            let hold = ui.selectable_label(self.held, "Hold").on_hover_text("Stands still; the robot goes on");
            self.held ^= hold.clicked();
        });
        if live.newest.is_none() {
            empty(ui, "Nothing has come yet", "The robot sends a state each millisecond once it is on.");
            return;
        }
        let height = ui.available_height();
        let arm_width = ui.available_width() * ARM_PART;
        ui.horizontal_top(|ui| {
            ui.allocate_ui(egui::vec2(arm_width, height), |ui| {
                ui.vertical(|ui| self.arm.live(ui, &live));
            });
            ui.vertical(|ui| {
                let scroll = ScrollArea::vertical().id_salt("live").auto_shrink(false);
                scroll.show(ui, |ui| match self.part {
                    Part::Wrench => wrench(ui, &live),
                    Part::Joints => channels(ui, &live.joints),
                    Part::LoopTimes => loop_times(ui, &live),
                });
            });
        });
    }
}

fn head(ui: &mut Ui, live: &LiveSnapshot) {
    let dark = ui.visuals().dark_mode;
    ui.label(RichText::new(format!("{} at {}", live.title.robot, live.title.host)).heading());
    ui.horizontal(|ui| {
        let status = if live.status.is_empty() { "connected" } else { &live.status };
        ui.label(format!("{status}; {} states, {} lost; estimator: {}", live.heard, live.lost, live.title.estimator));
        if let Some(why) = &live.ended {
            ui.label(RichText::new(format!("no more states come: {why}")).color(theme::bad(dark)));
        }
    });
}

/// The six components with their band, beside what the robot says.
fn wrench(ui: &mut Ui, live: &LiveSnapshot) {
    let all = live.wrench.channels();
    let labels: Vec<&str> = all.iter().step_by(4).map(|channel| channel.quantity.as_str()).collect();
    cells(ui, labels.len(), |ui, k, height| {
        let of = |channel: usize| (&live.wrench, 4 * k + channel);
        let ours = Curve { name: &live.title.estimator, ink: 0, of: of(0), band: Some((4 * k + 1, 4 * k + 2)) };
        let own = Curve { name: "the robot's own", ink: GREY, of: of(3), band: None };
        signal_plot(ui, labels[k], &[own, ours], height);
    });
}

fn loop_times(ui: &mut Ui, live: &LiveSnapshot) {
    for (channel, signal) in live.loop_times.channels().iter().enumerate() {
        if let Some([half, most, longest]) = live.quantiles(channel) {
            let [half, most, longest] = [half, most, longest].map(|time| significant(time, 3));
            ui.label(format!("{}: 50 % {half}, 99.9 % {most}, longest {longest}", signal.quantity));
        }
    }
    channels(ui, &live.loop_times);
}
