//! A tuning campaign: trials, journal, result.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use rayon::prelude::*;
use tribo_files::seal_of;
use tribo_model::FileError;
use tribo_trial::{trial_log_path, write_trial_log};

use crate::campaign_directory::{Changes, RunBy, create, open};
use crate::chooser::Chooser;
use crate::journal::{Clock, Ended, Journal, JournalTrial, finish, finished_trial, seal};
use crate::stored_logs::StoredLogs;
use crate::strategy::{FinishedTrial, LawChange, Past, Proposal, RunningTrial, StrategyError};
use crate::tuned::write_tuned;
use crate::{
    CampaignError, Conclusion, EarlyStop, ParameterSpace, References, TuneConfig, ValidTune, references, run_numbered,
};

/// Somebody who watches a campaign; called in the order in which trials finish.
pub trait CampaignObserver: Send {
    /// The reference costs are known.
    fn references(&mut self, references: &References) {
        let _ = references;
    }

    /// A trial has finished and is on the disk.
    fn trial_finished(&mut self, trial: &FinishedTrial) {
        let _ = trial;
    }

    /// Whether the campaign should stop before the next trial.
    fn stop_requested(&mut self) -> bool {
        false
    }
}

/// Nobody.
impl CampaignObserver for () {}

/// Result of a finished campaign.
#[derive(Clone, Debug)]
pub struct CampaignResult {
    /// The settings.
    pub config: TuneConfig,
    /// The parameters that were tuned.
    pub space: ParameterSpace,
    /// The parameters of the simulated arm's own friction, where it has such.
    pub truth: Option<Vec<f64>>,
    /// All trials, by number.
    pub trials: Vec<FinishedTrial>,
    /// The best trial that was seen to its end, and what the logs say of the friction law and of joints that stand.
    pub conclusion: Conclusion,
    /// Reference costs.
    pub references: References,
    /// The friction law that it went over to, if it did.
    pub law_change: Option<LawChange>,
    /// Why it ended before its last trial, if it did.
    pub early_stop: Option<EarlyStop>,
}

/// A campaign in its directory.
#[derive(Debug)]
pub struct Campaign<const N: usize> {
    directory: PathBuf,
    tune: ValidTune<N>,
    journal: Journal,
    trials: Vec<Option<FinishedTrial>>,
    /// Trials that the journal knows, finished or not.
    created: usize,
    /// Parameters that the journal already holds for trials that were running when the campaign was killed.
    recorded: Vec<JournalTrial>,
    /// Seals of the logs of finished trials, as the journal knows them.
    seals: BTreeMap<usize, String>,
}

impl<const N: usize> Campaign<N> {
    /// Starts a campaign in a directory that has none yet.
    #[inline(never)]
    pub fn create(directory: &Path, tune: ValidTune<N>, clock: Clock) -> Result<Self, CampaignError> {
        let journal = create(directory, &tune.config, RunBy::Tribo, clock)?;
        let trials = vec![None; tune.config.trials];
        let (recorded, seals) = (Vec::new(), BTreeMap::new());
        Ok(Self { directory: directory.to_owned(), tune, journal, trials, created: 0, recorded, seals })
    }

    /// Goes on with the campaign of a directory; trials recorded stay, be they more than it is to have from now on. What follows
    /// from the journal, `tuned.yaml` above all, is made true again.
    #[inline(never)]
    pub fn resume(directory: &Path, changes: Changes, clock: Clock) -> Result<Self, CampaignError> {
        let (tune, journal, recorded) = open(directory, changes, RunBy::Tribo, clock)?;
        let path = directory.join("journal.log");
        let mut finished = vec![None; tune.config.trials.max(recorded.len())];
        let mut seals = BTreeMap::new();
        for (number, trial) in recorded.iter().enumerate() {
            if trial.withdrawn.is_some() {
                let message = format!("trial {number} was withdrawn; trials that Tribo runs are not");
                return Err(FileError::Campaign { path, message }.into());
            }
            if trial.state.is_finished() {
                finished[number] = Some(finished_trial(&tune.space, &path, number, trial)?);
                seals.extend(seal(trial).map(|seal| (number, seal)));
            }
        }
        let done: Vec<FinishedTrial> = finished.iter().flatten().cloned().collect();
        // One that is there may be stale; where there is none, a run that is refused later on leaves none.
        if directory.join("tuned.yaml").exists() {
            let best = Conclusion::best_of(journal.study().conclusion.as_ref(), done.iter());
            let uncompensated = References::read(directory).map(|known| known.uncompensated);
            write_tuned(directory, &tune, &done, best.as_ref(), uncompensated)?;
        }
        let created = recorded.len();
        Ok(Self { directory: directory.to_owned(), tune, journal, trials: finished, created, recorded, seals })
    }

