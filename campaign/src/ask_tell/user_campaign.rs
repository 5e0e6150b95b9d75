//! A campaign whose trials the user runs.

use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tribo_files::seal_of;
use tribo_model::{ConfigError, FileError, TunedFile};
use tribo_trial::{AbortReason, Cost, CostAccumulator, TrialLog, trial_log_path, write_trial_log};

use super::{JudgedLog, Learnt, UserTrials};
use crate::campaign_directory::{Changes, RunBy, check_trials, create, open};
use crate::chooser::Chooser;
use crate::journal::{Clock, Ended, Journal, JournalTrial, TrialState, finish, finished_trial, seal, theta};
use crate::stored_logs::StoredLogs;
use crate::strategy::{
    BestTrial, BeyondBox, FinishedTrial, LawChange, LogSource, Origin, Past, Proposal, RunningTrial, StrategyError,
};
use crate::tuned::{trial_compensator, write_tuned};
use crate::{CampaignError, Conclusion, EarlyStop, StopBelow, ValidTune};

/// A trial that has been asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// Its number.
    pub number: usize,
    /// Its parameters θ.
    pub theta: Vec<f64>,
    /// Who chose them.
    pub origin: Origin,
    /// The compensator to run it with.
    pub file: TunedFile,
}

/// What has become known by telling.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// The trial.
    pub trial: FinishedTrial,
    /// Time of its failure since the start of the judged part (s), where it is known.
    pub aborted_at_s: Option<f64>,
    /// The best trial so far, and what the logs say of the friction law and of joints that stand.
    pub conclusion: Conclusion,
    /// Trials told so far, failed ones included.
    pub finished: usize,
    /// Why another trial is not worth its time, if it is not.
    pub early_stop: Option<EarlyStop>,
}

/// A campaign in its directory, whose trials run elsewhere: [`Self::ask`] hands out parameters, [`Self::tell`] takes what came
/// of them, in any order, several trials in flight. Everything is in the journal before a call returns, so each call may be
/// a process of its own; two at the same time wait for each other.
#[derive(Debug)]
pub struct UserCampaign<const N: usize> {
    directory: PathBuf,
    tune: ValidTune<N>,
    user_trials: UserTrials,
    journal: Journal,
    trials: Vec<Entry>,
    /// Seals of the logs that came back, as the journal knows them.
    seals: BTreeMap<usize, String>,
    /// What chooses the next trial, as long as no trial comes or goes.
    chooser: OnceCell<Chooser<N>>,
}

/// A trial as its campaign knows it.
#[derive(Debug)]
enum Entry {
    /// A process was killed while it wrote the parameters: nobody has seen them.
    Torn,
    Running(RunningTrial, Origin),
    Finished(FinishedTrial),
    GivenUp,
    /// Told, and taken back.
    Withdrawn,
}

impl<const N: usize> UserCampaign<N> {
    /// Starts a campaign in a directory that has none yet; settings without `user_trials` get the default ones.
    ///
    /// # Errors
    /// A directory that holds a campaign, or cannot be written.
    pub fn create(directory: &Path, mut tune: ValidTune<N>, clock: Clock) -> Result<Self, CampaignError> {
        let user_trials = *tune.config.user_trials.get_or_insert_default();
        let journal = create(directory, &tune.config, RunBy::User, clock)?;
        let (trials, seals, chooser) = (Vec::new(), BTreeMap::new(), OnceCell::new());
        Ok(Self { directory: directory.to_owned(), tune, user_trials, journal, trials, seals, chooser })
    }

