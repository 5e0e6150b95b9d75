//! From raw costs to the targets of the Gaussian process.

use serde::{Deserialize, Serialize};

use crate::{History, Outcome};

/// How costs, failures included, become the targets the model sees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CostTransform {
    /// `t = y`. A failed trial enters with its penalised raw cost; without one, with the worst cost seen.
    Raw,
    /// `t = ln y`, failed trials at `ln(cap_factor · worst non-failed y)`, then bent above the median:
    /// with `e = (t − t_best)/(t_median − t_best)`, `e ← 1 + ½ ln e` where e > 1.
    ///
    /// Whoever looks for a minimum need not model the upper half of the costs well: the bend takes the
    /// median regret on fric14 from 20 to 12 and on branin2 from 3e-4 to 1e-4 (`examples/regret.rs`, 8 and 12 seeds).
    /// The logarithm keeps a penalty from swallowing the scale of the costs that matter, and the
    /// cap keeps a cliff from bending the model (`closed_loop_notes` §4). Where a cost <= 0 exists the
    /// logarithm does not: then `t = y` and failed trials are at `worst + (cap_factor − 1)(worst − best)`.
    CappedLog {
        /// Default 1.3: far enough to repel, near enough to leave the scale alone.
        cap_factor: f64,
    },
}

/// Standardised targets  `(t − mean)/sd`  of the trials that have come back, with what undoes them.
#[derive(Debug, Clone, PartialEq)]
pub struct Targets {
    /// Trial index of each target.
    pub trials: Vec<usize>,
    /// Standardised target of each of these trials.
    pub values: Vec<f64>,
    /// Mean of the transformed costs.
    pub mean: f64,
    /// Population standard deviation of the transformed costs; 1 where they are all equal.
    pub sd: f64,
    /// Whether t is a logarithm.
    pub logarithmic: bool,
    /// Where t was bent before it was standardised.
    pub bend: Option<Bend>,
}

/// `e = (t − best)/(median − best)`; `e ← 1 + ½ ln e` where e > 1. Monotone, so the incumbent stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bend {
    /// Least t.
    pub best: f64,
    /// Lower median of t, > best.
    pub median: f64,
}

impl Bend {
    /// The bend of these transformed costs; none where the lower half is all equal.
    fn of(costs: &[f64]) -> Option<Self> {
        let mut sorted = costs.to_vec();
        sorted.sort_by(f64::total_cmp);
        let best = *sorted.first()?;
        let median = sorted[(sorted.len() - 1) / 2];
        let width = median - best;
        (width.is_finite() && width > 1e-12 * median.abs()).then_some(Self { best, median })
    }

    fn apply(self, t: f64) -> f64 {
        let (width, e) = (self.median - self.best, (t - self.best) / (self.median - self.best));
        if e > 1.0 { self.best + width * (1.0 + 0.5 * e.ln()) } else { t }
    }

    fn undo(self, t: f64) -> f64 {
        let (width, e) = (self.median - self.best, (t - self.best) / (self.median - self.best));
        if e > 1.0 { self.best + width * (2.0 * (e - 1.0)).exp() } else { t }
    }
}

impl CostTransform {
    /// Transforms and standardises all trials of `history` that have come back.
    pub fn targets(self, history: &History) -> Targets {
        let done: Vec<(usize, Outcome)> =
            (0..history.len()).map(|i| (i, history.trials[i].outcome)).filter(|(_, o)| !o.is_pending()).collect();
        let successes: Vec<f64> = done.iter().filter_map(|(_, outcome)| outcome.success()).collect();
        let best = successes.iter().copied().fold(f64::INFINITY, f64::min);
        let worst = successes.iter().copied().fold(f64::NEG_INFINITY, f64::max);

        // The law of this transform, for costs and for failures.
        let logarithmic = matches!(self, Self::CappedLog { .. }) && best > 0.0 && !successes.is_empty();
        let failed_cost = match self {
            Self::Raw => done.iter().filter_map(|(_, o)| raw_cost(*o)).fold(f64::NEG_INFINITY, f64::max),
            Self::CappedLog { cap_factor } if logarithmic => cap_factor * worst,
            Self::CappedLog { cap_factor } => worst + (cap_factor - 1.0) * (worst - best),
        };
        let failed_cost = if failed_cost.is_finite() { failed_cost } else { 0.0 };
        let transformed = |outcome: Outcome| {
            let cost = match self {
                Self::Raw => raw_cost(outcome).unwrap_or(failed_cost),
                Self::CappedLog { .. } => outcome.success().unwrap_or(failed_cost),
            };
            if logarithmic { cost.ln() } else { cost }
        };

        let mut costs: Vec<f64> = done.iter().map(|(_, outcome)| transformed(*outcome)).collect();
        let bend = if self == Self::Raw { None } else { Bend::of(&costs) };
        if let Some(bend) = bend {
            costs.iter_mut().for_each(|t| *t = bend.apply(*t));
        }
        let (mean, sd) = mean_and_sd(&costs);
        let values = costs.iter().map(|t| (t - mean) / sd).collect();
        Targets { trials: done.iter().map(|(i, _)| *i).collect(), values, mean, sd, logarithmic, bend }
    }
}