    /// The validated settings.
    pub fn tune(&self) -> &ValidTune<N> {
        &self.tune
    }

    /// Number of trials that are finished.
    pub fn finished(&self) -> usize {
        self.trials.iter().flatten().count()
    }

    /// Runs what is left of the campaign, independent trials on the threads of the current rayon pool; writes
    /// `references.yaml` at the beginning and `tuned.yaml` at the end. The result does not depend on the number of threads.
    #[inline(never)]
    pub fn run(mut self, observer: &mut dyn CampaignObserver) -> Result<CampaignResult, CampaignError> {
        let references = references(&self.tune)?;
        references.write(&self.directory)?;
        observer.references(&references);
        let fail = |source| CampaignError::Strategy { trial: 0, source };
        let mut chooser = Chooser::of(&self.tune).map_err(fail)?;
        let logs = StoredLogs::new(self.directory.clone(), self.seals.clone());

        let mut early_stop = None;
        while let Some(next) = self.trials.iter().position(Option::is_none) {
            if observer.stop_requested() {
                self.conclude(&chooser, &logs)?;
                return Err(CampaignError::Stopped { finished: self.finished() });
            }
            let begins_batch = self.tune.config.batches().of(next).start == next;
            if begins_batch {
                let finished: Vec<FinishedTrial> = self.trials[..next].iter().flatten().cloned().collect();
                let past = Past { finished: &finished, ..Past::default() };
                let fail = |source| CampaignError::Strategy { trial: next, source };
                if let Some(change) = chooser.strategy.better_law(past, &logs).map_err(fail)? {
                    self.journal.set_law(&change)?;
                    let tried = self.trials.iter_mut().flatten().map(|trial| &mut trial.theta);
                    self.tune.change_law_of(tried, change.law);
                    chooser = Chooser::of(&self.tune).map_err(fail)?;
                    continue;
                }
                early_stop = chooser.ends_before(next, &self.tune, &finished, &logs).map_err(fail)?;
                if let Some(stop) = early_stop {
                    stop.write(&self.directory)?;
                    break;
                }
            }
            if begins_batch {
                // Whoever looks at it, or kills it now, has the trial that is believed best, not the luckiest.
                self.conclude(&chooser, &logs)?;
            }
            let batch = self.next_batch(next, &chooser, &logs)?;
            self.run_batch(&batch, &chooser, &logs, observer)?;
        }

        let conclusion = self.conclude(&chooser, &logs)?;
        let trials: Vec<FinishedTrial> = self.trials.into_iter().flatten().collect();
        let best = conclusion.best;
        let (config, space) = (self.tune.config.clone(), self.tune.space.clone());
        let (law_change, truth) = (self.journal.study().law_change, self.tune.true_parameters());
        let result = CampaignResult { config, space, truth, trials, conclusion, references, early_stop, law_change };
        write_tuned(&self.directory, &self.tune, &result.trials, best.as_ref(), Some(references.uncompensated))?;
        Ok(result)
    }

    /// What the trials before the first that has not finished amount to; in the journal too, where that says something else. Of trials
    /// that ran side by side, a kill may have left later ones finished, and the logs before them are not all there.
    fn conclude(&mut self, chooser: &Chooser<N>, logs: &StoredLogs<N>) -> Result<Conclusion, CampaignError> {
        let finished: Vec<FinishedTrial> = self.trials.iter().map_while(Option::clone).collect();
        if finished.is_empty() {
            return Ok(Conclusion::default());
        }
        let conclusion = Conclusion::of(&self.tune, chooser, &finished, logs)
            .map_err(|source| CampaignError::Strategy { trial: finished.len(), source })?;
        self.journal.conclude(&conclusion)?;
        Ok(conclusion)
    }

