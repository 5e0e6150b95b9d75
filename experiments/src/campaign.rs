//! A tuning campaign: trials, journal, result.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use rayon::prelude::*;
use serde_json::{Value, json};
use tribo_ekf::WrenchEkf;
use tribo_friction::law::CoulombViscous;
use tribo_friction::{Compensator, FrictionModel};
use tribo_logs::write_atomic;

use crate::config::{ConfigError, EstimatorName};
use crate::files::{FileError, TunedFile, YamlDocument, to_yaml};
use crate::journal::{Clock, Journal, JournalTrial, TrialState};
use crate::leftovers::sweep;
use crate::strategy::{FinishedTrial, LogSource, Origin, Proposal, Strategy, StrategyError};
use crate::trial_store::{read_trial_log, trial_log_path, write_trial_log};
use crate::{AbortReason, Cost, Trial, TrialLog, TrialOutcome, TuneConfig, ValidTune, run_trial};

/// Why a campaign cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// Settings out of range.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A file is missing, damaged or cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The strategy has no answer.
    #[error("trial {trial}: {source}")]
    Strategy {
        /// The trial that was to be chosen.
        trial: usize,
        /// Why it could not be.
        source: StrategyError,
    },
    /// Somebody asked to stop; finished trials are safe.
    #[error("stopped after {finished} finished trials")]
    Stopped {
        /// Trials finished so far.
        finished: usize,
    },
}

/// Costs that put a campaign's result into proportion; known only in simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct References {
    /// J without compensation.
    pub uncompensated: f64,
    /// J with the true steady friction, cold, as compensator.
    pub oracle: f64,
    /// J of the same arm without friction.
    pub frictionless: f64,
}

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
    /// All trials, by number.
    pub trials: Vec<FinishedTrial>,
    /// Number and cost of the best trial that was not aborted.
    pub best: Option<(usize, f64)>,
    /// Reference costs.
    pub references: References,
}

/// A campaign in its directory.
#[derive(Debug)]
pub struct Campaign {
    directory: PathBuf,
    tune: ValidTune,
    journal: Journal,
    trials: Vec<Option<FinishedTrial>>,
    /// Trials that the journal knows, finished or not.
    created: usize,
    /// Parameters that the journal already holds for trials that were running when the campaign was killed.
    recorded: Vec<JournalTrial>,
}

impl Campaign {
    /// Starts a campaign in a directory that has none yet.
    pub fn create(directory: &Path, config: TuneConfig, clock: Clock) -> Result<Self, CampaignError> {
        let tune = config.validate()?;
        let settings = directory.join("campaign.yaml");
        if settings.exists() || directory.join("journal.log").exists() {
            return Err(FileError::Campaign {
                path: directory.to_owned(),
                message: "holds a campaign already; give another --out, or --resume to go on with it".to_owned(),
            }
            .into());
        }
        std::fs::create_dir_all(directory.join("trials")).map_err(FileError::io(directory))?;
        let text = to_yaml(&tune.config).map_err(FileError::io(&settings))?;
        write_atomic(&settings, |file| file.write_all(text.as_bytes())).map_err(FileError::from)?;
        let journal = Journal::create(&directory.join("journal.log"), clock)?;
        sweep(directory);
        let trials = vec![None; tune.config.trials];
        Ok(Self { directory: directory.to_owned(), tune, journal, trials, created: 0, recorded: Vec::new() })
    }

