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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TuneConfig;
    use crate::strategy::Origin;
    use crate::strategy_name::StrategyName;
    use tribo_trial::Cost;

    /// J = 3 + 40 (x − ½)² along a line, each trial with its noise: one far from the bottom has the least J by luck, and is not the best.
    #[test]
    fn the_luckiest_trial_is_not_the_best() {
        let config = TuneConfig { strategy: StrategyName::Bo, ..TuneConfig::default() };
        let tune = config.validate::<7>().unwrap();
        let trial = |number: usize, x: f64, noise: f64| {
            let mut theta = vec![0.5; tune.space.zero().len()];
            theta[0] = x;
            let max = 3.0 + 40.0 * (x - 0.5).powi(2) + noise;
            let cost = Cost { max: [max, 0.0, 0.0, 0.0, 0.0, 0.0], ..Cost::default() };
            FinishedTrial { number, theta, cost, aborted: None, origin: Origin::Design }
        };
        let mut finished: Vec<FinishedTrial> =
            (0..24).map(|k| trial(k, 0.2 + 0.025 * k as f64, [0.15, -0.2, 0.1, -0.05][k % 4])).collect();
        finished.push(trial(24, 0.66, -1.2));
        let least = BestTrial::least(&finished).unwrap();
        assert_eq!((least.trial, least.sd), (24, None));
        let best = BestTrial::by_cost(&tune, &finished).unwrap().unwrap();
        let x = finished[best.trial].theta[0];
        assert!((x - 0.5).abs() < 0.1, "{best:?} at {x}");
        assert!((best.cost - 3.0).abs() < 0.3 && best.sd.is_some_and(|sd| sd > 0.0 && sd < 0.5), "{best:?}");
    }

    /// One parameter vector again and again: the mean with its standard error.
    #[test]
    fn equal_trials_have_the_mean_of_their_costs() {
        let tune = TuneConfig { strategy: StrategyName::Bo, ..TuneConfig::default() }.validate::<7>().unwrap();
        let trial = |number: usize, max: f64| {
            let cost = Cost { max: [max, 0.0, 0.0, 0.0, 0.0, 0.0], ..Cost::default() };
            FinishedTrial { number, theta: tune.space.zero(), cost, aborted: None, origin: Origin::Design }
        };
        let finished = [trial(0, 4.0), trial(1, 2.0), trial(2, 3.0)];
        let best = BestTrial::by_cost(&tune, &finished).unwrap().unwrap();
        assert_eq!((best.trial, best.cost, best.seen), (0, 3.0, 4.0));
        assert!((best.sd.unwrap() - 1.0 / 3f64.sqrt()).abs() < 1e-12, "{best:?}");
    }
}
