//! Where snapshots come from: directories, logs, threads. The views never ask; they are handed a [`Snapshot`].

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use tribo_campaign::TuneConfig;
use tribo_campaign::journal::Clock;
use tribo_trial::EstimatorName;
use tribo_watch::{
    CampaignSnapshot, CampaignWatch, Surrogate, TrialColumns, TrialSnapshot, any_loop_times, write_report,
};

use crate::diagnosis_snapshot::{DiagnosisSnapshot, Progress};
use crate::jobs::Jobs;
use crate::live_feed::LiveFeed;
use crate::live_record::LiveRecord;
use crate::log_snapshot::{LogSnapshot, LogSource};
use crate::runner::{End, Runner};
use crate::snapshot::{Answer, Snapshot};
use crate::wrench_snapshot::WrenchSnapshot;

/// Time between two looks at the journal (s).
const POLL_S: f64 = 0.25;
/// Least time between two fits of the surrogate while trials run (s).
const SURROGATE_S: f64 = 10.0;
/// Part of one core's time that fits of the surrogate take at most while trials run: watching must not slow them.
const SURROGATE_SHARE: f64 = 0.01;

/// A journal that has not grown for so long (s) has nobody who writes it: a trial takes a second or two.
const SILENCE_S: f64 = 15.0;

/// What the open view shows and somebody has to work out; nothing else is worked on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// The surrogate model of the cost.
    pub surrogate: bool,
    /// The trial that is looked at.
    pub trial: bool,
    /// The trial without compensation, beside it.
    pub uncompensated: bool,
}

/// Opens, watches, runs.
#[derive(Debug)]
pub struct Source {
    snapshot: Snapshot,
    watch: Option<CampaignWatch>,
    other: Option<CampaignWatch>,
    live: Option<LiveRecord>,
    runner: Option<Runner>,
    jobs: Jobs,
    clock: Clock,
    selected: Option<usize>,
    uncompensated: Option<Arc<TrialColumns>>,
    uncompensated_pending: bool,
    /// Campaigns whose reference costs are being worked out.
    without_references: Vec<PathBuf>,
    surrogate_of: usize,
    surrogate_due_s: f64,
    surrogate_pending: bool,
    trial_pending: Option<usize>,
    estimating: Vec<EstimatorName>,
    diagnosing: Option<Arc<Progress>>,
    looked_at_s: f64,
    /// When the journal was last seen to grow (s).
    grown_at_s: f64,
    /// What is wrong, and what to do; shown until something else is opened.
    pub problem: Option<String>,
    /// The latest news.
    pub message: String,
}

impl Source {
    /// Nothing is open. `immediate` work is done in the frame that asks for it.
    pub fn new(clock: Clock, immediate: bool) -> Self {
        Self {
            snapshot: Snapshot::default(),
            watch: None,
            other: None,
            live: None,
            runner: None,
            jobs: Jobs::new(immediate),
            clock,
            selected: None,
            uncompensated: None,
            uncompensated_pending: false,
            without_references: Vec::new(),
            surrogate_of: 0,
            surrogate_due_s: f64::NEG_INFINITY,
            surrogate_pending: false,
            trial_pending: None,
            estimating: Vec::new(),
            diagnosing: None,
            looked_at_s: f64::NEG_INFINITY,
            grown_at_s: f64::NEG_INFINITY,
            problem: None,
            message: String::new(),
        }
    }

    /// What there is to show now.
    pub fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// The campaign that this window runs.
    pub fn runner(&mut self) -> Option<&mut Runner> {
        self.runner.as_mut()
    }

    /// Whether something is being worked on.
    pub fn busy(&self) -> bool {
        self.jobs.busy()
    }

    /// The diagnosis that is under way.
    pub fn diagnosing(&self) -> Option<&Progress> {
        self.diagnosing.as_deref()
    }

    /// Opens a campaign directory or a log.
    pub fn open(&mut self, ctx: &egui::Context, source: LogSource) {
        let path = source.path.clone();
        self.problem = None;
        if path.as_os_str().is_empty() || !path.exists() {
            let path = path.display();
            self.problem =
                Some(format!("{path}: there is no such file or directory. Give a campaign directory or a robot log."));
        } else if path.join("campaign.yaml").exists() {
            self.open_campaign(&path);
        } else {
            self.jobs.start(ctx, move || {
                let answer = LogSnapshot::read(&source).map(Arc::new);
                // A directory that is no log was meant as a campaign: say what a campaign has.
                Answer::Log(answer.map_err(|error| match CampaignWatch::open(&path) {
                    Err(campaign) if path.is_dir() => campaign.to_string(),
                    _ => error,
                }))
            });
            self.message = "reading the log …".to_owned();
        }
    }

