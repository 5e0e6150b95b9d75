//! A campaign at one moment.

use std::path::PathBuf;
use std::sync::Arc;

use tribo_campaign::strategy::{BestTrial, LawChange};
use tribo_campaign::{AnyTune, CampaignError, Conclusion, EarlyStop, References, finished_compensator};
use tribo_model::{TunedFile, file_name};
use tribo_trial::CostName;

use super::{TrialColumns, WatchedTrial, read_trial, uncompensated};

/// A campaign at one moment; nothing in it changes.
#[derive(Clone, Debug)]
pub struct CampaignSnapshot {
    /// Where it lives.
    pub directory: PathBuf,
    /// Its settings.
    pub tune: Arc<AnyTune>,
    /// Finished trials, by number.
    pub trials: Vec<WatchedTrial>,
    /// Trials that were taken back, and why; they are not among `trials`.
    pub withdrawn: Vec<(usize, String)>,
    /// Numbers of the trials that have begun and not ended.
    pub running: Vec<usize>,
    /// Whether the last line of the journal is incomplete: it is being written, or its writer was killed.
    pub torn: bool,
    /// Reference costs, once they are known.
    pub references: Option<References>,
    /// Why it ended before its last trial, if it did.
    pub early_stop: Option<EarlyStop>,
    /// The friction law that it went over to, if it did.
    pub law_change: Option<LawChange>,
    /// What its journal says of the trials that had finished when it was written.
    pub conclusion: Option<Conclusion>,
}

impl CampaignSnapshot {
    /// The trial of this number, if it has finished.
    pub fn trial(&self, number: usize) -> Option<&WatchedTrial> {
        self.trials.iter().find(|watched| watched.trial.number == number)
    }

    /// The best trial so far; until the campaign has concluded on all that have finished, the cheapest.
    pub fn best(&self) -> Option<&WatchedTrial> {
        self.trial(self.best_trial()?.trial)
    }

    /// What is expected of the best trial.
    pub fn best_trial(&self) -> Option<BestTrial> {
        Conclusion::best_of(self.conclusion.as_ref(), self.trials.iter().map(|watched| &watched.trial))
    }

    /// Whether its trials run elsewhere: nothing of it can be simulated.
    pub fn trials_by_user(&self) -> bool {
        self.tune.config().user_trials.is_some()
    }

    /// The trial without compensation of a campaign whose trials run elsewhere, if there was one.
    fn tried_without(&self) -> Option<&WatchedTrial> {
        let zero = self.tune.space().zero();
        let complete = self.trials.iter().filter(|watched| watched.trial.aborted.is_none());
        complete.filter(|_| self.trials_by_user()).find(|watched| watched.trial.theta == zero)
    }

    /// J without compensation, where it is known.
    pub fn uncompensated_cost(&self) -> Option<f64> {
        let tried = || self.tried_without().map(|watched| watched.trial.cost.total());
        self.references.map(|references| references.uncompensated).or_else(tried)
    }

    /// What the arm does without compensation: simulated, or the trial that tried it.
    ///
    /// # Errors
    /// Those of the estimator; a log that is missing or damaged.
    pub fn uncompensated(&self) -> Result<Option<TrialColumns>, CampaignError> {
        if !self.trials_by_user() {
            return Ok(Some(uncompensated(&self.tune)?));
        }
        let tried = self.tried_without();
        Ok(tried.map(|watched| read_trial(&self.tune, &self.directory, watched)).transpose()?)
    }

    /// The compensator of the best trial, if there is one: what `tuned.yaml` holds.
    pub fn tuned(&self) -> Option<TunedFile> {
        let (best, uncompensated) = (self.best_trial()?, self.uncompensated_cost());
        let theta = &self.trial(best.trial)?.trial.theta;
        Some(match &*self.tune {
            AnyTune::Six(tune) => finished_compensator(tune, theta, &best, uncompensated),
            AnyTune::Seven(tune) => finished_compensator(tune, theta, &best, uncompensated),
        })
    }

    /// What there is to say beside the costs: whether the motion fails anyway, whether the friction law explains the robot, another law, bounds that were reached, and why
    /// the campaign ended.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        remarks.extend(self.references.and_then(|references| references.remark()));
        remarks.extend(self.law_change.map(|change| change.to_string()));
        remarks.extend(self.conclusion.iter().flat_map(|conclusion| conclusion.remarks(self.tune.joint_names())));
        remarks.extend(self.early_stop.map(|stop| format!("nothing left to gain: {stop}")));
        remarks
    }

    /// Trials that were stopped.
    pub fn failed(&self) -> impl Iterator<Item = &WatchedTrial> {
        self.trials.iter().filter(|watched| watched.trial.aborted.is_some())
    }

    /// Whether all trials have finished, or the campaign has ended early.
    pub fn is_complete(&self) -> bool {
        self.early_stop.is_some() || self.trials.len() >= self.tune.config().trials
    }

    /// Trials to be run in all; of a campaign that ended early those that were.
    pub fn total(&self) -> usize {
        let known = self.trials.len() + self.running.len();
        if self.early_stop.is_some() { known } else { known.max(self.tune.config().trials) }
    }

    /// What J is.
    pub fn cost_name(&self) -> CostName {
        self.tune.config().cost
    }

    /// The settings that tell campaigns apart, as name and value.
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let config = self.tune.config();
        vec![
            ("robot", self.tune.robot().to_owned()),
            ("strategy", file_name(&config.strategy)),
            ("friction law", file_name(&config.friction)),
            ("estimator", file_name(&config.residual)),
            (
                "simulated friction",
                if self.trials_by_user() { "none, a robot elsewhere".to_owned() } else { file_name(&config.truth) },
            ),
            ("cost", file_name(&config.cost)),
            ("velocity", file_name(&config.velocity)),
            ("pose", config.pose.to_string()),
            ("seed", config.seed.to_string()),
        ]
    }
}
