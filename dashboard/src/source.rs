//! Where snapshots come from: directories, logs, threads. The views never ask; they are handed a [`Snapshot`].

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use tribo_diagnose::{DiagnoseSettings, diagnose};
use tribo_experiments::journal::Clock;
use tribo_experiments::watch::{CampaignWatch, Surrogate, TrialSnapshot, loop_times, write_report};
use tribo_experiments::{TrialLog, TuneConfig, references, uncompensated_trial};

use crate::jobs::Jobs;
use crate::log_snapshot::{LogSnapshot, LogSource};
use crate::runner::{End, Runner};
use crate::snapshot::{Answer, DiagnosisSnapshot, Snapshot};

/// Time between two looks at the journal (s).
const POLL_S: f64 = 0.25;
/// Least time between two fits of the surrogate while trials run (s): watching must not slow them.
const SURROGATE_S: f64 = 10.0;

/// How far a diagnosis is.
#[derive(Debug, Default)]
pub struct Progress {
    stage: Mutex<String>,
    permille: AtomicU64,
    cancelled: AtomicBool,
}

impl Progress {
    /// Stage and part, 0 to 1.
    pub fn now(&self) -> (String, f32) {
        let stage = self.stage.lock().unwrap_or_else(PoisonError::into_inner).clone();
        (stage, self.permille.load(Ordering::Relaxed) as f32 / 1000.0)
    }
}

/// Opens, watches, runs.
#[derive(Debug)]
pub struct Source {
    snapshot: Snapshot,
    watch: Option<CampaignWatch>,
    other: Option<CampaignWatch>,
    runner: Option<Runner>,
    jobs: Jobs,
    clock: Clock,
    selected: Option<usize>,
    uncompensated: Option<Arc<TrialLog<7>>>,
    surrogate_of: usize,
    surrogate_at_s: f64,
    surrogate_pending: bool,
    trial_pending: Option<usize>,
    diagnosing: Option<Arc<Progress>>,
    looked_at_s: f64,
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
            runner: None,
            jobs: Jobs::new(immediate),
            clock,
            selected: None,
            uncompensated: None,
            surrogate_of: 0,
            surrogate_at_s: f64::NEG_INFINITY,
            surrogate_pending: false,
            trial_pending: None,
            diagnosing: None,
            looked_at_s: f64::NEG_INFINITY,
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
            self.open_campaign(ctx, &path);
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

    fn open_campaign(&mut self, ctx: &egui::Context, directory: &Path) {
        let watch = match CampaignWatch::open(directory) {
            Ok(watch) => watch,
            Err(error) => {
                self.problem = Some(error.to_string());
                return;
            }
        };
        let (tune, directory) = (Arc::clone(watch.tune()), directory.to_owned());
        self.snapshot = Snapshot {
            log: self.snapshot.log.take(),
            diagnosis: self.snapshot.diagnosis.take(),
            ..Snapshot::default()
        };
        (self.watch, self.selected, self.uncompensated) = (Some(watch), None, None);
        (self.surrogate_of, self.surrogate_at_s, self.trial_pending) = (0, f64::NEG_INFINITY, None);
        (self.looked_at_s, self.surrogate_pending) = (f64::NEG_INFINITY, false);
        self.message = format!("watching {}", directory.display());
        self.jobs.start(ctx, move || {
            let known = references(&tune).and_then(|costs| Ok((costs, Arc::new(uncompensated_trial(&tune)?.log))));
            Answer::References(directory, known.map_err(|error| error.to_string()))
        });
    }

    /// Starts a campaign and watches it.
    pub fn start(&mut self, ctx: &egui::Context, config: TuneConfig, directory: &Path) {
        let tune = match config.validate() {
            Ok(tune) => tune,
            Err(error) => {
                self.problem = Some(error.to_string());
                return;
            }
        };
        match Runner::start(directory, tune, self.clock) {
            Ok(runner) => self.watch_runner(ctx, runner),
            Err(error) => self.problem = Some(error.to_string()),
        }
    }

    /// Goes on with the campaign that is open.
    pub fn resume(&mut self, ctx: &egui::Context) {
        let Some(campaign) = self.snapshot.campaign.clone() else { return };
        match Runner::resume(&campaign.directory, self.clock) {
            Ok(runner) => self.watch_runner(ctx, runner),
            Err(error) => self.message = error.to_string(),
        }
    }

    fn watch_runner(&mut self, ctx: &egui::Context, runner: Runner) {
        let directory = runner.directory.clone();
        self.runner = Some(runner);
        self.problem = None;
        self.open_campaign(ctx, &directory);
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
        watch.set_references(references(watch.tune()).map_err(|error| error.to_string())?);
        self.snapshot.other = watch.poll().map_err(|error| error.to_string())?.map(Arc::new);
        self.other = Some(watch);
        Ok(())
    }

