//! A region around the incumbent that grows with success and shrinks with failure.

use serde::{Deserialize, Serialize};

use crate::History;
use crate::search::Bounds;

/// TuRBO-1 (eriksson2019):  box of side  `L·ℓ_i/(Π ℓ_j)^{1/d}`  around the incumbent, in unit coordinates.
///
/// ```text
/// 3 successes in a row: L ← min(2L, 1.6);   max(4, d/6) failures in a row: L ← L/2;   L < 2⁻⁷: L ← 0.4
/// ```
///
/// TuRBO begins at 0.8 and waits for d failures, for thousands of trials; with fifty there is no time for that (fric35: 6.6
/// instead of 7.3 with 0.8 and d/3, median of seeds 40 to 79).
/// A success improves the incumbent by more than 0.1 %. State is replayed from the history, never stored.
/// Leaves out: TuRBO's new initial design at a restart; the region starts again around the same incumbent,
/// because trials on a robot are too dear to forget.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrustRegion {
    /// L, side of the region as a share of the unit cube.
    pub length: f64,
    /// Successes in a row.
    pub successes: usize,
    /// Failures in a row.
    pub failures: usize,
    /// How often the region collapsed and started again.
    pub restarts: usize,
}

const FIRST_LENGTH: f64 = 0.4;
const LARGEST_LENGTH: f64 = 1.6;
const SMALLEST_LENGTH: f64 = 0.007_812_5;
const SUCCESS_TOLERANCE: usize = 3;
const LEAST_IMPROVEMENT: f64 = 1e-3;

impl Default for TrustRegion {
    fn default() -> Self {
        Self { length: FIRST_LENGTH, successes: 0, failures: 0, restarts: 0 }
    }
}

impl TrustRegion {
    /// Failures in a row that halve the region:  `max(4, ⌈d/6⌉)`.
    pub fn failure_tolerance(dimension: usize) -> usize {
        dimension.div_ceil(6).max(4)
    }

    /// The state after all trials of `history` that have come back; the first `init_trials` only set the incumbent.
    pub fn replay(history: &History, init_trials: usize, dimension: usize) -> Self {
        let mut region = Self::default();
        let mut best = f64::INFINITY;
        for (i, trial) in history.trials.iter().enumerate() {
            if trial.outcome.is_pending() {
                continue;
            }
            let value = trial.outcome.success().unwrap_or(f64::INFINITY);
            if i >= init_trials {
                let slack = if best.is_finite() { LEAST_IMPROVEMENT * best.abs() } else { 0.0 };
                region.count(value < best - slack, dimension);
            }
            best = best.min(value);
        }
        region
    }

    fn count(&mut self, success: bool, dimension: usize) {
        (self.successes, self.failures) = if success { (self.successes + 1, 0) } else { (0, self.failures + 1) };
        if self.successes == SUCCESS_TOLERANCE {
            (self.length, self.successes) = ((2.0 * self.length).min(LARGEST_LENGTH), 0);
        } else if self.failures == Self::failure_tolerance(dimension) {
            (self.length, self.failures) = (0.5 * self.length, 0);
        }
        if self.length < SMALLEST_LENGTH {
            *self = Self { restarts: self.restarts + 1, ..Self::default() };
        }
    }

    /// The box of this region around `center`, clipped to the unit cube.
    pub fn bounds(&self, center: &[f64], lengthscales: &[f64]) -> Bounds {
        let log_mean = lengthscales.iter().map(|l| l.ln()).sum::<f64>() / lengthscales.len() as f64;
        let half = |i: usize| 0.5 * self.length * (lengthscales[i].ln() - log_mean).exp();
        let middle = |i: usize| center[i].clamp(0.0, 1.0);
        Bounds {
            lower: (0..center.len()).map(|i| (middle(i) - half(i)).max(0.0)).collect(),
            upper: (0..center.len()).map(|i| (middle(i) + half(i)).min(1.0)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Outcome;

    fn history(values: &[f64]) -> History {
        let mut history = History::new();
        for value in values {
            history.push(vec![0.5], Outcome::Value(*value));
        }
        history
    }

    #[test]
    fn three_successes_double_and_four_failures_halve() {
        assert_eq!(TrustRegion::replay(&history(&[9.0, 8.0, 7.0, 6.0]), 1, 9).length, 0.8);
        assert_eq!(TrustRegion::replay(&history(&[1.0, 2.0, 2.0, 2.0, 2.0]), 1, 9).length, 0.2);
        assert_eq!(TrustRegion::replay(&history(&[1.0, 2.0, 2.0, 2.0, 2.0]), 1, 35).failures, 4);
        assert_eq!(TrustRegion::failure_tolerance(35), 6);
    }

    #[test]
    fn a_collapsed_region_starts_again() {
        // From 0.4, six halvings fall below 2⁻⁷.
        let region = TrustRegion::replay(&history(&[1.0; 25]), 1, 3);
        assert_eq!((region.length, region.restarts), (0.4, 1));
    }

    #[test]
    fn pending_trials_count_neither_way_and_failures_count() {
        let mut with_pending = history(&[5.0, 4.0]);
        with_pending.push(vec![0.5], Outcome::Pending);
        with_pending.push(vec![0.5], Outcome::FAILED);
        let region = TrustRegion::replay(&with_pending, 1, 3);
        assert_eq!((region.successes, region.failures), (0, 1));
    }

    #[test]
    fn sides_follow_the_lengthscales_and_stay_in_the_cube() {
        let region = TrustRegion { length: 0.4, ..TrustRegion::default() };
        let bounds = region.bounds(&[0.5, 0.05], &[0.5, 2.0]);
        assert!((bounds.lower[0] - 0.4).abs() < 1e-15 && (bounds.upper[0] - 0.6).abs() < 1e-15);
        assert_eq!(bounds.lower[1], 0.0);
        assert!((bounds.upper[1] - 0.45).abs() < 1e-15);
    }
}
