//! What has been tried and what came of it.

use serde::{Deserialize, Serialize};

/// What came of one trial. Costs are minimised; their unit is the caller's.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Outcome {
    /// The trial ended and cost this much. NaN and infinities count as failed.
    Value(f64),
    /// The trial was aborted.
    Failed {
        /// Penalised raw cost, where the cost law defines one.
        value: Option<f64>,
        /// ξ/T in [0, 1], the part of the trial that was seen before it was aborted; none where nobody knows.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        part: Option<f64>,
    },
    /// The trial has been handed out and has not come back.
    Pending,
}

impl Outcome {
    /// A failed trial of which nothing is known.
    pub const FAILED: Self = Self::Failed { value: None, part: None };

    /// The cost of a trial that did not fail: finite values only.
    pub fn success(self) -> Option<f64> {
        match self {
            Self::Value(value) if value.is_finite() => Some(value),
            _ => None,
        }
    }

    /// True while the trial has not come back.
    pub fn is_pending(self) -> bool {
        matches!(self, Self::Pending)
    }
}

/// One trial: the point tried, in real units, and its outcome.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Observation {
    /// Coordinates in real units.
    pub point: Vec<f64>,
    /// What came of it.
    pub outcome: Outcome,
}

/// All trials in the order they were asked for; the index of a trial is its place here.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct History {
    /// The trials, oldest first.
    pub trials: Vec<Observation>,
}

impl History {
    /// A history without trials.
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends a trial and returns its index.
    pub fn push(&mut self, point: Vec<f64>, outcome: Outcome) -> usize {
        self.trials.push(Observation { point, outcome });
        self.trials.len() - 1
    }

    /// Number of trials, pending ones included.
    pub fn len(&self) -> usize {
        self.trials.len()
    }

    /// True before the first trial.
    pub fn is_empty(&self) -> bool {
        self.trials.is_empty()
    }

    /// Incumbent  `argmin { y_i : trial i did not fail }`  with its cost; the earliest of equals.
    pub fn incumbent(&self) -> Option<(usize, f64)> {
        let successes = self.trials.iter().enumerate().filter_map(|(i, trial)| Some((i, trial.outcome.success()?)));
        successes.fold(None, |best, (i, value)| match best {
            Some((_, least)) if least <= value => best,
            _ => Some((i, value)),
        })
    }

    /// Running best cost  `min_{k <= i} y_k`  after each trial; infinite before the first success.
    pub fn running_best(&self) -> Vec<f64> {
        let mut least = f64::INFINITY;
        let mut step = |trial: &Observation| {
            least = trial.outcome.success().map_or(least, |value| least.min(value));
            least
        };
        self.trials.iter().map(&mut step).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn incumbent_skips_failed_pending_and_not_a_number() {
        let mut history = History::new();
        history.push(vec![0.0], Outcome::Failed { value: Some(-9.0), part: None });
        history.push(vec![0.1], Outcome::Value(f64::NAN));
        assert_eq!(history.incumbent(), None);
        history.push(vec![0.2], Outcome::Value(3.0));
        history.push(vec![0.3], Outcome::Pending);
        history.push(vec![0.4], Outcome::Value(2.0));
        history.push(vec![0.5], Outcome::Value(2.0));
        assert_eq!(history.incumbent(), Some((4, 2.0)));
        assert_eq!(history.running_best()[3..], [3.0, 2.0, 2.0]);
    }
}
