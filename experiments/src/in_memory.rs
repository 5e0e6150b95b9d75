//! A campaign that never touches the disk.

use std::path::PathBuf;

use crate::files::FileError;
use crate::strategy::{FinishedTrial, LogSource};
use crate::{CampaignError, TrialLog, ValidTune, run_numbered};

/// Logs of a campaign that never touches the disk.
struct LogsInMemory<const N: usize>(Vec<TrialLog<N>>);

impl<const N: usize> LogSource<N> for LogsInMemory<N> {
    fn log(&self, number: usize) -> Result<TrialLog<N>, FileError> {
        self.0.get(number).cloned().ok_or_else(|| FileError::Campaign {
            path: PathBuf::new(),
            message: format!("trial {number} has not run yet"),
        })
    }
}

/// Runs all trials of a campaign one after the other, without directory, journal or reference costs.
pub fn run_in_memory<const N: usize>(tune: &ValidTune<N>) -> Result<Vec<FinishedTrial>, CampaignError> {
    let strategy = tune.config.strategy.build(tune).map_err(|source| CampaignError::Strategy { trial: 0, source })?;
    let (mut trials, mut logs) = (Vec::new(), LogsInMemory(Vec::new()));
    for number in 0..tune.config.trials {
        let fail = |source| CampaignError::Strategy { trial: number, source };
        let proposal = match strategy.design(number).map_err(fail)? {
            Some(proposal) => proposal,
            None => strategy.propose(number, &trials, &logs).map_err(fail)?,
        };
        let outcome = run_numbered(tune, number, &proposal.theta)?;
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