    fn open_campaign(&mut self, directory: &Path) {
        let watch = match CampaignWatch::open(directory) {
            Ok(watch) => watch,
            Err(error) => {
                self.problem = Some(error.to_string());
                return;
            }
        };
        self.snapshot = Snapshot {
            log: self.snapshot.log.take(),
            wrenches: std::mem::take(&mut self.snapshot.wrenches),
            diagnosis: self.snapshot.diagnosis.take(),
            live: self.snapshot.live.take(),
            ..Snapshot::default()
        };
        (self.watch, self.selected, self.trial_pending) = (Some(watch), None, None);
        (self.uncompensated, self.uncompensated_pending) = (None, false);
        (self.surrogate_of, self.surrogate_due_s, self.surrogate_pending) = (0, f64::NEG_INFINITY, false);
        (self.looked_at_s, self.grown_at_s) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        self.message = format!("watching {}", directory.display());
    }

    /// Watches a robot.
    pub fn watch_live(&mut self, feed: LiveFeed) {
        self.message = format!("watching {}", feed.title().host);
        let record = LiveRecord::new(feed);
        self.snapshot.live = Some(Arc::new(record.snapshot()));
        self.live = Some(record);
    }

    /// Takes what the robot has sent since the last frame; whether more may come.
    pub fn hear(&mut self) -> bool {
        let Some(record) = &mut self.live else { return false };
        if let Some(live) = record.poll() {
            self.snapshot.live = Some(Arc::new(live));
        }
        self.snapshot.live.as_ref().is_none_or(|live| live.ended.is_none())
    }

    /// Starts a campaign and watches it.
    pub fn start(&mut self, config: TuneConfig, directory: &Path) {
        let tune = match config.validate_any() {
            Ok(tune) => tune,
            Err(error) => {
                self.problem = Some(error.to_string());
                return;
            }
        };
        match Runner::start(directory, tune, self.clock) {
            Ok(runner) => self.watch_runner(runner),
            Err(error) => self.problem = Some(error.to_string()),
        }
    }

    /// Goes on with the campaign that is open.
    pub fn resume(&mut self) {
        let Some(campaign) = self.snapshot.campaign.clone() else { return };
        match Runner::resume(&campaign.directory, self.clock) {
            Ok(runner) => self.watch_runner(runner),
            Err(error) => self.message = error.to_string(),
        }
    }

    fn watch_runner(&mut self, runner: Runner) {
        let directory = runner.directory.clone();
        self.runner = Some(runner);
        self.problem = None;
        self.open_campaign(&directory);
    }

    /// Whether somebody else runs the campaign that is open, as far as its journal tells at `now_s` (s).
    pub fn runs_elsewhere(&self, now_s: f64) -> bool {
        let here = self.runner.as_ref().map(|runner| &runner.directory);
        let open = self.snapshot.campaign.as_ref().map(|campaign| &campaign.directory);
        here != open && now_s - self.grown_at_s < SILENCE_S
    }

    /// Looks at one trial; `None` follows the best.
    pub fn select(&mut self, trial: Option<usize>) {
        self.selected = trial;
    }

    /// Whether the view follows the best trial.
    pub fn follows_best(&self) -> bool {
        self.selected.is_none()
    }

    /// Compares with the campaign in another directory.
    pub fn compare(&mut self, directory: &Path) -> Result<(), String> {
        let mut watch = CampaignWatch::open(directory).map_err(|error| error.to_string())?;
        self.snapshot.other = watch.poll().map_err(|error| error.to_string())?.map(Arc::new);
        self.other = Some(watch);
        Ok(())
    }

    /// Measures how long the loop takes here.
    pub fn measure_loop(&mut self, ctx: &egui::Context) {
        let Some(trial) = self.snapshot.trial.clone() else { return };
        self.jobs.start(ctx, move || {
            let finished = &trial.watched.trial;
            let times = any_loop_times(&trial.tune, &finished.theta).map(Arc::new);
            Answer::LoopTimes(finished.number, times.map_err(|error| error.to_string()))
        });
    }

    /// Runs an estimator along the log, unless that has been done or is being done.
    pub fn estimate(&mut self, ctx: &egui::Context, estimator: EstimatorName) {
        let Some(log) = self.snapshot.log.clone() else { return };
        if self.snapshot.wrench(estimator).is_some() || self.estimating.contains(&estimator) {
            return;
        }
        self.estimating.push(estimator);
        self.jobs.start(ctx, move || {
            let wrench = WrenchSnapshot::of(&log, estimator).map(Arc::new);
            Answer::Wrench(log, estimator, wrench)
        });
    }

