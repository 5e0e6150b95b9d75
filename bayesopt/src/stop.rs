//! When another trial is not worth its time.

use serde::{Deserialize, Serialize};

/// What the next trial promises, in units of the cost.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExpectedGain {
    /// `E max(0, best − y) · P`: expected improvement at the most promising point, at the deviation that the acquisition takes, times
    /// the probability that the trial finishes.
    pub gain: f64,
    /// Deviation of the cost of the incumbent tried again, from the fitted noise.
    pub repeatability: f64,
    /// Cost of the incumbent.
    pub best: f64,
}

/// What counts as nothing to gain.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LeastGain {
    /// The fitted repeatability.
    Repeatability,
    /// So much, in units of the cost.
    Cost(f64),
    /// This share of the cost of the incumbent.
    Share(f64),
}

/// Stop once `gain < least` in `consecutive` suggestions in a row: a single small promise may be the model's whim.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StopRule {
    /// What counts as nothing.
    pub gain_below: LeastGain,
    /// Suggestions in a row, at least 1.
    pub consecutive: usize,
}

impl StopRule {
    /// The least gain for which a trial is run.
    pub fn least_gain(&self, at: &ExpectedGain) -> f64 {
        match self.gain_below {
            LeastGain::Repeatability => at.repeatability,
            LeastGain::Cost(cost) => cost,
            LeastGain::Share(share) => share * at.best.abs(),
        }
    }

    /// What the suggestion of trial `trial` promises, if the rule ends the search before it. `promise(k)` is what trial k promised when only the
    /// trials before it were known, none of one that a design chose: the rule is a function of the history, not of a memory.
    ///
    /// # Errors
    /// Those of `promise`.
    pub fn ends_before<E>(
        &self,
        trial: usize,
        mut promise: impl FnMut(usize) -> Result<Option<ExpectedGain>, E>,
    ) -> Result<Option<ExpectedGain>, E> {
        let mut last = None;
        for back in 0..self.consecutive.max(1) {
            let Some(earlier) = trial.checked_sub(back) else { return Ok(None) };
            match promise(earlier)? {
                Some(at) if at.gain < self.least_gain(&at) => last = last.or(Some(at)),
                _ => return Ok(None),
            }
        }
        Ok(last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Domain, History, Outcome, Settings, suggest};

    fn at(gain: f64) -> Option<ExpectedGain> {
        Some(ExpectedGain { gain, repeatability: 0.1, best: 4.0 })
    }

    #[test]
    fn small_promises_must_come_in_a_row() {
        let rule = StopRule { gain_below: LeastGain::Repeatability, consecutive: 3 };
        let ends = |promises: [Option<ExpectedGain>; 5]| rule.ends_before(4, |k| Ok::<_, ()>(promises[k])).unwrap();
        assert_eq!(ends([None, None, at(0.05), at(0.09), at(0.02)]), at(0.02));
        assert_eq!(ends([None, None, at(0.05), at(0.11), at(0.02)]), None);
        assert_eq!(ends([None, None, None, at(0.05), at(0.02)]), None);
        assert_eq!(rule.ends_before(1, |_| Ok::<_, ()>(at(0.0))), Ok(None));
        let of = |gain_below| StopRule { gain_below, consecutive: 1 }.least_gain(&at(0.0).unwrap());
        assert_eq!((of(LeastGain::Cost(0.3)), of(LeastGain::Share(0.05))), (0.3, 0.2));
    }

    /// A bowl is soon exhausted: the rule ends the search near its minimum, and not while there is much to gain.
    #[test]
    fn a_search_ends_when_there_is_nothing_to_gain() {
        let domain = Domain::unit_cube(2).unwrap();
        let settings = Settings::bo(vec![0.1, 0.1]);
        let bowl = |x: &[f64]| 1.0 + (x[0] - 0.4).powi(2) + (x[1] - 0.6).powi(2);
        let rule = StopRule { gain_below: LeastGain::Share(1e-3), consecutive: 2 };
        let mut history = History::new();
        let promise = |history: &History, k: usize| {
            let before = History { trials: history.trials[..k].to_vec() };
            suggest(&settings, &domain, &before, 1).map(|suggestion| suggestion.evidence.map(|at| at.expected_gain))
        };
        while rule.ends_before(history.len(), |k| promise(&history, k)).unwrap().is_none() {
            let point = suggest(&settings, &domain, &history, 1).unwrap().point;
            history.push(point.clone(), Outcome::Value(bowl(&point)));
            assert!(history.len() < 40);
        }
        assert!(
            history.len() > 11 && history.incumbent().unwrap().1 < 1.001,
            "{} {:?}",
            history.len(),
            history.incumbent()
        );
    }
}
