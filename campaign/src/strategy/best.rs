//! Which trial is the best one.

use serde::{Deserialize, Serialize};
use tribo_bayesopt::{Settings, recommend};

use super::{FinishedTrial, LogSource, Past, Strategy, StrategyError, observations};
use crate::ValidTune;

/// The trial whose parameters to use: the one that is expected to cost least when it is run again, which is seldom the luckiest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BestTrial {
    /// Its number.
    pub trial: usize,
    /// Expected J of another trial with its parameters [N + Nm, or N of the robust cost].
    pub cost: f64,
    /// Standard deviation of that expectation; none where nothing tells it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sd: Option<f64>,
    /// J that the trial itself cost.
    pub seen: f64,
}

impl BestTrial {
    /// The best of the trials that have finished, by what the strategy knows of logs, else by a Gaussian process of J
    /// ([`recommend`]); none before a trial was seen to its end.
    ///
    /// # Errors
    /// A log that cannot be read; an optimiser without an answer.
    pub fn of<const N: usize>(
        tune: &ValidTune<N>,
        strategy: &dyn Strategy<N>,
        finished: &[FinishedTrial],
        logs: &dyn LogSource<N>,
    ) -> Result<Option<Self>, StrategyError> {
        let past = Past { finished, ..Past::default() };
        match strategy.best(past, logs)? {
            Some(best) => Ok(Some(best)),
            None => Self::by_cost(tune, finished),
        }
    }

    /// The trial with the least J among those that were seen to their end; the earliest of equals.
    pub fn least<'a>(finished: impl IntoIterator<Item = &'a FinishedTrial>) -> Option<Self> {
        let complete = finished.into_iter().filter(|trial| trial.aborted.is_none());
        let least = complete.min_by(|a, b| a.cost.total().total_cmp(&b.cost.total()))?;
        let seen = least.cost.total();
        Some(Self { trial: least.number, cost: seen, sd: None, seen })
    }

    fn by_cost<const N: usize>(tune: &ValidTune<N>, finished: &[FinishedTrial]) -> Result<Option<Self>, StrategyError> {
        let Some(least) = Self::least(finished) else { return Ok(None) };
        let complete: Vec<&FinishedTrial> = finished.iter().filter(|trial| trial.aborted.is_none()).collect();
        if complete.iter().all(|trial| trial.theta == complete[0].theta) {
            let costs: Vec<f64> = complete.iter().map(|trial| trial.cost.total()).collect();
            let (cost, sd) = mean_and_error(&costs);
            let first = complete[0];
            return Ok(Some(Self { trial: first.number, cost, sd, seen: first.cost.total() }));
        }
        let history = observations(finished, &[]);
        let settings = Settings { init_trials: 0, ..Settings::bo(tune.space.zero()) };
        let recommended = recommend(&settings, &tune.space.domain()?, &history, tune.config.seed)?;
        // The history leaves out trials that tell nothing: its places are no numbers.
        let best = recommended.and_then(|recommended| {
            let trial = complete.iter().find(|trial| trial.theta == recommended.point)?;
            Some(Self { trial: trial.number, cost: recommended.cost, sd: recommended.sd, seen: trial.cost.total() })
        });
        Ok(Some(best.unwrap_or(least)))
    }
}

/// The mean and its standard error; of one value no error.
fn mean_and_error(values: &[f64]) -> (f64, Option<f64>) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (mean, (values.len() > 1).then(|| (square / (count - 1.0) / count).sqrt()))
}