    /// Goes on with the campaign of a directory; `trials` overrides its number of trials (never below those recorded).
    pub fn resume(directory: &Path, trials: Option<usize>, clock: Clock) -> Result<Self, CampaignError> {
        let settings = directory.join("campaign.yaml");
        if !settings.exists() {
            return Err(FileError::Campaign {
                path: directory.to_owned(),
                message: "holds no campaign (no campaign.yaml)".to_owned(),
            }
            .into());
        }
        let document = YamlDocument::read(&settings)?;
        let mut config: TuneConfig = document.parse()?;
        config.trials = trials.unwrap_or(config.trials);
        let tune = config.validate().map_err(|error| match error {
            ConfigError::Field(field) => ConfigError::File(document.explain(field)),
            other => other,
        })?;
        let path = directory.join("journal.log");
        // A campaign killed between its two first files has settings and no journal.
        let (journal, recorded) =
            if path.exists() { Journal::open(&path, clock)? } else { (Journal::create(&path, clock)?, Vec::new()) };
        std::fs::create_dir_all(directory.join("trials")).map_err(FileError::io(directory))?;
        sweep(directory);
        let mut finished = vec![None; tune.config.trials.max(recorded.len())];
        for (number, trial) in recorded.iter().enumerate() {
            if trial.state.is_finished() {
                finished[number] = Some(finished_trial(&tune, &path, number, trial)?);
            }
        }
        let created = recorded.len();
        Ok(Self { directory: directory.to_owned(), tune, journal, trials: finished, created, recorded })
    }

    /// The validated settings.
    pub fn tune(&self) -> &ValidTune {
        &self.tune
    }

    /// Number of trials that are finished.
    pub fn finished(&self) -> usize {
        self.trials.iter().flatten().count()
    }

    /// Runs what is left of the campaign, independent trials on the threads of the current rayon pool, and writes
    /// `tuned.yaml`. The result does not depend on the number of threads.
    pub fn run(mut self, observer: &mut dyn CampaignObserver) -> Result<CampaignResult, CampaignError> {
        let references = references(&self.tune);
        observer.references(&references);
        let strategy = self
            .tune
            .config
            .strategy
            .build(&self.tune)
            .map_err(|source| CampaignError::Strategy { trial: 0, source })?;
        let logs = StoredLogs { directory: self.directory.clone(), recent: Mutex::new(Vec::new()) };

        while let Some(next) = self.trials.iter().position(Option::is_none) {
            if observer.stop_requested() {
                return Err(CampaignError::Stopped { finished: self.finished() });
            }
            let batch = self.next_batch(next, strategy.as_ref(), &logs)?;
            self.run_batch(&batch, &logs, observer)?;
        }

        let trials: Vec<FinishedTrial> = self.trials.into_iter().flatten().collect();
        let best = best_trial(&trials);
        let result = CampaignResult { config: self.tune.config.clone(), trials, best, references };
        write_tuned(&self.directory, &self.tune, &result)?;
        Ok(result)
    }

    /// The trials to run next: as many as depend on no other, or the one the strategy proposes.
    fn next_batch(
        &self,
        next: usize,
        strategy: &dyn Strategy,
        logs: &StoredLogs,
    ) -> Result<Vec<(usize, Proposal)>, CampaignError> {
        let fail = |trial: usize| move |source: StrategyError| CampaignError::Strategy { trial, source };
        let mut batch = Vec::new();
        // Twice the threads keeps all of them busy and the journal close behind.
        let most = 2 * rayon::current_num_threads();
        for number in (next..self.trials.len()).filter(|&number| self.trials[number].is_none()) {
            match strategy.design(number).map_err(fail(number))? {
                Some(proposal) if batch.len() < most => batch.push((number, proposal)),
                _ => break,
            }
        }
        if batch.is_empty() {
            let history: Vec<FinishedTrial> = self.trials[..next].iter().flatten().cloned().collect();
            batch.push((next, strategy.propose(next, &history, logs).map_err(fail(next))?));
        }
        Ok(batch)
    }

