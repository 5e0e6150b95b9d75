//! From the directory of a campaign to its snapshots.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{CampaignSnapshot, WatchedTrial};
use tribo_campaign::journal::{JournalTail, News, TrialState, finished_trial, reported, seal};
use tribo_campaign::{AnyTune, CampaignError, EarlyStop, References, check_unchanged, explained, read_settings};
use tribo_model::YamlDocument;

/// Watches the campaign of a directory, finished or running, in this process or another.
#[derive(Clone, Debug)]
pub struct CampaignWatch {
    directory: PathBuf,
    tune: Arc<AnyTune>,
    /// The text of the settings, until the journal has said what they were.
    unchecked: Option<YamlDocument>,
    tail: JournalTail,
    torn: bool,
    references: Option<References>,
    early_stop: Option<EarlyStop>,
    seen: bool,
}

impl CampaignWatch {
    /// Opens a campaign; what is wrong with the directory is said, and what to do.
    pub fn open(directory: &Path) -> Result<Self, CampaignError> {
        let missing = if directory.join("campaigns").is_dir() {
            "holds no campaign.yaml; campaigns live in directories like campaigns/0001"
        } else {
            "holds no campaign.yaml; `tribo tune` makes a campaign"
        };
        let (config, document) = read_settings(directory, missing)?;
        let tune = config.validate_any().map_err(|error| explained(error, &document))?;
        let tail = JournalTail::new(&directory.join("journal.log"));
        let (directory, tune, unchecked) = (directory.to_owned(), Arc::new(tune), Some(document));
        Ok(Self { directory, tune, unchecked, tail, torn: false, references: None, early_stop: None, seen: false })
    }

    /// The settings.
    pub fn tune(&self) -> &Arc<AnyTune> {
        &self.tune
    }

    /// The directory.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// Makes reference costs part of all snapshots to come; those that the campaign has left are found without.
    pub fn set_references(&mut self, references: References) {
        (self.references, self.seen) = (Some(references), false);
    }

    /// A snapshot if anything has changed since the last one.
    pub fn poll(&mut self) -> Result<Option<CampaignSnapshot>, CampaignError> {
        let news = self.tail.poll()?;
        let torn = self.tail.torn_bytes() > 0;
        if self.references.is_none()
            && let Some(left) = References::read(&self.directory)
        {
            self.set_references(left);
        }
        if self.early_stop.is_none()
            && let Some(left) = EarlyStop::read(&self.directory)
        {
            (self.early_stop, self.seen) = (Some(left), false);
        }
        if self.seen && news == News::None && torn == self.torn {
            return Ok(None);
        }
        (self.seen, self.torn) = (true, torn);
        let journal = self.directory.join("journal.log");
        if let (Some(document), Some(began)) = (&self.unchecked, &self.tail.study().settings) {
            check_unchanged(began, document, &journal)?;
            self.unchecked = None;
        }
        if let Some(change) = self.tail.study().law_change.filter(|change| change.law != self.tune.config().friction) {
            Arc::make_mut(&mut self.tune).change_law(change.law);
        }
        if let Some(trials) = self.tail.study().trials.filter(|trials| *trials != self.tune.config().trials) {
            Arc::make_mut(&mut self.tune).set_trials(trials);
        }
        let (mut trials, mut running, mut withdrawn) = (Vec::new(), Vec::new(), Vec::new());
        for (number, trial) in self.tail.trials().iter().enumerate() {
            if trial.state == TrialState::Fail {
                // Given up: nothing is known of it.
            } else if let Some(reason) = &trial.withdrawn {
                withdrawn.push((number, reason.clone()));
            } else if trial.state.is_finished() {
                let aborted_at_s = trial.attributes.get("aborted_at_s").and_then(serde_json::Value::as_f64);
                let finished = finished_trial(self.tune.space(), &journal, number, trial)?;
                let reported = reported(trial);
                trials.push(WatchedTrial { trial: finished, aborted_at_s, reported, seal: seal(trial) });
            } else {
                running.push(number);
            }
        }
        let (directory, tune, references) = (self.directory.clone(), Arc::clone(&self.tune), self.references);
        let early_stop =
            self.early_stop.filter(|stop| tune.config().stop_rule().is_some() && stop.trials == trials.len());
        let (conclusion, law_change) = (self.tail.study().conclusion.clone(), self.tail.study().law_change);
        Ok(Some(CampaignSnapshot {
            directory,
            tune,
            trials,
            withdrawn,
            running,
            torn,
            references,
            early_stop,
            conclusion,
            law_change,
        }))
    }
}
