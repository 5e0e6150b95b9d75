//! A campaign that never touches the disk.

use std::sync::Arc;

use crate::files::FileError;
use crate::friction_limit::FrictionLimit;
use crate::strategy::{FinishedTrial, Identification, LogSource, Past, RunningTrial};
use crate::{CampaignError, TrialLog, ValidTune, run_numbered};

/// Logs of a campaign that never touches the disk.
struct LogsInMemory<const N: usize>(Vec<TrialLog<N>>);

impl<const N: usize> LogSource<N> for LogsInMemory<N> {
    fn log(&self, number: usize) -> Result<Option<TrialLog<N>>, FileError> {
        Ok(self.0.get(number).cloned())
    }
}

/// Runs all trials of a campaign one after the other, without directory, journal or reference costs.
pub fn run_in_memory<const N: usize>(tune: &ValidTune<N>) -> Result<Vec<FinishedTrial>, CampaignError> {
    let fail = |source| CampaignError::Strategy { trial: 0, source };
    let identification = Arc::new(Identification::new(tune).map_err(fail)?);
    let strategy = tune.config.strategy.build(tune, &identification).map_err(fail)?;
    let limit = FrictionLimit::of(tune, &identification);
    let (mut trials, mut logs): (Vec<FinishedTrial>, _) = (Vec::new(), LogsInMemory(Vec::new()));
    for number in 0..tune.config.trials {
        let fail = |source| CampaignError::Strategy { trial: number, source };
        let proposal = match strategy.design(number).map_err(fail)? {
            Some(proposal) => limit.hold_back_design(proposal, number, &logs),
            None => {
                let (finished, batch) = trials.split_at(tune.config.batches().of(number).start);
                let running: Vec<RunningTrial> = batch.iter().map(RunningTrial::from).collect();
                let past = Past { finished, running: &running, ..Past::default() };
                limit.proposal(strategy.as_ref(), number, past, &logs)
            }
        }
        .map_err(fail)?;
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