    /// Asks what the model gets wrong about the log.
    pub fn diagnose(&mut self, ctx: &egui::Context) {
        let Some(log) = self.snapshot.log.clone() else { return };
        let progress = Arc::new(Progress::default());
        self.diagnosing = Some(Arc::clone(&progress));
        self.jobs.start(ctx, move || Answer::Diagnosis(DiagnosisSnapshot::of(&log, &progress).map(Arc::new)));
    }

    /// Writes the diagnosis into a directory, as `tribo diagnose --report` does.
    pub fn report_diagnosis(&mut self, ctx: &egui::Context, directory: &Path) {
        let Some(diagnosis) = self.snapshot.diagnosis.clone() else { return };
        let directory = directory.to_owned();
        self.jobs.start(ctx, move || Answer::Report(diagnosis.write_report(&directory)));
    }

    /// Gives a diagnosis up.
    pub fn cancel_diagnosis(&mut self) {
        if let Some(progress) = &self.diagnosing {
            progress.cancel();
        }
    }

    /// Writes `report.html`.
    pub fn report(&mut self, ctx: &egui::Context) {
        let Some(campaign) = self.snapshot.campaign.clone() else { return };
        self.message = "writing the report …".to_owned();
        self.jobs.start(ctx, move || {
            Answer::Report(write_report(&campaign.directory, None, true).map_err(|error| error.to_string()))
        });
    }

    /// Takes in what has happened and starts what the open view needs; `now_s` is the time of the frame (s).
    pub fn update(&mut self, ctx: &egui::Context, now_s: f64, needs: Needs) {
        for answer in self.jobs.finished() {
            self.take(answer, now_s);
        }
        if let Some(end) = self.runner.as_ref().and_then(Runner::end) {
            self.message = match end {
                End::Finished => "the campaign has finished".to_owned(),
                End::Stopped => "the campaign has stopped; Resume goes on".to_owned(),
                End::Failed(why) => why,
            };
            self.runner = None;
            self.looked_at_s = f64::NEG_INFINITY;
        }
        if now_s - self.looked_at_s >= POLL_S {
            self.looked_at_s = now_s;
            self.look(now_s);
        }
        self.ask_references(ctx);
        self.ask(ctx, now_s, needs);
    }

    /// A look at the journals.
    fn look(&mut self, now_s: f64) {
        match self.watch.as_mut().map(CampaignWatch::poll) {
            Some(Ok(Some(campaign))) => {
                let grown = |before: &Arc<CampaignSnapshot>| {
                    (before.trials.len(), &before.running) != (campaign.trials.len(), &campaign.running)
                };
                if self.snapshot.campaign.as_ref().is_some_and(grown) {
                    self.grown_at_s = now_s;
                }
                self.snapshot.campaign = Some(Arc::new(campaign));
            }
            Some(Err(error)) => self.problem = Some(error.to_string()),
            Some(Ok(None)) | None => {}
        }
        if let Some(Ok(Some(other))) = self.other.as_mut().map(CampaignWatch::poll) {
            self.snapshot.other = Some(Arc::new(other));
        }
    }

    /// Works out the reference costs of campaigns that have not left them in their directory: a running one leaves them there
    /// before its first trial has finished.
    fn ask_references(&mut self, ctx: &egui::Context) {
        let shown = [self.snapshot.campaign.clone(), self.snapshot.other.clone()];
        for campaign in shown.into_iter().flatten() {
            let known = campaign.references.is_some()
                || campaign.trials_by_user()
                || self.without_references.contains(&campaign.directory);
            if known || campaign.trials.is_empty() {
                continue;
            }
            self.without_references.push(campaign.directory.clone());
            self.jobs.start(ctx, move || {
                let costs = campaign.tune.references().map_err(|error| error.to_string());
                Answer::References(campaign.directory.clone(), costs)
            });
        }
    }

    /// The trial that is looked at, whether it has been read or not.
    pub fn wanted(&self) -> Option<usize> {
        let best = || self.snapshot.campaign.as_ref()?.best().map(|best| best.trial.number);
        self.selected.or_else(best)
    }