    /// The trials to run next: as many as depend on no other, or those of one batch that the strategy proposes.
    #[inline(never)]
    fn next_batch(
        &self,
        next: usize,
        Chooser { strategy, limit, .. }: &Chooser<N>,
        logs: &StoredLogs<N>,
    ) -> Result<Vec<(usize, Proposal)>, CampaignError> {
        let fail = |trial: usize| move |source: StrategyError| CampaignError::Strategy { trial, source };
        let mut batch = Vec::new();
        // Twice the threads keeps all of them busy and the journal close behind; before the guard knows anything, one at a time.
        let most = if limit.knows(next, logs).map_err(fail(next))? { 2 * rayon::current_num_threads() } else { 1 };
        for number in (next..self.trials.len()).filter(|&number| self.trials[number].is_none()) {
            match strategy.design(number).map_err(fail(number))? {
                Some(proposal) if batch.len() < most => {
                    batch.push((number, limit.hold_back_design(proposal, next, logs).map_err(fail(number))?));
                }
                _ => break,
            }
        }
        if batch.is_empty() {
            let together = self.tune.config.batches().of(next);
            let (before, within) = self.trials.split_at(together.start);
            let finished: Vec<FinishedTrial> = before.iter().flatten().cloned().collect();
            let mut running: Vec<RunningTrial> = Vec::new();
            for (number, trial) in together.zip(within) {
                // A campaign that was killed has finished some of them; each is chosen as it would have been then.
                if let Some(trial) = trial {
                    running.push(trial.into());
                    continue;
                }
                let past = Past { finished: &finished, running: &running, ..Past::default() };
                let proposal = limit.proposal(strategy.as_ref(), number, past, logs).map_err(fail(number))?;
                running.push(RunningTrial { number, theta: proposal.theta.clone() });
                batch.push((number, proposal));
            }
        }
        Ok(batch)
    }

    #[inline(never)]
    fn run_batch(
        &mut self,
        batch: &[(usize, Proposal)],
        Chooser { limit, .. }: &Chooser<N>,
        logs: &StoredLogs<N>,
        observer: &mut dyn CampaignObserver,
    ) -> Result<(), CampaignError> {
        for (number, proposal) in batch {
            self.announce(*number, proposal)?;
        }
        let (tune, directory) = (&self.tune, &self.directory);
        let shared = Mutex::new((&mut self.journal, &mut self.trials, observer));
        batch.par_iter().try_for_each(|(number, proposal)| -> Result<(), CampaignError> {
            let outcome = run_numbered(tune, *number, &proposal.theta)?;
            let log = Arc::new(outcome.log);
            logs.remember(*number, Arc::clone(&log));
            let write = || write_trial_log(&trial_log_path(directory, *number), &log);
            // The next trial waits for one that ran alone: what it will ask of the log is worked out while that is written.
            let written =
                if batch.len() == 1 { rayon::join(write, || limit.learn(number + 1, logs)).0 } else { write() };
            written?;
            let trial = FinishedTrial {
                number: *number,
                theta: proposal.theta.clone(),
                cost: outcome.cost,
                aborted: outcome.aborted,
                origin: proposal.origin,
            };
            let path = trial_log_path(directory, *number);
            let seal = seal_of(&path).map_err(FileError::io(&path))?;
            let mut shared = shared.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            finish(shared.0, &trial, &Ended { aborted_at_s: outcome.aborted_at_s, seal, reported: None })?;
            shared.2.trial_finished(&trial);
            shared.1[*number] = Some(trial);
            Ok(())
        })
    }

    /// Creates the trial in the journal, unless a killed run has done so, and records the parameters still missing.
    fn announce(&mut self, number: usize, proposal: &Proposal) -> Result<(), CampaignError> {
        while self.created <= number {
            self.journal.create_trial()?;
            self.created += 1;
        }
        let known = self.recorded.get(number).map(|trial| &trial.params);
        let names = self.tune.space.names();
        let entries = self.tune.space.entries();
        let missing =
            names.iter().enumerate().filter(|(_, name)| !known.is_some_and(|params| params.contains_key(*name)));
        let params = missing.map(|(k, name)| {
            let (_, low, high) = entries[k];
            (name.as_str(), proposal.theta[k], low, high)
        });
        Ok(self.journal.set_params(number, params)?)
    }
}
