//! Cost, parameters and surrogate model over the trials.

use egui::{ComboBox, ProgressBar, RichText, ScrollArea, Ui};
use tribo_figure::number::{fixed, significant};
use tribo_watch::{CampaignSnapshot, campaign_figures, headline, surrogate_figures};

use super::memo::{Memo, address};
use crate::layout::Layout;
use crate::plot::{Look, grid, show};
use crate::source::Source;
use crate::theme::{self, FIGURE_HEIGHT};

/// What the user has chosen.
#[derive(Debug, Default)]
pub struct CampaignView {
    parameter: Option<usize>,
    with_penalty: bool,
    cost: Memo,
    parameters: Memo,
    surrogate: Memo,
}

impl CampaignView {
    /// The view; true if a trial is to be looked at.
    pub fn ui(&mut self, ui: &mut Ui, source: &mut Source, layout: &mut Layout) -> bool {
        let Some(campaign) = source.snapshot().campaign.clone() else {
            super::empty(
                ui,
                "No campaign is open",
                "Start one with “New campaign”, or give the directory of one above.",
            );
            return false;
        };
        self.head(ui, &campaign, source);
        let mut look_at = None;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            let key = (vec![address(Some(&campaign))], vec![usize::from(self.with_penalty)]);
            let with_penalty = self.with_penalty;
            let figures = self.cost.get(key, || {
                vec![campaign_figures::cost_per_trial(&campaign), campaign_figures::cost_parts(&campaign, with_penalty)]
            });
            let look = Look { height: FIGURE_HEIGHT, group: Some("trials"), cursor: None };
            grid(ui, figures, look);
            if campaign.failed().next().is_some() {
                ui.checkbox(&mut self.with_penalty, "with penalty of failed trials");
                failures(ui, &campaign, &mut look_at);
            }
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                ui.label(RichText::new("Parameters").heading());
                ui.add_space(12.0);
                super::joint_row(ui, &mut layout.joint, campaign.tune.space().joints());
            });
            let joint = layout.joint;
            let key = (vec![address(Some(&campaign))], vec![joint]);
            let figures = self.parameters.get(key, || campaign_figures::parameters_of_joint(&campaign, joint));
            grid(ui, figures, Look { height: 195.0, ..look });
            self.surrogate(ui, &campaign, source);
            ui.add_space(8.0);
            ui.label(RichText::new("Trials").heading());
            table(ui, &campaign, &mut look_at);
        });
        if look_at.is_some() {
            source.select(look_at);
        }
        look_at.is_some()
    }

    fn head(&mut self, ui: &mut Ui, campaign: &CampaignSnapshot, source: &mut Source) {
        ui.label(RichText::new(headline(campaign)).heading());
        let facts = campaign.facts().into_iter().map(|(what, value)| format!("{what}: {value}"));
        ui.add(egui::Label::new(RichText::new(facts.collect::<Vec<_>>().join(" · ")).small().weak()).truncate());
        for remark in campaign.remarks() {
            ui.label(RichText::new(remark).small());
        }
        ui.horizontal(|ui| {
            let done = campaign.trials.len();
            let total = if campaign.is_complete() { done } else { campaign.total() };
            let failed = campaign.failed().count();
            let text = if failed > 0 {
                format!("{done} of {total} trials, {failed} failed")
            } else {
                format!("{done} of {total} trials")
            };
            ui.add(ProgressBar::new(done as f32 / total.max(1) as f32).desired_width(260.0).text(text));
            let here = source.runner().is_some_and(|runner| runner.directory == campaign.directory);
            if let Some(runner) = source.runner().filter(|_| here) {
                let paused = runner.is_paused();
                if ui.button(if paused { "Go on" } else { "Pause" }).clicked() {
                    runner.set_paused(!paused);
                }
                if ui.button("Stop").clicked() {
                    runner.stop();
                }
            } else if campaign.trials_by_user() {
                let in_flight = campaign.running.len();
                ui.label(format!("trials run elsewhere (tribo ask, tribo tell); {in_flight} in flight"));
            } else if !campaign.is_complete() && source.runs_elsewhere(ui.input(|input| input.time)) {
                ui.label("running, started outside this window");
            } else if !campaign.is_complete()
                && ui.button("Resume").on_hover_text("Run the remaining trials here").clicked()
            {
                source.resume();
            }
            if ui.button("Write report").on_hover_text("report.html in the campaign's directory").clicked() {
                source.report(ui.ctx());
            }
            if campaign.torn {
                let dark = ui.visuals().dark_mode;
                ui.label(
                    RichText::new(
                        "The journal's last line is incomplete: being written, or torn by a kill. Resume repairs it.",
                    )
                    .small()
                    .color(theme::bad(dark)),
                );
            }
        });
        ui.add_space(4.0);
    }

    fn surrogate(&mut self, ui: &mut Ui, campaign: &CampaignSnapshot, source: &Source) {
        ui.add_space(8.0);
        let surrogate = source.snapshot().surrogate.clone();
        ui.horizontal(|ui| {
            ui.label(RichText::new("Surrogate model").heading());
            let Some(surrogate) = &surrogate else { return };
            ui.add_space(12.0);
            let chosen = self.parameter.unwrap_or_else(|| surrogate_figures::most_relevant(surrogate));
            let name = |k: usize| {
                surrogate.names.get(k).map_or(String::new(), |name| {
                    surrogate_figures::parameter_name(name, campaign.tune.joint_names()).0
                })
            };
            let label = ui.label("along");
            let combo = ComboBox::from_id_salt("parameter of the slice").width(220.0).selected_text(name(chosen));
            let response = combo.show_ui(ui, |ui| {
                for k in 0..surrogate.names.len() {
                    if ui.selectable_label(k == chosen, name(k)).clicked() {
                        self.parameter = Some(k);
                    }
                }
            });
            response.response.labelled_by(label.id);
            ui.add(
                egui::Label::new(
                    RichText::new(format!("Gaussian process on {} trials: {}", surrogate.trials, surrogate.whose))
                        .small()
                        .weak(),
                )
                .truncate(),
            );
        });
        let Some(surrogate) = surrogate else {
            ui.weak("A Gaussian process needs three different parameter vectors.");
            return;
        };
        let chosen = self.parameter.unwrap_or_else(|| surrogate_figures::most_relevant(&surrogate));
        let key = (vec![address(Some(&surrogate)), campaign.trials.len()], vec![chosen]);
        let figures = self.surrogate.get(key, || {
            let mut figures: Vec<_> = surrogate_figures::slice(&surrogate, campaign, chosen).into_iter().collect();
            figures.extend(surrogate_figures::acquisition(&surrogate, campaign, chosen));
            figures.push(surrogate_figures::relevance(&surrogate, campaign));
            figures
        });
        let look = Look { height: 200.0, group: Some("slice"), cursor: None };
        let columns = if ui.available_width() > 1000.0 { 3 } else { 1 };
        ui.columns(columns, |cells| {
            for (k, figure) in figures.iter().enumerate() {
                let group = look.group.filter(|_| figure.x.categories.is_empty());
                show(&mut cells[k % columns], figure, Look { group, ..look });
            }
        });
    }
}

