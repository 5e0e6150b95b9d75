//! From raw costs to the targets of the Gaussian process.

use serde::{Deserialize, Serialize};

use crate::acquisition::{expected_improvement, log_normal_cdf};
use crate::{History, Outcome};

/// What stands for the largest cost where costs are added up: their sum is finite too.
const FINITE: f64 = 1e300;

/// How costs, failures included, become the targets the model sees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CostTransform {
    /// `t = y`. A failed trial enters with its penalised raw cost; without one, with the worst cost seen.
    Raw,
    /// Whichever of four explains the costs best (`gp::fit_best`): `t = y` or `t = ln y` (where every cost is positive),
    /// as it is or bent above the median: with `e = (t − t_best)/(t_median − t_best)`, `e ← 1 + ½ ln e` where e > 1.
    ///
    /// A smooth bowl is best seen as it is (ackley14: regret 6.3 instead of 8.0 with log and bend). Where penalties of 900
    /// stand beside costs of 20, the logarithm keeps them from swallowing the scale of the costs that matter, and the bend
    /// spares the model the upper half, which nobody who looks for a minimum needs (fric14: 10 instead of 21).
    /// Failed trials are at `cap_factor · worst`, or, where a cost <= 0 exists, at
    /// `worst + (cap_factor − 1)(worst − best)`: a cliff that is capped does not bend the model.
    ByEvidence {
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
    /// `Σ ln |d target/d cost|` over the trials.
    pub log_jacobian: f64,
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

    /// Logarithm of the slope at t.
    fn log_slope(self, t: f64) -> f64 {
        let e = (t - self.best) / (self.median - self.best);
        if e > 1.0 { (0.5 / e).ln() } else { 0.0 }
    }

    /// Slope of [`Self::undo`].
    fn undone_slope(self, t: f64) -> f64 {
        let e = (t - self.best) / (self.median - self.best);
        if e > 1.0 { 2.0 * (2.0 * (e - 1.0)).exp() } else { 1.0 }
    }

    fn undo(self, t: f64) -> f64 {
        let (width, e) = (self.median - self.best, (t - self.best) / (self.median - self.best));
        if e > 1.0 { self.best + width * (2.0 * (e - 1.0)).exp() } else { t }
    }
}

impl CostTransform {
    /// The targets among which the evidence decides: one for `Raw`, else two or four.
    pub fn candidates(self, history: &History) -> Vec<Targets> {
        let done: Vec<(usize, Outcome)> =
            (0..history.len()).map(|i| (i, history.trials[i].outcome)).filter(|(_, o)| !o.is_pending()).collect();
        let successes: Vec<f64> = done.iter().filter_map(|(_, outcome)| outcome.success()).collect();
        let best = successes.iter().copied().fold(f64::INFINITY, f64::min);
        let worst = successes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let positive = best > 0.0 && !successes.is_empty();

        // Costs, those of failures by the law of this transform.
        let failed_cost = match self {
            Self::Raw => done.iter().filter_map(|(_, o)| raw_cost(*o)).fold(f64::NEG_INFINITY, f64::max),
            Self::ByEvidence { cap_factor } if positive => cap_factor * worst,
            Self::ByEvidence { cap_factor } => worst + (cap_factor - 1.0) * (worst - best),
        };
        let failed_cost = if failed_cost.is_finite() { failed_cost } else { 0.0 };
        let cost = |outcome: Outcome| match self {
            Self::Raw => raw_cost(outcome).unwrap_or(failed_cost),
            Self::ByEvidence { .. } => outcome.success().unwrap_or(failed_cost),
        };
        let trials: Vec<usize> = done.iter().map(|(i, _)| *i).collect();
        let costs: Vec<f64> = done.iter().map(|(_, outcome)| cost(*outcome)).collect();

        let plain = Targets::of(&trials, &costs, false, None);
        if self == Self::Raw {
            return vec![plain];
        }
        let bent = |logarithmic, t: &[f64]| Some(Targets::of(&trials, &costs, logarithmic, Some(Bend::of(t)?)));
        let mut candidates = vec![plain];
        candidates.extend(bent(false, &costs));
        if positive {
            let logarithms: Vec<f64> = costs.iter().map(|y| y.ln()).collect();
            candidates.push(Targets::of(&trials, &costs, true, None));
            candidates.extend(bent(true, &logarithms));
        }
        // Costs near the largest number there is have no Jacobian.
        let mut first = true;
        candidates.retain(|candidate| std::mem::take(&mut first) || candidate.log_jacobian.is_finite());
        candidates
    }
}