    /// Measures how long the loop takes here.
    pub fn measure_loop(&mut self, ctx: &egui::Context) {
        let Some(trial) = self.snapshot.trial.clone() else { return };
        self.jobs.start(ctx, move || {
            let finished = &trial.watched.trial;
            let times = loop_times(&trial.tune, &finished.theta).map(Arc::new);
            Answer::LoopTimes(finished.number, times.map_err(|error| error.to_string()))
        });
    }

    /// Asks what the model gets wrong about the log.
    pub fn diagnose(&mut self, ctx: &egui::Context) {
        let Some(log) = self.snapshot.log.clone() else { return };
        let progress = Arc::new(Progress::default());
        self.diagnosing = Some(Arc::clone(&progress));
        self.jobs.start(ctx, move || {
            let report = |stage: &str, part: f64| {
                stage.clone_into(&mut progress.stage.lock().unwrap_or_else(PoisonError::into_inner));
                progress.permille.store((1000.0 * part.clamp(0.0, 1.0)) as u64, Ordering::Relaxed);
                !progress.cancelled.load(Ordering::Relaxed)
            };
            let name = log.source.path.display().to_string();
            let settings = DiagnoseSettings { seed: 0, band_hz: None };
            let found = diagnose(std::slice::from_ref(&log.log), &log.model.to_nominal(), &[], &settings, &report);
            let snapshot = found.map(|diagnosis| Arc::new(DiagnosisSnapshot { log: name.clone(), diagnosis }));
            Answer::Diagnosis(snapshot.map_err(|error| format!("{name}: {error}")))
        });
    }

    /// Gives a diagnosis up.
    pub fn cancel_diagnosis(&mut self) {
        if let Some(progress) = &self.diagnosing {
            progress.cancelled.store(true, Ordering::Relaxed);
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

    /// Takes in what has happened; `now_s` is the time of the frame (s).
    pub fn update(&mut self, ctx: &egui::Context, now_s: f64) {
        for answer in self.jobs.finished() {
            self.take(answer);
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
            self.look();
        }
        self.ask(ctx, now_s);
    }

    /// A look at the journals.
    fn look(&mut self) {
        match self.watch.as_mut().map(CampaignWatch::poll) {
            Some(Ok(Some(campaign))) => self.snapshot.campaign = Some(Arc::new(campaign)),
            Some(Err(error)) => self.problem = Some(error.to_string()),
            Some(Ok(None)) | None => {}
        }
        if let Some(Ok(Some(other))) = self.other.as_mut().map(CampaignWatch::poll) {
            self.snapshot.other = Some(Arc::new(other));
        }
    }

    /// Starts the work that the snapshot still lacks.
    fn ask(&mut self, ctx: &egui::Context, now_s: f64) {
        let Some(campaign) = self.snapshot.campaign.clone() else { return };
        let done = campaign.trials.len();
        let wanted = self.selected.or_else(|| campaign.best().map(|best| best.trial.number));
        let shown = self.snapshot.trial.as_ref().map(|trial| trial.watched.trial.number);
        let stale = self.uncompensated.is_some()
            && self.snapshot.trial.as_ref().is_some_and(|trial| trial.uncompensated.is_none());
        if let Some(watched) = wanted.and_then(|number| campaign.trial(number))
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
        let due = campaign.is_complete() || now_s - self.surrogate_at_s >= SURROGATE_S;
        if done > self.surrogate_of && due && !self.surrogate_pending {
            (self.surrogate_of, self.surrogate_at_s, self.surrogate_pending) = (done, now_s, true);
            self.jobs.start(ctx, move || {
                // A kernel matrix beyond repair leaves the view without a belief.
                let surrogate = Surrogate::of(&campaign).ok().flatten().map(Arc::new);
                Answer::Surrogate(campaign.directory.clone(), surrogate)
            });
        }
    }

    fn take(&mut self, answer: Answer) {
        let directory = self.snapshot.campaign.as_ref().map(|campaign| campaign.directory.clone());
        let watched = |path: &PathBuf| directory.as_ref().is_none_or(|directory| directory == path);
        match answer {
            Answer::References(path, known) if watched(&path) => match known {
                Ok((costs, without)) => {
                    if let Some(watch) = &mut self.watch {
                        watch.set_references(costs);
                    }
                    self.uncompensated = Some(without);
                    self.looked_at_s = f64::NEG_INFINITY;
                }
                Err(error) => self.problem = Some(error),
            },
            Answer::Surrogate(path, surrogate) if watched(&path) => {
                self.surrogate_pending = false;
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
            Answer::References(..) | Answer::Surrogate(..) | Answer::Trial(..) => {}
            Answer::LoopTimes(number, times) => {
                let shown = self.snapshot.trial.as_ref().map(|trial| trial.watched.trial.number);
                match times {
                    Ok(times) if shown == Some(number) => self.snapshot.loop_times = Some(times),
                    Ok(_) => {}
                    Err(error) => self.problem = Some(error),
                }
            }
            Answer::Log(Ok(log)) => {
                self.message = format!("log {}", log.source.path.display());
                (self.snapshot.log, self.snapshot.diagnosis) = (Some(log), None);
            }
            Answer::Log(Err(error)) => (self.problem, self.message) = (Some(error), String::new()),
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
