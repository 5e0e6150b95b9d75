//! What the trials of a campaign amount to.

use serde::{Deserialize, Serialize};

use crate::ValidTune;
use crate::strategy::{BestTrial, FinishedTrial, LawCheck, LogSource, Standing, Standings, Strategy, StrategyError};

/// The best trial so far, and whether the friction law explains the robot. What is known of the logs is worked out once, by whoever runs the
/// campaign, and stands in its journal for all who look at it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conclusion {
    /// Trials that had finished.
    pub trials: usize,
    /// The best of them; none before a trial was seen to its end.
    pub best: Option<BestTrial>,
    /// What the first log that is long enough says of the friction law; none of a strategy that identifies no law.
    pub law_check: Option<LawCheck>,
    /// Joints that stood still in the last logs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub standing: Vec<Standing>,
}

impl Conclusion {
    /// From the trials that have finished.
    ///
    /// # Errors
    /// A log that cannot be read; an optimiser without an answer.
    pub(crate) fn of<const N: usize>(
        tune: &ValidTune<N>,
        strategy: &dyn Strategy<N>,
        finished: &[FinishedTrial],
        logs: &dyn LogSource<N>,
    ) -> Result<Self, StrategyError> {
        let next = finished.iter().map(|trial| trial.number + 1).max().unwrap_or(0);
        Ok(Self {
            trials: finished.len(),
            best: BestTrial::of(tune, strategy, finished, logs)?,
            law_check: strategy.law_check(next, logs)?,
            standing: strategy.standing(next, logs)?,
        })
    }

    /// What there is to say of the arm beside the best trial: joints that stand, and a friction law that does not explain it.
    pub fn remarks(&self) -> Vec<String> {
        let standing = (!self.standing.is_empty()).then(|| Standings(&self.standing).to_string());
        let law = self.law_check.filter(|check| !check.passed()).map(|check| check.to_string());
        standing.into_iter().chain(law).collect()
    }

    /// The best trial, if this is about the trials that have finished by now; else the cheapest of these.
    pub(crate) fn best_of<'a>(
        recorded: Option<&Self>,
        finished: impl Iterator<Item = &'a FinishedTrial> + Clone,
    ) -> Option<BestTrial> {
        match recorded {
            Some(conclusion) if conclusion.trials == finished.clone().count() => conclusion.best,
            _ => BestTrial::least(finished),
        }
    }
}
