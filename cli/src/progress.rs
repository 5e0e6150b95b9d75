//! Progress on standard error, and the wish to stop.

use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{ProgressBar, ProgressStyle};
use tribo_campaign::strategy::FinishedTrial;
use tribo_campaign::study::{Cell, StudyProgress};
use tribo_campaign::{CampaignObserver, References};

/// Set by Ctrl-C and SIGTERM: the campaign ends after the trials that are running.
static STOP: AtomicBool = AtomicBool::new(false);

/// Ends the campaign cleanly on the first Ctrl-C or SIGTERM. A second one kills, which loses nothing either.
pub fn stop_on_signal() {
    let handler = || {
        if STOP.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
    };
    // Without a handler the signal kills the process, and --resume goes on as after any other kill.
    let _ = ctrlc::set_handler(handler);
}

/// Whether a signal asked to stop.
pub fn stop_requested() -> &'static AtomicBool {
    &STOP
}

/// A progress bar that shows the incumbent. Hidden when standard error is not a terminal or `--quiet` is given.
pub struct TrialProgress {
    bar: ProgressBar,
    quiet: bool,
    best: f64,
    oracle: f64,
    failed: usize,
}

impl TrialProgress {
    /// A bar for `trials` trials, `finished` of which are done.
    pub fn new(trials: usize, finished: usize, quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(trials as u64) };
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos:>4}/{len} trials  {elapsed}  {msg}") {
            bar.set_style(style);
        }
        bar.set_position(finished as u64);
        Self { bar, quiet, best: f64::INFINITY, oracle: f64::NAN, failed: 0 }
    }

    /// Takes the bar off the screen.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl CampaignObserver for TrialProgress {
    fn references(&mut self, references: &References) {
        self.oracle = references.oracle;
        if let Some(remark) = references.remark().filter(|_| !self.quiet) {
            self.bar.suspend(|| message!("tribo: {remark}"));
        }
        self.bar.set_message(format!("uncompensated J {:.2}", references.uncompensated));
    }

    fn trial_finished(&mut self, trial: &FinishedTrial) {
        match trial.aborted {
            None => self.best = self.best.min(trial.cost.total()),
            Some(_) => self.failed += 1,
        }
        let failed = if self.failed > 0 { format!(", {} failed", self.failed) } else { String::new() };
        self.bar.set_message(format!("best J {:.2} (oracle {:.2}){failed}", self.best, self.oracle));
        self.bar.inc(1);
    }

    fn stop_requested(&mut self) -> bool {
        STOP.load(Ordering::SeqCst)
    }
}

/// A progress bar over the cells of a study. Hidden when standard error is not a terminal or `--quiet` is given.
pub struct CellProgress {
    bar: ProgressBar,
}

impl CellProgress {
    /// A bar that does not know its length yet.
    pub fn new(quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(0) };
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} cells  {elapsed}  eta {eta}") {
            bar.set_style(style);
        }
        Self { bar }
    }

    /// Takes the bar off the screen.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl StudyProgress for CellProgress {
    fn begin(&mut self, cells: usize, finished: usize) {
        self.bar.set_length(cells as u64);
        self.bar.set_position(finished as u64);
        // What was there before says nothing about the time to come.
        self.bar.reset_eta();
    }

    fn finished(&mut self, _cell: &Cell) {
        self.bar.inc(1);
    }

    fn stop_requested(&mut self) -> bool {
        STOP.load(Ordering::SeqCst)
    }
}

/// A progress bar for one computation in stages; clones share it. Hidden when standard error is not a terminal or `--quiet` is given.
#[derive(Clone)]
pub struct StageProgress {
    bar: ProgressBar,
}

impl StageProgress {
    /// Steps of the bar.
    const STEPS: u64 = 1000;

    /// A bar at its beginning.
    pub fn new(quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(Self::STEPS) };
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {elapsed}  {msg}") {
            bar.set_style(style);
        }
        Self { bar }
    }

    /// Shows a stage and the part that is done, 0 to 1; false if the computation shall stop.
    pub fn stage(&self, stage: &str, part: f64) -> bool {
        self.bar.set_message(stage.to_owned());
        self.bar.set_position((part.clamp(0.0, 1.0) * Self::STEPS as f64) as u64);
        !self.stopped()
    }

    /// Whether Ctrl-C or SIGTERM has come.
    pub fn stopped(&self) -> bool {
        STOP.load(Ordering::SeqCst)
    }

    /// Takes the bar off the screen.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