/// Failed trials with their reasons, always in sight.
fn failures(ui: &mut Ui, campaign: &CampaignSnapshot, look_at: &mut Option<usize>) {
    let dark = ui.visuals().dark_mode;
    ui.horizontal_wrapped(|ui| {
        // A trial and its reason stay on one line.
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
        ui.label(RichText::new("Failed:").strong().color(theme::bad(dark)));
        for watched in campaign.failed().take(12) {
            let reason = watched.reason();
            let at = watched.aborted_at_s.map_or(String::new(), |at_s| format!(" at {} s", fixed(at_s, 1)));
            let link = ui.link(format!("trial {}: {reason}{at}", watched.trial.number));
            if link.on_hover_text("Look at this trial; before 0 s the arm runs in").clicked() {
                *look_at = Some(watched.trial.number);
            }
            ui.add_space(8.0);
        }
        let more = campaign.failed().count().saturating_sub(12);
        if more > 0 {
            ui.weak(format!("and {more} more, in the table below"));
        }
    });
}

fn table(ui: &mut Ui, campaign: &CampaignSnapshot, look_at: &mut Option<usize>) {
    let cost = campaign.cost_name();
    let total = format!("J [{}]", cost.unit());
    let header = ["trial", &total].into_iter().chain(cost.part_names()).chain(["chosen by", "state"]);
    let dark = ui.visuals().dark_mode;
    let best = campaign.best().map(|best| best.trial.number);
    ScrollArea::horizontal().id_salt("table of trials").show(ui, |ui| {
        egui::Grid::new("trials").striped(true).min_col_width(64.0).spacing([18.0, 4.0]).show(ui, |ui| {
            for name in header {
                ui.label(RichText::new(name).small().strong());
            }
            ui.end_row();
            // The latest first; a journal of ten thousand trials would not fit a window anyway.
            for watched in campaign.trials.iter().rev().take(200) {
                let trial = &watched.trial;
                let mark = if Some(trial.number) == best { " (best)" } else { "" };
                if ui.link(format!("{}{mark}", trial.number)).on_hover_text("Look at this trial").clicked() {
                    *look_at = Some(trial.number);
                }
                ui.label(significant(trial.cost.total(), 4));
                for (_, part) in trial.cost.parts() {
                    ui.label(significant(part, 3));
                }
                ui.label(trial.origin.to_string());
                let state = RichText::new(watched.state());
                ui.label(if trial.aborted.is_some() { state.color(theme::bad(dark)) } else { state });
                ui.end_row();
            }
        });
    });
}
