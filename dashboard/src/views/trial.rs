//! One trial: wrench, tracking, torques, friction, loop time.

use egui::{RichText, ScrollArea, Ui};
use tribo_figure::number::significant;
use tribo_watch::trial_figures;

use super::memo::{Memo, address};
use crate::layout::Layout;
use crate::plot::{Look, filling_height, grid, show};
use crate::source::Source;
use crate::theme;

const PARTS: [&str; 5] = ["Wrench", "Tracking", "Torques", "Friction", "Loop time"];

/// What the user has chosen.
#[derive(Debug, Default)]
pub struct TrialView {
    figures: Memo,
    cursor: bool,
}

impl TrialView {
    /// The trial before or after the one that is shown.
    pub fn step(&mut self, source: &mut Source, by: i64) {
        let Some(campaign) = source.snapshot().campaign.clone() else { return };
        let numbers: Vec<usize> = campaign.trials.iter().map(|watched| watched.trial.number).collect();
        let wanted = source.wanted();
        let at = numbers.iter().position(|number| Some(*number) == wanted).unwrap_or(0) as i64;
        let next = (at + by).clamp(0, numbers.len() as i64 - 1);
        source.select(numbers.get(next.max(0) as usize).copied());
    }

    /// The view; `cursor_s` is the moment that the arm shows.
    pub fn ui(&mut self, ui: &mut Ui, source: &mut Source, layout: &mut Layout, cursor_s: f64) {
        let Some(trial) = source.snapshot().trial.clone() else {
            let todo = "Open a campaign; its best trial is shown here as soon as one has finished.";
            super::empty(ui, "No trial to show", todo);
            return;
        };
        let dark = ui.visuals().dark_mode;
        let watched = &trial.watched;
        ui.horizontal(|ui| {
            ui.label(RichText::new(format!("Trial {}", watched.trial.number)).heading());
            ui.label(format!("J = {}, chosen by {}", significant(watched.trial.cost.total(), 4), watched.trial.origin));
            let state = RichText::new(watched.state());
            let colour = if watched.trial.aborted.is_some() { theme::bad(dark) } else { theme::good(dark) };
            ui.label(state.color(colour));
            ui.separator();
            if ui.button("Previous").clicked() {
                self.step(source, -1);
            }
            if ui.button("Next").clicked() {
                self.step(source, 1);
            }
            let mut follow = source.follows_best();
            if ui.checkbox(&mut follow, "follow the best").changed() {
                source.select((!follow).then_some(watched.trial.number));
            }
        });
        ui.horizontal(|ui| {
            for (k, part) in PARTS.into_iter().enumerate() {
                ui.selectable_value(&mut layout.trial_part, k, part);
            }
            ui.separator();
            if matches!(layout.trial_part, 2 | 3) {
                super::joint_row(ui, &mut layout.joint, trial.log.joints());
            }
            if layout.trial_part < 3 {
                ui.checkbox(&mut self.cursor, "mark the moment of the arm");
            }
        });
        ui.add_space(4.0);
        let (part, joint) = (layout.trial_part, layout.joint);
        if part == 4 {
            self.loop_time(ui, source);
            return;
        }
        let key = (vec![address(Some(&trial))], vec![part, joint]);
        let figures = self.figures.get(key, || match part {
            0 => trial_figures::wrenches(&trial),
            1 => trial_figures::tracked(&trial),
            2 => vec![trial_figures::torque_terms(&trial, joint)],
            _ => vec![trial_figures::friction(&trial, joint)],
        });
        let height = filling_height(ui, figures.len());
        let group = (part < 3).then_some("time of the trial");
        let look = Look { height, group, cursor: (self.cursor && part < 3).then_some(cursor_s) };
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| grid(ui, figures, look));
    }

    fn loop_time(&mut self, ui: &mut Ui, source: &mut Source) {
        ui.label("The loop of this trial is run once more with a clock around every tick: estimator, controller and limits; the simulated arm is left out. The readings are of this computer and go into no log.");
        if ui.button("Measure here").clicked() {
            source.measure_loop(ui.ctx());
        }
        let Some(times) = source.snapshot().loop_times.clone() else { return };
        let at = |p: f64| times.quantile(p).map_or("–".to_owned(), |us| significant(us, 3));
        ui.label(format!(
            "{} ticks: median {} µs, 99.9 % {} µs, longest {} µs, of {} µs",
            times.tick_us.len(),
            at(0.5),
            at(0.999),
            at(1.0),
            significant(times.period_us, 3)
        ));
        let height = (ui.available_height() - 60.0).clamp(180.0, 520.0);
        show(ui, &trial_figures::loop_time(&times), Look { height, ..Look::default() });
    }
}
