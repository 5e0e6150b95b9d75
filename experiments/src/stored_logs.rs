//! Logs of the trials of a campaign.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use crate::TrialLog;
use crate::files::FileError;
use crate::strategy::LogSource;
use crate::trial_store::{read_trial_log, trial_log_path};

/// Logs of trials: the last few in memory, all on disk. Both hold the same bits.
pub(crate) struct StoredLogs {
    directory: PathBuf,
    recent: Mutex<Vec<(usize, TrialLog<7>)>>,
}

impl StoredLogs {
    /// Logs of the campaign in this directory.
    pub(crate) fn new(directory: PathBuf) -> Self {
        Self { directory, recent: Mutex::new(Vec::new()) }
    }

    /// Keeps the log of a trial that has just been written.
    pub(crate) fn remember(&self, number: usize, log: TrialLog<7>) {
        let mut recent = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        recent.push((number, log));
        if recent.len() > 4 {
            recent.remove(0);
        }
    }
}

impl LogSource for StoredLogs {
    fn log(&self, number: usize) -> Result<TrialLog<7>, FileError> {
        let recent = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        match recent.iter().find(|(held, _)| *held == number) {
            Some((_, log)) => Ok(log.clone()),
            None => read_trial_log(&trial_log_path(&self.directory, number)),
        }
    }
}