    /// Opens the campaign of a directory; waits while another process holds it. `tuned.yaml` and `early_stop.yaml`, which follow from the journal, are
    /// written anew where somebody was killed before they were.
    ///
    /// # Errors
    /// No campaign, one whose trials Tribo runs, or a damaged one.
    pub fn open(directory: &Path, clock: Clock) -> Result<Self, CampaignError> {
        let (tune, journal, recorded) = open::<N>(directory, Changes::default(), RunBy::User, clock)?;
        let user_trials = tune.config.user_trials.unwrap_or_default();
        let path = directory.join("journal.log");
        let trials = recorded
            .iter()
            .enumerate()
            .map(|(number, trial)| Entry::of(&tune, &path, number, trial))
            .collect::<Result<_, _>>()?;
        let seals = recorded.iter().enumerate().filter_map(|(number, trial)| Some((number, seal(trial)?))).collect();
        let (directory, chooser) = (directory.to_owned(), OnceCell::new());
        let mut campaign = Self { directory, tune, user_trials, journal, trials, seals, chooser };
        campaign.refresh()?;
        // A trial whose log was lost or replaced has to be opened to be taken back: what cannot be told now is left as it is.
        if let Ok(early_stop) = campaign.early_stop() {
            EarlyStop::leave(early_stop.as_ref(), &campaign.directory)?;
        }
        Ok(campaign)
    }

    /// Writes the compensator that follows from the journal.
    fn refresh(&mut self) -> Result<(), CampaignError> {
        let finished: Vec<FinishedTrial> = self.finished().cloned().collect();
        let best = self.conclude(&finished)?.best;
        let zero = self.tune.space.zero();
        let uncompensated = finished.iter().find(|trial| trial.aborted.is_none() && trial.theta == zero);
        let uncompensated_cost = uncompensated.map(|trial| trial.cost.total());
        Ok(write_tuned(&self.directory, &self.tune, &finished, best.as_ref(), uncompensated_cost)?)
    }

    /// What the trials amount to, as the journal has it, or worked out where trials have come or gone since.
    fn conclude(&mut self, finished: &[FinishedTrial]) -> Result<Conclusion, CampaignError> {
        if let Some(known) = self.journal.study().conclusion.as_ref().filter(|known| known.trials == finished.len()) {
            return Ok(known.clone());
        }
        if finished.is_empty() {
            return Ok(Conclusion::default());
        }
        let conclusion = Conclusion::of(&self.tune, self.chooser()?, finished, &self.logs());
        let conclusion = conclusion.map_err(|source| self.no_answer(source))?;
        self.journal.conclude(&conclusion)?;
        Ok(conclusion)
    }

    /// What chooses the next trial after those that are known now.
    fn chooser(&self) -> Result<&Chooser<N>, CampaignError> {
        if let Some(chooser) = self.chooser.get() {
            return Ok(chooser);
        }
        let chooser = Chooser::of(&self.tune).map_err(|source| self.no_answer(source))?;
        Ok(self.chooser.get_or_init(|| chooser))
    }

    /// Puts a trial in its place.
    fn set(&mut self, number: usize, entry: Entry) {
        match self.trials.get_mut(number) {
            Some(there) => *there = entry,
            None => self.trials.push(entry),
        }
        self.chooser.take();
    }

    fn no_answer(&self, source: StrategyError) -> CampaignError {
        CampaignError::Strategy { trial: self.trials.len(), source }
    }

    /// Why another trial is not worth its time, if it is not; nobody knows while trials are in flight.
    ///
    /// # Errors
    /// A strategy without an answer, a log that cannot be read.
    pub fn early_stop(&self) -> Result<Option<EarlyStop>, CampaignError> {
        // A better law is worth a trial.
        if self.better_law()?.is_some() { Ok(None) } else { self.ended() }
    }

    /// Why another trial with the law that holds is not worth its time, if it is not.
    fn ended(&self) -> Result<Option<EarlyStop>, CampaignError> {
        if self.in_flight().next().is_some() {
            return Ok(None);
        }
        let finished: Vec<FinishedTrial> = self.finished().cloned().collect();
        self.chooser()?
            .ends_before(self.trials.len(), &self.tune, &finished, &self.logs())
            .map_err(|source| self.no_answer(source))
    }