    fn run_batch(
        &mut self,
        batch: &[(usize, Proposal)],
        logs: &StoredLogs,
        observer: &mut dyn CampaignObserver,
    ) -> Result<(), CampaignError> {
        for (number, proposal) in batch {
            self.announce(*number, proposal)?;
        }
        let (tune, directory) = (&self.tune, &self.directory);
        let shared = Mutex::new((&mut self.journal, &mut self.trials, observer));
        batch.par_iter().try_for_each(|(number, proposal)| -> Result<(), CampaignError> {
            let outcome = run_numbered(tune, *number, &proposal.theta);
            write_trial_log(&trial_log_path(directory, *number), &outcome.log)?;
            let trial = FinishedTrial {
                number: *number,
                theta: proposal.theta.clone(),
                cost: outcome.cost,
                aborted: outcome.aborted,
                origin: proposal.origin,
            };
            let mut shared = shared.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            shared.0.finish(
                *number,
                &attributes(&trial, outcome.aborted_at_s),
                TrialState::Complete,
                Some(trial.cost.total()),
            )?;
            logs.remember(*number, outcome.log);
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
            let (_, low, high) = entries[k % entries.len()];
            (name.as_str(), proposal.theta[k], low, high)
        });
        Ok(self.journal.set_params(number, params)?)
    }
}

/// Logs of trials: the last few in memory, all on disk. Both hold the same bits.
struct StoredLogs {
    directory: PathBuf,
    recent: Mutex<Vec<(usize, TrialLog<7>)>>,
}

impl StoredLogs {
    fn remember(&self, number: usize, log: TrialLog<7>) {
        let mut recent = self.recent.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        recent.push((number, log));
        if recent.len() > 4 {
            recent.remove(0);
        }
    }
}

impl LogSource for StoredLogs {
    fn log(&self, number: usize) -> Result<TrialLog<7>, FileError> {
        let recent = self.recent.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        match recent.iter().find(|(held, _)| *held == number) {
            Some((_, log)) => Ok(log.clone()),
            None => read_trial_log(&trial_log_path(&self.directory, number)),
        }
    }
}

/// Logs of a campaign that never touches the disk.
struct LogsInMemory(Vec<TrialLog<7>>);

impl LogSource for LogsInMemory {
    fn log(&self, number: usize) -> Result<TrialLog<7>, FileError> {
        self.0.get(number).cloned().ok_or_else(|| FileError::Campaign {
            path: PathBuf::new(),
            message: format!("trial {number} has not run yet"),
        })
    }
}

/// Runs all trials of a campaign one after the other, without directory, journal or reference costs.
pub fn run_in_memory(tune: &ValidTune) -> Result<Vec<FinishedTrial>, CampaignError> {
    let strategy = tune.config.strategy.build(tune).map_err(|source| CampaignError::Strategy { trial: 0, source })?;
    let (mut trials, mut logs) = (Vec::new(), LogsInMemory(Vec::new()));
    for number in 0..tune.config.trials {
        let fail = |source| CampaignError::Strategy { trial: number, source };
        let proposal = match strategy.design(number).map_err(fail)? {
            Some(proposal) => proposal,
            None => strategy.propose(number, &trials, &logs).map_err(fail)?,
        };
        let outcome = run_numbered(tune, number, &proposal.theta);
        trials.push(FinishedTrial {
            number,
            theta: proposal.theta,
            cost: outcome.cost,
            aborted: outcome.aborted,
            origin: proposal.origin,
        });
        logs.0.push(outcome.log);
    }
    Ok(trials)
}

/// Runs trial `number` with parameters θ: the noise depends on the campaign's seed and the number alone, and a truth
/// that warms up has run all trials before.
pub fn run_numbered(tune: &ValidTune, number: usize, theta: &[f64]) -> TrialOutcome<7> {
    let mut trial = tune.trial.clone();
    if let Some(warm_up) = &mut trial.truth.warm_up {
        warm_up.operated_s = number as f64 * trial.reference.total_s();
    }
    run_estimated(tune, &trial, &tune.space.friction(theta), noise_seed(tune.config.seed, number as u64))
}

fn run_estimated(tune: &ValidTune, trial: &Trial<7>, friction: &FrictionModel<7>, seed: u64) -> TrialOutcome<7> {
    match tune.config.residual {
        EstimatorName::Ekf => run_trial(trial, friction, WrenchEkf::new(tune.config.ekf), seed),
    }
}

