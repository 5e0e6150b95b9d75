//! A campaign that never touches the disk.

use tribo_model::FileError;
use tribo_trial::TrialLog;

use crate::chooser::Chooser;
use crate::strategy::{FinishedTrial, LawChange, LogSource, Past, RunningTrial};
use crate::{CampaignError, Conclusion, EarlyStop, ParameterSpace, ValidTune, run_numbered};

/// Logs of a campaign that never touches the disk.
struct LogsInMemory<const N: usize>(Vec<TrialLog<N>>);

impl<const N: usize> LogSource<N> for LogsInMemory<N> {
    #[inline(never)]
    fn log(&self, number: usize) -> Result<Option<TrialLog<N>>, FileError> {
        Ok(self.0.get(number).cloned())
    }
}

/// What came of a campaign that left nothing on the disk.
#[derive(Clone, Debug)]
pub struct InMemory {
    /// Its trials, by number.
    pub trials: Vec<FinishedTrial>,
    /// The best trial, and the check of the friction law.
    pub conclusion: Conclusion,
    /// The space that the trials are in.
    pub space: ParameterSpace,
    /// The friction law that it went over to, if it did.
    pub law_change: Option<LawChange>,
    /// Why it ended before its last trial, if it did.
    pub early_stop: Option<EarlyStop>,
}

/// Runs the trials of a campaign one after the other, without directory, journal or reference costs.
///
/// # Errors
/// A strategy without an answer, parameters that the estimator cannot work with.
pub fn run_in_memory<const N: usize>(tune: &ValidTune<N>) -> Result<InMemory, CampaignError> {
    let fail = |source| CampaignError::Strategy { trial: 0, source };
    let (mut tune, mut law_change) = (tune.clone(), None);
    let mut chooser = Chooser::of(&tune).map_err(fail)?;
    let (mut trials, mut logs): (Vec<FinishedTrial>, _) = (Vec::new(), LogsInMemory(Vec::new()));
    let mut early_stop = None;
    for number in 0..tune.config.trials {
        let fail = |source| CampaignError::Strategy { trial: number, source };
        let begins_batch = tune.config.batches().of(number).start == number;
        let past = Past { finished: &trials, ..Past::default() };
        let better = if begins_batch { chooser.strategy.better_law(past, &logs).map_err(fail)? } else { None };
        if let Some(change) = better {
            tune.change_law_of(trials.iter_mut().map(|trial| &mut trial.theta), change.law);
            chooser = Chooser::of(&tune).map_err(fail)?;
            law_change = Some(change);
        } else if begins_batch {
            early_stop = chooser.ends_before(number, &tune, &trials, &logs).map_err(fail)?;
            if early_stop.is_some() {
                break;
            }
        }
        let Chooser { strategy, limit, .. } = &chooser;
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
        let outcome = run_numbered(&tune, number, &proposal.theta)?;
        trials.push(FinishedTrial {
            number,
            theta: proposal.theta,
            cost: outcome.cost,
            aborted: outcome.aborted,
            origin: proposal.origin,
        });
        logs.0.push(outcome.log);
    }
    let conclusion = Conclusion::of(&tune, &chooser, &trials, &logs).map_err(fail)?;
    Ok(InMemory { trials, conclusion, early_stop, law_change, space: tune.space })
}
