//! Logs of the trials of a campaign.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use tribo_model::FileError;
use tribo_trial::{TrialLog, read_own_trial_log};

use crate::strategy::LogSource;

/// Logs of trials: the last few in memory, all on disk. Both hold the same bits.
pub(crate) struct StoredLogs<const N: usize> {
    directory: PathBuf,
    /// Seals of the logs that the journal knows, by trial.
    seals: BTreeMap<usize, String>,
    recent: Mutex<Vec<(usize, Arc<TrialLog<N>>)>>,
}

impl<const N: usize> StoredLogs<N> {
    /// Logs of the campaign in this directory, whose journal knows these seals of them.
    pub(crate) fn new(directory: PathBuf, seals: BTreeMap<usize, String>) -> Self {
        Self { directory, seals, recent: Mutex::new(Vec::new()) }
    }

    /// Keeps the log of a trial that has just been run.
    pub(crate) fn remember(&self, number: usize, log: Arc<TrialLog<N>>) {
        let mut recent = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        recent.push((number, log));
        if recent.len() > 4 {
            recent.remove(0);
        }
    }
}

impl<const N: usize> LogSource<N> for StoredLogs<N> {
    #[inline(never)]
    fn log(&self, number: usize) -> Result<Option<TrialLog<N>>, FileError> {
        let recent = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
        match recent.iter().find(|(held, _)| *held == number) {
            Some((_, log)) => Ok(Some(TrialLog::clone(log))),
            None => read_own_trial_log(&self.directory, number, self.seals.get(&number).map(String::as_str)).map(Some),
        }
    }
}
