//! The estimators on one log side by side, each with its confidence.

use std::sync::Arc;

use egui::{Grid, RichText, ScrollArea, Ui};
use tribo_figure::number::significant;
use tribo_trial::EstimatorName;

use super::log::components;
use crate::log_snapshot::LogSnapshot;
use crate::source::Source;
use crate::theme::{self, ink};
use crate::wrench_snapshot::{WrenchSnapshot, lacks};

/// What the user has chosen.
#[derive(Debug)]
pub struct CompareEstimators {
    chosen: [bool; EstimatorName::ALL.len()],
}

/// All of them: whoever compares wants to see what there is.
impl Default for CompareEstimators {
    fn default() -> Self {
        Self { chosen: [true; EstimatorName::ALL.len()] }
    }
}

impl CompareEstimators {
    /// The view.
    pub fn ui(&mut self, ui: &mut Ui, source: &mut Source, log: &LogSnapshot) {
        let dark = ui.visuals().dark_mode;
        ui.label(RichText::new("Estimators side by side").heading());
        ui.weak(format!("{}; bands are 95 % intervals", log.source.path.display()));
        ui.horizontal_wrapped(|ui| {
            for (k, name) in EstimatorName::ALL.into_iter().enumerate() {
                let why = lacks(log, name);
                self.chosen[k] &= why.is_none();
                let text = RichText::new(super::estimator_name(name)).color(ink(k, dark));
                let check = ui.add_enabled(why.is_none(), egui::Checkbox::new(&mut self.chosen[k], text));
                check.on_hover_text(super::estimator_law(name)).on_disabled_hover_text(why.unwrap_or_default());
            }
        });
        let mut shown: Vec<Arc<WrenchSnapshot>> = Vec::new();
        for (name, _) in EstimatorName::ALL.into_iter().zip(self.chosen).filter(|(_, chosen)| *chosen) {
            source.estimate(ui.ctx(), name);
            match source.snapshot().wrench(name) {
                Some(Ok(wrench)) => shown.push(Arc::clone(wrench)),
                Some(Err(why)) => {
                    ui.label(RichText::new(format!("{}: {why}", name.as_str())).color(theme::bad(dark)));
                }
                None => drop(ui.weak(format!("{}: running along the log", super::estimator_name(name)))),
            }
        }
        if shown.is_empty() {
            return;
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            figures(ui, &shown);
            ui.add_space(6.0);
            components(ui, log, &shown.iter().collect::<Vec<_>>());
        });
    }
}

/// One row per estimator; errors only where the log knows the wrench.
fn figures(ui: &mut Ui, shown: &[Arc<WrenchSnapshot>]) {
    let compared = shown.iter().any(|wrench| wrench.summary.against_reference.is_some());
    let mut header = vec!["estimator", "± force [N]", "± moment [Nm]"];
    if compared {
        header.extend(["RMSE force [N]", "RMSE moment [Nm]", "inside 95 % [%]", "delay [ms]"]);
    } else {
        header.extend(["RMS force [N]", "RMS moment [Nm]"]);
    }
    header.extend(["mean NIS (6)", "unusable samples"]);
    ScrollArea::horizontal().id_salt("figures of the estimators").show(ui, |ui| {
        Grid::new("estimators").striped(true).spacing([20.0, 4.0]).show(ui, |ui| {
            for name in header {
                ui.label(RichText::new(name).small().strong());
            }
            ui.end_row();
            for wrench in shown {
                let summary = &wrench.summary;
                let rms = |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
                let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
                ui.label(super::estimator_name(wrench.estimator));
                ui.label(significant(mean(&summary.half_width95[..3]), 3));
                ui.label(significant(mean(&summary.half_width95[3..]), 3));
                if let Some(errors) = summary.against_reference {
                    ui.label(significant(errors.rmse_force_n, 3));
                    ui.label(significant(errors.rmse_moment_nm, 3));
                    ui.label(format!("{:.1}", 100.0 * mean(&errors.coverage95)));
                    ui.label(errors.delay_s.map_or("–".to_owned(), |delay_s| format!("{:.0}", 1e3 * delay_s)));
                } else {
                    ui.label(significant(rms(&summary.rms[..3]), 3));
                    ui.label(significant(rms(&summary.rms[3..]), 3));
                }
                ui.label(summary.mean_nis.map_or("–".to_owned(), |nis| significant(nis, 3)));
                ui.label(summary.faults.to_string());
                ui.end_row();
            }
        });
    });
}
