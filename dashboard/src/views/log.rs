//! Channels and wrench of a log, of any length.

use egui::{RichText, ScrollArea, Ui};
use tribo_figure::Signals;
use tribo_figure::number::significant;
use tribo_trial::EstimatorName;

use super::signal_plot::{Curve, cells, signal_plot};
use crate::layout::Layout;
use crate::log_snapshot::LogSnapshot;
use crate::source::Source;
use crate::theme;
use crate::wrench_snapshot::{WrenchSnapshot, lacks};

/// What the user has chosen.
#[derive(Debug, Default)]
pub struct LogView {
    channels: bool,
}

impl LogView {
    /// The view.
    pub fn ui(&mut self, ui: &mut Ui, source: &mut Source, layout: &mut Layout) {
        let Some(log) = source.snapshot().log.clone() else {
            let todo = "Give a robot log above: canonical CSV (.gz), Parquet or a public data set; or start with: tribo dashboard LOG.";
            super::empty(ui, "No log is open", todo);
            return;
        };
        head(ui, &log);
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.channels, false, "Wrench");
            ui.selectable_value(&mut self.channels, true, "Channels");
            if !self.channels {
                ui.separator();
                estimators(ui, &log, &mut layout.estimator);
            }
        });
        if self.channels {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| channels(ui, &log.signals));
            return;
        }
        source.estimate(ui.ctx(), layout.estimator);
        match source.snapshot().wrench(layout.estimator) {
            Some(Ok(wrench)) => {
                ui.label(told(wrench));
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| components(ui, &log, &[wrench]));
            }
            Some(Err(why)) => drop(ui.label(RichText::new(why).color(theme::bad(ui.visuals().dark_mode)))),
            None => super::empty(ui, "Estimating the wrench", "The estimator runs along the whole log."),
        }
    }
}

fn head(ui: &mut Ui, log: &LogSnapshot) {
    let [first, last] = log.signals.span_s();
    ui.label(RichText::new(log.source.path.display().to_string()).heading());
    let model = log.model_name();
    ui.label(format!(
        "{} samples over {} s, {} channels; model: {model}",
        log.log.rows(),
        significant(last - first, 4),
        log.signals.channels().len(),
    ));
}

/// A row to choose an estimator from; what cannot work on this log says why.
fn estimators(ui: &mut Ui, log: &LogSnapshot, chosen: &mut EstimatorName) {
    ui.label("Estimator");
    for name in EstimatorName::ALL {
        let why = lacks(log, name);
        let button = egui::Button::selectable(*chosen == name, super::estimator_name(name));
        let button = ui.add_enabled(why.is_none(), button).on_disabled_hover_text(why.unwrap_or_default());
        if button.on_hover_text(super::estimator_law(name)).clicked() {
            *chosen = name;
        }
    }
}

/// What an estimator says about itself and, where the log has a reference, what that says about it.
fn told(wrench: &WrenchSnapshot) -> String {
    let mut parts = Vec::new();
    if let Some(errors) = wrench.summary.against_reference {
        parts.push(format!(
            "against O_F_ext of the log: RMSE {} N, {} Nm",
            significant(errors.rmse_force_n, 3),
            significant(errors.rmse_moment_nm, 3)
        ));
    }
    if let Some(nis) = wrench.summary.mean_nis {
        parts.push(format!("mean NIS {} (6 where model and noise fit the log)", significant(nis, 3)));
    }
    if wrench.summary.faults > 0 {
        parts.push(format!("{} samples could not be used", wrench.summary.faults));
    }
    if parts.is_empty() { "the log has no O_F_ext to compare with".to_owned() } else { parts.join("; ") }
}

/// The six components, each estimator with its 95 % band; the reference where the log has one.
pub fn components(ui: &mut Ui, log: &LogSnapshot, wrenches: &[&std::sync::Arc<WrenchSnapshot>]) {
    /// Grey: what something is compared with.
    const GREY: usize = 6;
    let Some(first) = wrenches.first() else { return };
    let labels: Vec<&str> =
        first.signals.channels().iter().step_by(3).map(|channel| channel.quantity.as_str()).collect();
    let channels = log.signals.channels();
    let reference: Vec<usize> =
        (0..channels.len()).filter(|k| channels[*k].quantity.starts_with("reference wrench")).collect();
    cells(ui, labels.len(), |ui, k, height| {
        let mut curves = Vec::new();
        // The smoothest estimator is the first: it is drawn last, and no other hides it.
        for wrench in wrenches.iter().rev() {
            let band = Some((3 * k + 1, 3 * k + 2));
            let ink = EstimatorName::ALL.iter().position(|name| *name == wrench.estimator).unwrap_or(0);
            let name = super::estimator_name(wrench.estimator);
            curves.push(Curve { name, ink, of: (&wrench.signals, 3 * k), band });
        }
        if let Some(channel) = reference.get(k) {
            curves.push(Curve { name: "O_F_ext of the log", ink: GREY, of: (&log.signals, *channel), band: None });
        }
        signal_plot(ui, labels[k], &curves, height);
    });
}

/// Channels of one quantity in one plot.
pub fn channels(ui: &mut Ui, signals: &Signals) {
    let mut quantities: Vec<&str> = Vec::new();
    for channel in signals.channels() {
        if quantities.last() != Some(&channel.quantity.as_str()) {
            quantities.push(&channel.quantity);
        }
    }
    cells(ui, quantities.len(), |ui, k, height| {
        let members = signals.channels().iter().enumerate().filter(|(_, channel)| channel.quantity == quantities[k]);
        let curves: Vec<Curve<'_>> = members
            .enumerate()
            .map(|(ink, (at, channel))| Curve { name: &channel.name, ink, of: (signals, at), band: None })
            .collect();
        signal_plot(ui, quantities[k], &curves, height);
    });
}