    /// Another friction law, if the last logs speak for it; nobody knows while trials are in flight.
    fn better_law(&self) -> Result<Option<LawChange>, CampaignError> {
        if self.in_flight().next().is_some() {
            return Ok(None);
        }
        let finished: Vec<FinishedTrial> = self.finished().cloned().collect();
        let past = Past { finished: &finished, ..Past::default() };
        let better = self.chooser()?.strategy.better_law(past, &self.logs());
        better.map_err(|source| self.no_answer(source))
    }

    /// Goes over to another friction law, in which the trials so far are what they were.
    fn change_law(&mut self, change: &LawChange) -> Result<(), FileError> {
        self.journal.set_law(change)?;
        let tried = self.trials.iter_mut().filter_map(|entry| match entry {
            Entry::Finished(FinishedTrial { theta, .. }) | Entry::Running(RunningTrial { theta, .. }, _) => Some(theta),
            _ => None,
        });
        self.tune.change_law_of(tried, change.law);
        self.chooser.take();
        Ok(())
    }

    /// The friction law that the campaign went over to, if it did.
    pub fn law_change(&self) -> Option<LawChange> {
        self.journal.study().law_change
    }

    /// The validated settings.
    pub fn tune(&self) -> &ValidTune<N> {
        &self.tune
    }

    /// How its trials are judged.
    pub fn user_trials(&self) -> &UserTrials {
        &self.user_trials
    }

    /// Changes the number of trials of the campaign.
    ///
    /// # Errors
    /// A number out of range, a journal that cannot be written.
    pub fn set_trials(&mut self, trials: usize) -> Result<(), CampaignError> {
        check_trials(trials)?;
        self.journal.set_trials(trials)?;
        self.tune.config.trials = trials;
        self.chooser.take();
        Ok(())
    }

    /// Changes when the campaign ends before its last trial.
    ///
    /// # Errors
    /// A rule that is not for its strategy, a journal that cannot be written.
    pub fn set_stop_below(&mut self, stop_below: StopBelow) -> Result<(), CampaignError> {
        let mut config = self.tune.config.clone();
        config.stop_below = Some(stop_below);
        config.check_stop_below().map_err(ConfigError::from)?;
        self.journal.set_stop_below(stop_below)?;
        self.tune.config.stop_below = Some(stop_below);
        self.chooser.take();
        Ok(())
    }

    /// Numbers of the trials that have been asked for and not been told.
    pub fn running(&self) -> Vec<usize> {
        self.in_flight().map(|trial| trial.number).collect()
    }

    fn in_flight(&self) -> impl Iterator<Item = &RunningTrial> {
        self.trials.iter().filter_map(|entry| match entry {
            Entry::Running(trial, _) => Some(trial),
            _ => None,
        })
    }

    /// The trials that have been told.
    pub fn finished(&self) -> impl Iterator<Item = &FinishedTrial> + Clone {
        self.trials.iter().filter_map(|entry| match entry {
            Entry::Finished(trial) => Some(trial),
            _ => None,
        })
    }

    /// The next parameters, marked as running in the journal; where another trial is not worth its time, only if it is asked for `anyway`.
    ///
    /// # Errors
    /// All trials are told or running; nothing is left to gain; a strategy without an answer; a journal that cannot be written.
    pub fn ask(&mut self, anyway: bool) -> Result<Asked, CampaignError> {
        self.ask_as(anyway, |_| Ok(())).map(|(asked, ())| asked)
    }

    /// [`Self::ask`] with what is made of the parameters, before anything says that their trial runs: where `form` cannot take them, it does not (a change of
    /// the friction law that was due is kept).
    ///
    /// # Errors
    /// Those of [`Self::ask`] and of `form`.
    pub fn ask_as<T, E: From<CampaignError>>(
        &mut self,
        anyway: bool,
        form: impl FnOnce(&Asked) -> Result<T, E>,
    ) -> Result<(Asked, T), E> {
        let asked = self.proposed(anyway)?;
        let formed = form(&asked)?;
        self.begin(&asked)?;
        Ok((asked, formed))
    }