impl Targets {
    fn of(trials: &[usize], costs: &[f64], logarithmic: bool, bend: Option<Bend>) -> Self {
        let mut log_jacobian = 0.0;
        let mut transformed = |y: &f64| {
            let t = if logarithmic { y.ln() } else { *y };
            log_jacobian -= if logarithmic { t } else { 0.0 };
            log_jacobian += bend.map_or(0.0, |bend| bend.log_slope(t));
            bend.map_or(t, |bend| bend.apply(t))
        };
        let transformed: Vec<f64> = costs.iter().map(&mut transformed).collect();
        let (mean, sd) = mean_and_sd(&transformed);
        let values = transformed.iter().map(|t| (t - mean) / sd).collect();
        log_jacobian -= costs.len() as f64 * sd.ln();
        Self { trials: trials.to_vec(), values, mean, sd, logarithmic, bend, log_jacobian }
    }

    /// The cost that a standardised target stands for, and its slope in the target; both finite.
    pub fn cost_and_slope(&self, target: f64) -> (f64, f64) {
        let bent = self.mean + self.sd * target;
        let (transformed, unbent) = self.bend.map_or((bent, 1.0), |bend| (bend.undo(bent), bend.undone_slope(bent)));
        let (cost, slope) = if self.logarithmic { (transformed.exp(), transformed.exp()) } else { (transformed, 1.0) };
        (cost.min(FINITE), (slope * unbent * self.sd).min(FINITE))
    }