    /// Starts the work that the open view still lacks.
    fn ask(&mut self, ctx: &egui::Context, now_s: f64, needs: Needs) {
        let Some(campaign) = self.snapshot.campaign.clone() else { return };
        let done = campaign.trials.len();
        if needs.uncompensated && self.uncompensated.is_none() && !self.uncompensated_pending && done > 0 {
            self.uncompensated_pending = true;
            let campaign = Arc::clone(&campaign);
            self.jobs.start(ctx, move || {
                let without = campaign.uncompensated().map(|known| known.map(Arc::new));
                Answer::Uncompensated(campaign.directory.clone(), without.map_err(|error| error.to_string()))
            });
        }
        let wanted = self.wanted();
        let shown = self.snapshot.trial.as_ref().map(|trial| trial.watched.trial.number);
        let stale = self.uncompensated.is_some()
            && self.snapshot.trial.as_ref().is_some_and(|trial| trial.uncompensated.is_none());
        if needs.trial
            && let Some(watched) = wanted.and_then(|number| campaign.trial(number))
            && self.trial_pending != wanted
            && (shown != wanted || stale)
        {
            self.trial_pending = wanted;
            let (directory, tune, watched) = (campaign.directory.clone(), Arc::clone(&campaign.tune), watched.clone());
            let without = self.uncompensated.clone();
            self.jobs.start(ctx, move || {
                let trial = TrialSnapshot::read(&directory, tune, watched, without).map(Arc::new);
                Answer::Trial(directory, trial.map_err(|error| error.to_string()))
            });
        }
        let due = campaign.is_complete() || now_s >= self.surrogate_due_s;
        if needs.surrogate && done > self.surrogate_of && due && !self.surrogate_pending {
            (self.surrogate_of, self.surrogate_pending) = (done, true);
            self.jobs.start(ctx, move || {
                let started = Instant::now();
                // A kernel matrix beyond repair leaves the view without a surrogate model.
                let surrogate = Surrogate::of(&campaign).ok().flatten().map(Arc::new);
                Answer::Surrogate(campaign.directory.clone(), surrogate, started.elapsed().as_secs_f64())
            });
        }
    }

    fn take(&mut self, answer: Answer, now_s: f64) {
        let directory = self.snapshot.campaign.as_ref().map(|campaign| campaign.directory.clone());
        let watched = |path: &PathBuf| directory.as_ref().is_none_or(|directory| directory == path);
        match answer {
            Answer::References(path, Ok(costs)) => {
                let watches = [&mut self.watch, &mut self.other].into_iter().flatten();
                for watch in watches.filter(|watch| watch.directory() == path) {
                    watch.set_references(costs);
                }
                self.looked_at_s = f64::NEG_INFINITY;
            }
            Answer::References(_, Err(error)) => self.message = error,
            Answer::Uncompensated(path, known) if watched(&path) => match known {
                Ok(without) => self.uncompensated = without,
                Err(error) => self.message = error,
            },
            Answer::Surrogate(path, surrogate, spent_s) if watched(&path) => {
                self.surrogate_pending = false;
                self.surrogate_due_s = now_s + SURROGATE_S.max(spent_s / SURROGATE_SHARE);
                self.snapshot.surrogate = surrogate;
            }
            Answer::Trial(path, trial) if watched(&path) => {
                self.trial_pending = None;
                match trial {
                    Ok(trial) => (self.snapshot.trial, self.snapshot.loop_times) = (Some(trial), None),
                    Err(error) => {
                        // Asked for once: a missing log does not come back.
                        self.trial_pending = self.selected;
                        self.message = error;
                    }
                }
            }
            // Of a campaign that is no longer open.
            Answer::Uncompensated(..) | Answer::Surrogate(..) | Answer::Trial(..) => {}
            Answer::LoopTimes(number, times) => {
                let shown = self.snapshot.trial.as_ref().map(|trial| trial.watched.trial.number);
                match times {
                    Ok(times) if shown == Some(number) => self.snapshot.loop_times = Some(times),
                    Ok(_) => {}
                    Err(error) => self.problem = Some(error),
                }
            }
            Answer::Log(Ok(log)) => {
                self.message = format!("read {}", log.source.path.display());
                (self.snapshot.log, self.snapshot.diagnosis) = (Some(log), None);
                self.snapshot.wrenches.clear();
                self.estimating.clear();
            }
            Answer::Log(Err(error)) => (self.problem, self.message) = (Some(error), String::new()),
            Answer::Wrench(log, estimator, wrench) => {
                if self.snapshot.log.as_ref().is_some_and(|shown| Arc::ptr_eq(shown, &log)) {
                    self.estimating.retain(|name| *name != estimator);
                    self.snapshot.wrenches.push((estimator, wrench));
                }
            }
            Answer::Diagnosis(found) => {
                self.diagnosing = None;
                match found {
                    Ok(diagnosis) => self.snapshot.diagnosis = Some(diagnosis),
                    Err(error) => self.message = error,
                }
            }
            Answer::Report(Ok(path)) => self.message = format!("written {}", path.display()),
            Answer::Report(Err(error)) => self.message = error,
        }
    }
}