    /// The next parameters; no trial of theirs is in the journal.
    fn proposed(&mut self, anyway: bool) -> Result<Asked, CampaignError> {
        let total = self.tune.config.trials;
        let (told, in_flight) = (self.finished().count(), self.in_flight().count());
        if told + in_flight >= total {
            let message =
                format!("all {total} trials are told ({told}) or running ({in_flight}); --trials N makes it longer");
            return Err(FileError::Campaign { path: self.directory.clone(), message }.into());
        }
        let number = self.trials.iter().position(|entry| matches!(entry, Entry::Torn)).unwrap_or(self.trials.len());
        let fail = |source| CampaignError::Strategy { trial: number, source };
        if let Some(change) = self.better_law()? {
            self.change_law(&change)?;
        } else if let Some(stop) = self.ended()?.filter(|_| !anyway) {
            return Err(CampaignError::NothingToGain { campaign: self.directory.clone(), stop });
        }
        let (finished, running): (Vec<_>, Vec<_>) =
            (self.finished().cloned().collect(), self.in_flight().cloned().collect());
        let (Chooser { strategy, limit, .. }, logs) = (self.chooser()?, self.logs());
        let past = Past { finished: &finished, running: &running, allowed: None };
        let proposal = match strategy.design(number).map_err(fail)? {
            Some(proposal) => limit.hold_back(proposal, number, &logs),
            None => limit.proposal(strategy.as_ref(), number, past, &logs),
        };
        let Proposal { theta, origin } = proposal.map_err(fail)?;
        Ok(Asked { number, file: trial_compensator(&self.tune, number, &theta), theta, origin })
    }

    /// Marks the trial of these parameters as running.
    fn begin(&mut self, Asked { number, theta, origin, .. }: &Asked) -> Result<(), CampaignError> {
        let (number, origin) = (*number, *origin);
        if number == self.trials.len() {
            self.journal.create_trial()?;
        }
        // Parameters last: a trial is running once all of them are there.
        self.journal.set_attribute(number, "origin", &json!(origin))?;
        let (names, entries) = (self.tune.space.names(), self.tune.space.entries());
        let params = names.iter().zip(theta).zip(&entries);
        self.journal
            .set_params(number, params.map(|((name, value), (_, low, high))| (name.as_str(), *value, *low, *high)))?;
        self.set(number, Entry::Running(RunningTrial { number, theta: theta.clone() }, origin));
        Ok(())
    }

    /// The parameters of a running trial once more.
    ///
    /// # Errors
    /// A trial that does not run.
    pub fn asked(&self, number: usize) -> Result<Asked, CampaignError> {
        let (RunningTrial { theta, .. }, origin) = self.at(number)?;
        let file = trial_compensator(&self.tune, number, theta);
        Ok(Asked { number, theta: theta.clone(), origin, file })
    }

    /// Ends a running trial with what its log is worth; `failed` says why it was stopped, if it was.
    ///
    /// # Errors
    /// A trial that does not run; files that cannot be written.
    pub fn tell(&mut self, number: usize, judged: &JudgedLog<N>, failed: Option<&str>) -> Result<Told, CampaignError> {
        self.at(number)?;
        self.not_told_before(judged)?;
        let path = trial_log_path(&self.directory, number);
        write_trial_log(&path, &judged.log)?;
        let seal = seal_of(&path).map_err(FileError::io(&path))?;
        self.finish(number, judged.cost, Ended { aborted_at_s: judged.aborted_at_s, seal, reported: None }, failed)
    }

