//! What is held out when models are asked about motion that they were not fitted to.

use crate::problem::Problem;

/// How parts are held out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Each log in turn.
    Logs,
    /// Each third of the one log in turn.
    Thirds,
}

impl Split {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Logs => "each log in turn",
            Self::Thirds => "each third of the log in turn",
        }
    }
}

/// Thirds of a single log.
pub const THIRDS: usize = 3;

/// The folds: parts that are held out together. Logs without payload are never held out: they show nothing of it.
pub(crate) fn folds(problem: &Problem) -> (Split, Vec<Vec<usize>>) {
    let parts = &problem.columns.parts;
    let logs = parts.iter().map(|part| part.log).max().map_or(0, |log| log + 1);
    let loaded: Vec<usize> = (0..logs).filter(|log| !problem.unloaded[*log]).collect();
    if loaded.len() > 1 {
        let of = |log: &usize| (0..parts.len()).filter(|part| parts[*part].log == *log).collect();
        return (Split::Logs, loaded.iter().map(of).collect());
    }
    let own: Vec<usize> = (0..parts.len()).filter(|part| loaded.contains(&parts[*part].log)).collect();
    let edge = |k: usize| k * own.len() / THIRDS;
    (Split::Thirds, (0..THIRDS).map(|k| own[edge(k)..edge(k + 1)].to_vec()).collect())
}