    /// `E max(0, c(best) − c(t))`, t ~ N(mean, sd²), sd > 0, in units of the cost, where `best` lies below the bend, as incumbents do:
    /// `sd_t·EI` of a linear transform, and of a logarithm, with `μ, s` the mean and deviation of ln c and `a = (ln c(best) − μ)/s`,
    /// `c(best) Φ(a) − e^{μ + s²/2} Φ(a − s)`.
    pub fn expected_improvement(&self, mean: f64, sd: f64, best: f64) -> f64 {
        if !self.logarithmic {
            return self.sd * expected_improvement(mean, sd, best).value;
        }
        let (mu, s, log_best) = (self.mean + self.sd * mean, self.sd * sd, self.mean + self.sd * best);
        let a = (log_best - mu) / s;
        let paid = log_best + log_normal_cdf(a).0;
        (paid.exp() - (mu + 0.5 * s * s + log_normal_cdf(a - s).0).exp()).clamp(0.0, FINITE)
    }

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
        Outcome::Value(value) | Outcome::Failed { value: Some(value), .. } if value.is_finite() => Some(value),
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
        let history = history(&[
            Value(10.0),
            Failed { value: Some(900.0), part: None },
            Pending,
            Value(20.0),
            Value(f64::NAN),
            Value(40.0),
        ]);
        let candidates = CostTransform::ByEvidence { cap_factor: 1.3 }.candidates(&history);
        assert_eq!(candidates.len(), 4);
        for targets in candidates {
            assert_eq!(targets.trials, vec![0, 1, 3, 4, 5]);
            let costs: Vec<f64> = targets.values.iter().map(|t| targets.cost(*t)).collect();
            for (got, want) in costs.iter().zip([10.0, 52.0, 20.0, 52.0, 40.0]) {
                assert!((got / want - 1.0).abs() < 1e-13, "{got} {want}");
            }
            assert!(targets.values.iter().sum::<f64>().abs() < 1e-13);
            assert!((targets.values.iter().map(|t| t * t).sum::<f64>() / 5.0 - 1.0).abs() < 1e-13);
        }
    }

    /// The Jacobian against central differences of the way back: `d cost/d target`.
    #[test]
    fn the_jacobian_is_that_of_the_transform() {
        let history = history(&[10.0, 12.0, 19.0, 33.0, 70.0].map(Outcome::Value));
        for targets in (CostTransform::ByEvidence { cap_factor: 1.3 }).candidates(&history) {
            let slope = |t: f64| (targets.cost(t + 1e-6) - targets.cost(t - 1e-6)) / 2e-6;
            let log_slope = |t: f64| slope(t).ln();
            // At the median the bend has a kink; its own sum is the mean of both sides there, so it is left out.
            let median = targets.values[2];
            let numeric: f64 = targets.values.iter().filter(|t| **t != median).map(|t| -log_slope(*t)).sum();
            let at_median = -(targets.sd.ln() + if targets.logarithmic { 19.0_f64.ln() } else { 0.0 });
            assert!((numeric + at_median - targets.log_jacobian).abs() < 1e-6, "{targets:?}");
        }
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

    /// Second algorithm: the midpoint rule over the density.
    #[test]
    fn expected_improvement_is_the_integral_over_the_costs() {
        use Outcome::Value;
        let history = history(&[Value(10.0), Value(20.0), Value(40.0), Value(900.0)]);
        for targets in (CostTransform::ByEvidence { cap_factor: 1.3 }).candidates(&history) {
            let best = targets.values[0];
            for (mean, sd) in [(best + 0.3, 0.4), (best - 0.2, 0.1), (best + 1.0, 0.5)] {
                let step = 1e-4;
                let integral: f64 = (-80_000..80_000)
                    .map(|k| {
                        let z = (f64::from(k) + 0.5) * step;
                        let gain = (targets.cost(best) - targets.cost(mean + sd * z)).max(0.0);
                        gain * crate::acquisition::normal_pdf(z) * step
                    })
                    .sum();
                let closed = targets.expected_improvement(mean, sd, best);
                assert!((closed / integral - 1.0).abs() < 1e-6, "{closed} {integral} {targets:?}");
            }
        }
    }

    #[test]
    fn raw_keeps_the_penalty() {
        use Outcome::{Failed, Value};
        let history = history(&[Value(10.0), Failed { value: Some(900.0), part: None }, Outcome::FAILED]);
        let targets = CostTransform::Raw.candidates(&history).remove(0);
        assert!((targets.cost(targets.values[1]) - 900.0).abs() < 1e-9);
        assert!((targets.cost(targets.values[2]) - 900.0).abs() < 1e-9);
    }

    #[test]
    fn negative_costs_are_capped_without_a_logarithm() {
        let history = history(&[Outcome::Value(-3.0), Outcome::Value(-1.0), Outcome::FAILED]);
        let candidates = CostTransform::ByEvidence { cap_factor: 1.3 }.candidates(&history);
        assert_eq!(candidates.len(), 2);
        for targets in candidates {
            assert!(!targets.logarithmic);
            assert!((targets.cost(targets.values[2]) - (-0.4)).abs() < 1e-13);
        }
    }

    #[test]
    fn degenerate_histories_give_finite_targets() {
        use Outcome::Value;
        for outcomes in [
            vec![],
            vec![Outcome::FAILED; 3],
            vec![Value(f64::NAN), Value(f64::INFINITY)],
            vec![Value(5.0); 4],
            vec![Value(1e300), Value(-1e300), Value(0.0)],
        ] {
            for transform in [CostTransform::Raw, CostTransform::ByEvidence { cap_factor: 1.3 }] {
                let candidates = transform.candidates(&history(&outcomes));
                assert!(!candidates.is_empty());
                let targets = &candidates[0];
                assert!(targets.values.iter().all(|t| t.is_finite()), "{outcomes:?} {targets:?}");
            }
        }
    }
}