    /// An error where another trial was told with the same positions: no arm moves twice to the last bit of its encoders.
    fn not_told_before(&self, judged: &JudgedLog<N>) -> Result<(), CampaignError> {
        let logs = self.logs();
        for trial in self.finished() {
            if logs.log(trial.number)?.is_some_and(|told| told.q == judged.log.q) {
                let message =
                    format!("the positions of this log are those of trial {}, which has been told", trial.number);
                return Err(FileError::Campaign { path: self.directory.clone(), message }.into());
            }
        }
        Ok(())
    }

    /// Ends a running trial that failed and left no log: the full penalty.
    ///
    /// # Errors
    /// Those of [`Self::tell`].
    pub fn tell_failed(&mut self, number: usize, reason: &str) -> Result<Told, CampaignError> {
        let nothing_seen = CostAccumulator::default().finish(Some(0.0), self.user_trials.judged_s);
        self.finish(number, nothing_seen, Ended::default(), Some(reason))
    }

    /// Gives a running trial up: it counts for nothing, and its number is not used again.
    ///
    /// # Errors
    /// A trial that does not run; a journal that cannot be written.
    pub fn give_up(&mut self, number: usize) -> Result<(), CampaignError> {
        self.at(number)?;
        self.journal.finish(number, &[("given_up", Value::Bool(true))], TrialState::Fail, None)?;
        self.set(number, Entry::GivenUp);
        Ok(())
    }

    /// Takes a trial back that was told: it counts for nothing any more, and another one may be asked for in its place. The journal keeps
    /// what was told, and why it was taken back.
    ///
    /// # Errors
    /// A trial that was not told; a reason that is none; files that cannot be written.
    pub fn withdraw(&mut self, number: usize, reason: &str) -> Result<(), CampaignError> {
        let message = match self.trials.get(number) {
            Some(Entry::Finished(_)) if !reason.trim().is_empty() => {
                self.journal.withdraw(number, reason)?;
                self.set(number, Entry::Withdrawn);
                EarlyStop::leave(None, &self.directory)?;
                return self.refresh();
            }
            Some(Entry::Finished(_)) => "say why: --reason \"...\"".to_owned(),
            Some(Entry::Running(..)) => format!("trial {number} has not been told; to give it up: --give-up"),
            Some(Entry::GivenUp) => format!("trial {number} was given up: it counts for nothing"),
            Some(Entry::Withdrawn) => format!("trial {number} was withdrawn already"),
            Some(Entry::Torn) | None => format!("trial {number} has not been asked for"),
        };
        Err(FileError::Campaign { path: self.directory.clone(), message }.into())
    }

    fn finish(
        &mut self,
        number: usize,
        cost: Cost,
        ended: Ended<'_>,
        failed: Option<&str>,
    ) -> Result<Told, CampaignError> {
        let (RunningTrial { theta, .. }, origin) = self.at(number)?;
        let aborted = failed.map(reason);
        let trial = FinishedTrial { number, theta: theta.clone(), cost, aborted, origin };
        let reported = failed.filter(|_| aborted == Some(AbortReason::Reported));
        let ended = Ended { reported, ..ended };
        finish(&mut self.journal, &trial, &ended)?;
        self.seals.extend(ended.seal.map(|seal| (number, seal)));
        self.set(number, Entry::Finished(trial.clone()));
        let early_stop = self.early_stop()?;
        EarlyStop::leave(early_stop.as_ref(), &self.directory)?;
        self.refresh()?;
        let finished: Vec<FinishedTrial> = self.finished().cloned().collect();
        let conclusion = self.conclude(&finished)?;
        Ok(Told { trial, aborted_at_s: ended.aborted_at_s, conclusion, finished: finished.len(), early_stop })
    }

    /// Parameters of which the last logs speak for more than may be tried.
    pub fn beyond_box(&self) -> &[BeyondBox] {
        self.journal.study().conclusion.as_ref().map_or(&[], |conclusion| &conclusion.beyond_box)
    }

