//! Two campaigns, or the estimators on one log, side by side.

use std::path::Path;

use egui::Ui;

use super::compare_campaigns::CompareCampaigns;
use super::compare_estimators::CompareEstimators;
use crate::source::Source;

/// What the user has chosen.
#[derive(Debug, Default)]
pub struct CompareView {
    on_log: bool,
    campaigns: CompareCampaigns,
    estimators: CompareEstimators,
}

impl CompareView {
    /// Compares with another campaign, or says why not.
    pub fn open(&mut self, source: &mut Source, path: &Path) {
        self.campaigns.open(source, path);
    }

    /// The view.
    pub fn ui(&mut self, ui: &mut Ui, source: &mut Source) {
        match (source.snapshot().campaign.is_some(), source.snapshot().log.clone()) {
            (true, Some(_)) => {
                ui.horizontal(|ui| {
                    ui.selectable_value(&mut self.on_log, false, "Campaigns");
                    ui.selectable_value(&mut self.on_log, true, "Estimators on the log");
                });
            }
            (campaign, _) => self.on_log = !campaign && source.snapshot().log.is_some(),
        }
        match source.snapshot().log.clone().filter(|_| self.on_log) {
            Some(log) => self.estimators.ui(ui, source, &log),
            None => self.campaigns.ui(ui, source),
        }
    }
}