impl Targets {
    /// The cost that a standardised target stands for; finite.
    pub fn cost(&self, target: f64) -> f64 {
        let bent = self.mean + self.sd * target;
        let transformed = self.bend.map_or(bent, |bend| bend.undo(bent));
        let cost = if self.logarithmic { transformed.exp() } else { transformed };
        cost.min(f64::MAX)
    }
}

/// The finite raw cost of a trial, penalty included.
fn raw_cost(outcome: Outcome) -> Option<f64> {
    match outcome {
        Outcome::Value(value) | Outcome::Failed { value: Some(value) } if value.is_finite() => Some(value),
        _ => None,
    }
}

/// Mean and population standard deviation, computed on costs scaled to <= 1 so that 1e300 does not overflow;
/// the deviation is replaced by 1 where it is below rounding.
fn mean_and_sd(costs: &[f64]) -> (f64, f64) {
    if costs.is_empty() {
        return (0.0, 1.0);
    }
    let scale = costs.iter().fold(0.0_f64, |m, c| m.max(c.abs())).max(f64::MIN_POSITIVE);
    let n = costs.len() as f64;
    let mean = costs.iter().map(|c| c / scale).sum::<f64>() / n;
    let variance = costs.iter().map(|c| (c / scale - mean).powi(2)).sum::<f64>() / n;
    let sd = variance.sqrt();
    if sd > 1e-14 { (mean * scale, sd * scale) } else { (mean * scale, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(outcomes: &[Outcome]) -> History {
        let mut history = History::new();
        for outcome in outcomes {
            history.push(vec![0.0], *outcome);
        }
        history
    }

    #[test]
    fn failures_are_capped_and_costs_come_back_through_log_bend_and_standardisation() {
        use Outcome::{Failed, Pending, Value};
        let history =
            history(&[Value(10.0), Failed { value: Some(900.0) }, Pending, Value(20.0), Value(f64::NAN), Value(40.0)]);
        let targets = CostTransform::CappedLog { cap_factor: 1.3 }.targets(&history);
        assert_eq!(targets.trials, vec![0, 1, 3, 4, 5]);
        let costs: Vec<f64> = targets.values.iter().map(|t| targets.cost(*t)).collect();
        for (got, want) in costs.iter().zip([10.0, 52.0, 20.0, 52.0, 40.0]) {
            assert!((got / want - 1.0).abs() < 1e-13, "{got} {want}");
        }
        assert!(targets.values.iter().sum::<f64>().abs() < 1e-13);
        assert!((targets.values.iter().map(|t| t * t).sum::<f64>() / 5.0 - 1.0).abs() < 1e-13);
    }

    #[test]
    fn the_bend_keeps_order_and_the_lower_half() {
        let costs: Vec<f64> = (0..11).map(|i| f64::from(i * i)).collect();
        let bend = Bend::of(&costs).unwrap();
        assert_eq!((bend.best, bend.median), (0.0, 25.0));
        let bent: Vec<f64> = costs.iter().map(|t| bend.apply(*t)).collect();
        assert_eq!(bent[..6], costs[..6]);
        assert!(bent.windows(2).all(|pair| pair[0] < pair[1]));
        assert!((bent[10] - 25.0 * (1.0 + 0.5 * 4.0_f64.ln())).abs() < 1e-12);
        assert_eq!(Bend::of(&[1.0, 1.0, 1.0, 7.0]), None);
    }

    #[test]
    fn raw_keeps_the_penalty() {
        use Outcome::{Failed, Value};
        let history = history(&[Value(10.0), Failed { value: Some(900.0) }, Failed { value: None }]);
        let targets = CostTransform::Raw.targets(&history);
        assert!((targets.cost(targets.values[1]) - 900.0).abs() < 1e-9);
        assert!((targets.cost(targets.values[2]) - 900.0).abs() < 1e-9);
    }

    #[test]
    fn negative_costs_are_capped_without_a_logarithm() {
        let history = history(&[Outcome::Value(-3.0), Outcome::Value(-1.0), Outcome::Failed { value: None }]);
        let targets = CostTransform::CappedLog { cap_factor: 1.3 }.targets(&history);
        assert!(!targets.logarithmic);
        assert!((targets.cost(targets.values[2]) - (-0.4)).abs() < 1e-13);
    }

    #[test]
    fn degenerate_histories_give_finite_targets() {
        use Outcome::{Failed, Value};
        for outcomes in [
            vec![],
            vec![Failed { value: None }; 3],
            vec![Value(f64::NAN), Value(f64::INFINITY)],
            vec![Value(5.0); 4],
            vec![Value(1e300), Value(-1e300), Value(0.0)],
        ] {
            for transform in [CostTransform::Raw, CostTransform::CappedLog { cap_factor: 1.3 }] {
                let targets = transform.targets(&history(&outcomes));
                assert!(targets.values.iter().all(|t| t.is_finite()), "{outcomes:?} {targets:?}");
            }
        }
    }
}
