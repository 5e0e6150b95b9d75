//! Two campaigns side by side.

use std::path::{Path, PathBuf};

use egui::{Grid, RichText, ScrollArea, Ui};
use tribo_figure::number::{quantity_and_unit, significant};
use tribo_watch::{CampaignSnapshot, campaign_figures, expected};

use super::memo::{Memo, address};
use crate::plot::{Look, show};
use crate::source::Source;
use crate::theme;

/// What the user has chosen.
#[derive(Debug, Default)]
pub struct CompareCampaigns {
    path: String,
    error: String,
    figures: Memo,
}

impl CompareCampaigns {
    /// Compares with another campaign, or says why not.
    pub fn open(&mut self, source: &mut Source, path: &Path) {
        self.path = path.display().to_string();
        self.error = source.compare(path).err().unwrap_or_default();
    }

    /// The view.
    pub fn ui(&mut self, ui: &mut Ui, source: &mut Source) {
        let Some(one) = source.snapshot().campaign.clone() else {
            super::empty(
                ui,
                "Nothing to compare",
                "Open a campaign above and give a second one here; or open a log to compare estimators on it.",
            );
            return;
        };
        ui.horizontal(|ui| {
            let label = ui.label("Compare with the campaign in");
            ui.add(egui::TextEdit::singleline(&mut self.path).desired_width(380.0).hint_text("campaigns/0002"))
                .labelled_by(label.id);
            if ui.button("Compare both").clicked() {
                let path = PathBuf::from(self.path.trim());
                self.open(source, &path);
            }
        });
        if !self.error.is_empty() {
            ui.label(RichText::new(&self.error).color(theme::bad(ui.visuals().dark_mode)));
        }
        let Some(two) = source.snapshot().other.clone() else {
            super::empty(ui, "One campaign so far", "Give the directory of a second one above.");
            return;
        };
        let names = [name(&one), name(&two)];
        let key = (vec![address(Some(&one)), address(Some(&two))], vec![]);
        let figures = self.figures.get(key, || {
            let mut figures = vec![campaign_figures::compare_best(&[(&names[0], &one), (&names[1], &two)])];
            figures.extend([&one, &two].map(|campaign| campaign_figures::cost_parts(campaign, false)));
            figures
        });
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            show(ui, &figures[0], Look { height: 240.0, ..Look::default() });
            ui.columns(2, |cells| {
                for (k, campaign) in [&one, &two].into_iter().enumerate() {
                    cells[k].label(RichText::new(&names[k]).heading());
                    cells[k].push_id(k, |ui| show(ui, &figures[k + 1], Look { height: 200.0, ..Look::default() }));
                    cells[k].push_id(k, |ui| facts(ui, campaign));
                }
            });
            if one.tune.space().names() == two.tune.space().names() {
                parameters(ui, &names, &one, &two);
            } else {
                ui.weak("Their friction laws or numbers of joints differ; parameters cannot be compared.");
            }
        });
    }
}

/// The last two parts of the path: `campaigns/0001`.
fn name(campaign: &CampaignSnapshot) -> String {
    let parts: Vec<_> =
        campaign.directory.iter().rev().take(2).map(|part| part.to_string_lossy().into_owned()).collect();
    parts.into_iter().rev().collect::<Vec<_>>().join("/")
}

fn facts(ui: &mut Ui, campaign: &CampaignSnapshot) {
    Grid::new("facts").num_columns(2).striped(true).spacing([18.0, 4.0]).show(ui, |ui| {
        let best = campaign
            .best_trial()
            .map_or("–".to_owned(), |best| format!("J = {} (trial {})", expected(&best), best.trial));
        let oracle = campaign
            .references
            .zip(campaign.best_trial())
            .map_or("–".to_owned(), |(references, best)| significant(best.cost / references.oracle, 3));
        let trials = format!("{} of {}, {} failed", campaign.trials.len(), campaign.total(), campaign.failed().count());
        for (what, value) in [("best", best), ("J / J with the true friction", oracle), ("trials", trials)]
            .into_iter()
            .chain(campaign.facts())
        {
            ui.label(what);
            ui.label(value);
            ui.end_row();
        }
    });
}

fn parameters(ui: &mut Ui, names: &[String; 2], one: &CampaignSnapshot, two: &CampaignSnapshot) {
    let (Some(a), Some(b)) = (one.best(), two.best()) else { return };
    let space = one.tune.space();
    ui.add_space(8.0);
    ui.label(RichText::new("Best parameters").heading());
    Grid::new("compared parameters").striped(true).spacing([22.0, 4.0]).show(ui, |ui| {
        ui.strong("joint");
        for name in space.names_of_joint() {
            let (quantity, unit) = quantity_and_unit(name);
            for name in names {
                ui.strong(format!("{quantity} [{unit}], {name}"));
            }
        }
        ui.end_row();
        for joint in 0..space.joints() {
            ui.label(one.tune.joint_names().of(joint).to_string());
            for k in 0..space.parameters_per_joint() {
                for theta in [&a.trial.theta, &b.trial.theta] {
                    ui.label(significant(theta[joint * space.parameters_per_joint() + k], 4));
                }
            }
            ui.end_row();
        }
    });
}