/// SplitMix64 of seed and stream: neighbouring trials get unrelated noise.
fn noise_seed(seed: u64, stream: u64) -> u64 {
    let mut z = seed.wrapping_add(stream.wrapping_mul(0x9E37_79B9_7F4A_7C15)).wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// The three reference costs, on noise of their own.
pub fn references(tune: &ValidTune) -> References {
    let none = FrictionModel::uniform(CoulombViscous::default().into());
    let mut smooth = tune.trial.clone();
    smooth.truth.friction = none;
    let runs: [(&Trial<7>, FrictionModel<7>); 3] =
        [(&tune.trial, none), (&tune.trial, tune.trial.truth.friction), (&smooth, none)];
    let costs: Vec<f64> = runs
        .par_iter()
        .enumerate()
        .map(|(k, (trial, friction))| {
            let seed = noise_seed(tune.config.seed, u64::MAX - k as u64);
            run_estimated(tune, trial, friction, seed).cost.total()
        })
        .collect();
    References { uncompensated: costs[0], oracle: costs[1], frictionless: costs[2] }
}

/// Number and cost of the cheapest trial that was not aborted; the earliest of equals.
fn best_trial(trials: &[FinishedTrial]) -> Option<(usize, f64)> {
    let complete = trials.iter().filter(|trial| trial.aborted.is_none());
    complete.map(|trial| (trial.number, trial.cost.total())).min_by(|a, b| a.1.total_cmp(&b.1))
}

fn write_tuned(directory: &Path, tune: &ValidTune, result: &CampaignResult) -> Result<(), FileError> {
    let Some(best) = result.best else {
        return Ok(());
    };
    let theta = &result.trials[best.0].theta;
    let compensator: Compensator<7> = Compensator::new(tune.space.friction(theta), tune.config.velocity);
    let file =
        TunedFile::new(&compensator, &tune.trial.model.name, tune.config.seed, best, result.references.uncompensated);
    let path = directory.join("tuned.yaml");
    let text = to_yaml(&file).map_err(FileError::io(&path))?;
    Ok(write_atomic(&path, |file| file.write_all(text.as_bytes()))?)
}

/// What the journal keeps of a trial besides parameters and J.
fn attributes(trial: &FinishedTrial, aborted_at_s: Option<f64>) -> [(&'static str, Value); 6] {
    [
        ("origin", json!(trial.origin)),
        ("max", json!(trial.cost.max)),
        ("mean", json!(trial.cost.mean)),
        ("penalty", json!(trial.cost.penalty)),
        ("aborted", json!(trial.aborted)),
        ("aborted_at_s", json!(aborted_at_s)),
    ]
}

/// The inverse of [`attributes`].
fn finished_trial(
    tune: &ValidTune,
    path: &Path,
    number: usize,
    trial: &JournalTrial,
) -> Result<FinishedTrial, FileError> {
    let broken = |what: &str| FileError::Campaign {
        path: path.to_owned(),
        message: format!("trial {number} has no usable `{what}`; the journal was not written by this campaign"),
    };
    fn attribute<T: serde::de::DeserializeOwned>(trial: &JournalTrial, key: &str) -> Option<T> {
        serde_json::from_value(trial.attributes.get(key)?.clone()).ok()
    }
    let names = tune.space.names();
    let theta = names
        .iter()
        .map(|name| trial.params.get(name).copied().ok_or_else(|| broken(name)))
        .collect::<Result<Vec<f64>, _>>()?;
    let cost = Cost {
        max: attribute(trial, "max").ok_or_else(|| broken("max"))?,
        mean: attribute(trial, "mean").ok_or_else(|| broken("mean"))?,
        penalty: attribute(trial, "penalty").ok_or_else(|| broken("penalty"))?,
    };
    let aborted: Option<AbortReason> = attribute(trial, "aborted").ok_or_else(|| broken("aborted"))?;
    let origin: Origin = attribute(trial, "origin").ok_or_else(|| broken("origin"))?;
    Ok(FinishedTrial { number, theta, cost, aborted, origin })
}