    /// What the logs say of the arm beside the best trial ([`Conclusion::remarks`]).
    pub fn remarks(&self) -> Vec<String> {
        let names = &self.tune.trial.model.joint_names;
        self.journal.study().conclusion.as_ref().map_or_else(Vec::new, |conclusion| conclusion.remarks(names))
    }

    /// The best trial so far.
    pub fn best(&self) -> Option<BestTrial> {
        Conclusion::best_of(self.journal.study().conclusion.as_ref(), self.finished())
    }

    /// What least squares on the last logs says of the friction, parameter by parameter; nothing before a log tells enough, or of a law
    /// whose parameters it does not know.
    ///
    /// # Errors
    /// An estimator that cannot be had, a log that cannot be read.
    pub fn learnt(&self) -> Result<Vec<Learnt>, CampaignError> {
        let fit = self.chooser()?.identification.before(self.trials.len(), &self.logs());
        let fit = fit.map_err(|source| self.no_answer(source))?;
        Ok(fit.map_or_else(Vec::new, |fit| Learnt::of(&self.tune.space, &fit)))
    }

    /// A running trial, and who chose its parameters.
    fn at(&self, number: usize) -> Result<(&RunningTrial, Origin), FileError> {
        let what = match self.trials.get(number) {
            Some(Entry::Running(trial, origin)) => return Ok((trial, *origin)),
            Some(Entry::Finished(_)) => "has been told already",
            Some(Entry::GivenUp) => "was given up",
            Some(Entry::Withdrawn) => "was withdrawn",
            Some(Entry::Torn) | None => "has not been asked for",
        };
        let running = self.running();
        let message = format!("trial {number} {what}; running: {}", numbers(&running));
        Err(FileError::Campaign { path: self.directory.clone(), message })
    }

    fn logs(&self) -> LogsThatCame<'_, N> {
        LogsThatCame { campaign: self, stored: StoredLogs::new(self.directory.clone(), self.seals.clone()) }
    }
}

impl Entry {
    fn of<const N: usize>(
        tune: &ValidTune<N>,
        path: &Path,
        number: usize,
        trial: &JournalTrial,
    ) -> Result<Self, FileError> {
        match trial.state {
            _ if trial.withdrawn.is_some() => Ok(Self::Withdrawn),
            TrialState::Fail => Ok(Self::GivenUp),
            TrialState::Complete | TrialState::Pruned => {
                Ok(Self::Finished(finished_trial(&tune.space, path, number, trial)?))
            }
            TrialState::Running | TrialState::Waiting => {
                let theta = theta(&tune.space, trial);
                let origin =
                    trial.attributes.get("origin").and_then(|value| serde_json::from_value(value.clone()).ok());
                Ok(match (theta, origin) {
                    (Ok(theta), Some(origin)) => Self::Running(RunningTrial { number, theta }, origin),
                    _ => Self::Torn,
                })
            }
        }
    }
}

/// The logs that have come back; a failed trial may have left none.
struct LogsThatCame<'a, const N: usize> {
    campaign: &'a UserCampaign<N>,
    stored: StoredLogs<N>,
}

impl<const N: usize> LogSource<N> for LogsThatCame<'_, N> {
    fn log(&self, number: usize) -> Result<Option<TrialLog<N>>, FileError> {
        match self.campaign.trials.get(number) {
            Some(Entry::Finished(trial)) => {
                let lost = trial.aborted.is_some() && !trial_log_path(&self.campaign.directory, number).exists();
                if lost { Ok(None) } else { self.stored.log(number) }
            }
            _ => Ok(None),
        }
    }
}

/// One of our own reasons, by its name, or another.
fn reason(words: &str) -> AbortReason {
    serde_json::from_value(json!(words)).unwrap_or(AbortReason::Reported)
}

/// `0, 3`, or `none`.
fn numbers(numbers: &[usize]) -> String {
    match numbers {
        [] => "none".to_owned(),
        _ => numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
    }
}
