//! A campaign in a thread of its own.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};

use tribo_campaign::journal::Clock;
use tribo_campaign::{AnyTune, Campaign, CampaignError, CampaignObserver, Changes, TuneConfig};

/// What the window wants of the thread.
#[derive(Debug, Default)]
struct Wish {
    paused: Mutex<bool>,
    changed: Condvar,
    stop: AtomicBool,
}

struct Obedient(Arc<Wish>);

impl CampaignObserver for Obedient {
    /// Asked between trials: waits while paused.
    fn stop_requested(&mut self) -> bool {
        let mut paused = self.0.paused.lock().unwrap_or_else(PoisonError::into_inner);
        while *paused && !self.0.stop.load(Ordering::SeqCst) {
            paused = self.0.changed.wait(paused).unwrap_or_else(PoisonError::into_inner);
        }
        self.0.stop.load(Ordering::SeqCst)
    }
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// All trials are done.
    Finished,
    /// Somebody stopped it; it can be resumed.
    Stopped,
    /// It cannot go on.
    Failed(String),
}

/// A running campaign. The window sees of it what anybody sees: its directory.
#[derive(Debug)]
pub struct Runner {
    /// Directory of the campaign.
    pub directory: PathBuf,
    wish: Arc<Wish>,
    end: Receiver<End>,
    paused: bool,
}

impl Runner {
    /// Starts a new campaign.
    ///
    /// # Errors
    /// The directory cannot be used.
    pub fn start(directory: &Path, tune: AnyTune, clock: Clock) -> Result<Self, CampaignError> {
        Ok(match tune {
            AnyTune::Six(tune) => Self::run(directory, Campaign::create(directory, tune, clock)?),
            AnyTune::Seven(tune) => Self::run(directory, Campaign::create(directory, tune, clock)?),
        })
    }

    /// Goes on with a campaign.
    ///
    /// # Errors
    /// It is running already, or damaged.
    pub fn resume(directory: &Path, clock: Clock) -> Result<Self, CampaignError> {
        Ok(match TuneConfig::joints_of_campaign(directory)? {
            6 => Self::run(directory, Campaign::<6>::resume(directory, Changes::default(), clock)?),
            _ => Self::run(directory, Campaign::<7>::resume(directory, Changes::default(), clock)?),
        })
    }

    fn run<const N: usize>(directory: &Path, campaign: Campaign<N>) -> Self {
        let wish = Arc::new(Wish::default());
        let (sender, end) = channel();
        let mut observer = Obedient(Arc::clone(&wish));
        std::thread::spawn(move || {
            let end = match campaign.run(&mut observer) {
                Ok(_) => End::Finished,
                Err(CampaignError::Stopped { .. }) => End::Stopped,
                Err(error) => End::Failed(error.to_string()),
            };
            // A window that is gone does not mind.
            let _ = sender.send(end);
        });
        Self { directory: directory.to_owned(), wish, end, paused: false }
    }

    /// Whether it waits between two trials.
    pub fn is_paused(&self) -> bool {
        self.paused
    }

    /// Waits before the next trial, or goes on.
    pub fn set_paused(&mut self, paused: bool) {
        self.paused = paused;
        *self.wish.paused.lock().unwrap_or_else(PoisonError::into_inner) = paused;
        self.wish.changed.notify_all();
    }

    /// Ends after the trials that are running.
    pub fn stop(&self) {
        self.wish.stop.store(true, Ordering::SeqCst);
        // The lock orders this wish before the next look at it.
        drop(self.wish.paused.lock().unwrap_or_else(PoisonError::into_inner));
        self.wish.changed.notify_all();
    }

    /// How it ended, once it has.
    pub fn end(&self) -> Option<End> {
        match self.end.try_recv() {
            Ok(end) => Some(end),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(End::Failed("the campaign's thread is gone".to_owned())),
        }
    }
}

impl Drop for Runner {
    /// A closed window stops its campaign; finished trials are safe, and `tribo tune --resume` goes on.
    fn drop(&mut self) {
        self.stop();
    }
}
