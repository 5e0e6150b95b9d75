//! The tuning cost.

use serde::{Deserialize, Serialize};
use tribo_robot::Wrench;

/// Cost of one trial and its parts (roveda2022 eqs. 29–32):
///
/// ```text
/// J = Σ_i (max_t |h_i| + 1/T ∫ |h_i| dt) + Γ,     Γ = 1000 exp(−ξ/T) if a limit was violated at ξ, else 0
/// ```
///
/// N and Nm are added, as in the paper. An aborted trial is judged on [0, ξ].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// Largest |h| per component, force then moment [N, Nm].
    pub max: [f64; 6],
    /// Mean |h| per component, force then moment [N, Nm].
    pub mean: [f64; 6],
    /// Penalty Γ.
    pub penalty: f64,
}

impl Cost {
    /// J, penalty included.
    pub fn total(&self) -> f64 {
        self.max.iter().sum::<f64>() + self.mean.iter().sum::<f64>() + self.penalty
    }

    /// ξ/T, the part of the trial that was judged before it was aborted; 1 of one that was not.
    pub fn part_seen(&self) -> f64 {
        if self.penalty > 0.0 { (BARRIER / self.penalty).ln() } else { 1.0 }
    }

    /// The parts as named numbers: `max_force max_moment mean_force mean_moment penalty`.
    pub fn parts(&self) -> [(&'static str, f64); 5] {
        let sum = |x: &[f64]| x.iter().sum::<f64>();
        [
            ("max_force", sum(&self.max[..3])),
            ("max_moment", sum(&self.max[3..])),
            ("mean_force", sum(&self.mean[..3])),
            ("mean_moment", sum(&self.mean[3..])),
            ("penalty", self.penalty),
        ]
    }
}

/// Height of the penalty barrier (roveda2022 eq. 32).
const BARRIER: f64 = 1000.0;

/// Running maximum and mean of the estimated wrench over the judged part of a trial.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CostAccumulator {
    max: [f64; 6],
    sum: [f64; 6],
    ticks: u64,
}

impl CostAccumulator {
    /// Takes the wrench of one tick.
    #[inline]
    pub fn add(&mut self, wrench: &Wrench) {
        for (i, value) in wrench.to_force_moment().iter().enumerate() {
            self.max[i] = self.max[i].max(value.abs());
            self.sum[i] += value.abs();
        }
        self.ticks += 1;
    }

    /// The cost; `violated_at_s` is ξ (s), counted from the start of the judged part, and `duration_s` is T (s).
    pub fn finish(&self, violated_at_s: Option<f64>, duration_s: f64) -> Cost {
        let ticks = self.ticks.max(1) as f64;
        Cost {
            max: self.max,
            mean: self.sum.map(|sum| sum / ticks),
            penalty: violated_at_s.map_or(0.0, |xi| BARRIER * (-xi.max(0.0) / duration_s).exp()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_the_papers_formula() {
        let mut accumulator = CostAccumulator::default();
        accumulator.add(&Wrench::from_force_moment(&[1.0, -2.0, 3.0, -0.1, 0.2, 0.3]));
        accumulator.add(&Wrench::from_force_moment(&[-3.0, 0.0, 1.0, 0.1, 0.0, -0.1]));
        let cost = accumulator.finish(None, 30.0);
        assert_eq!(cost.max, [3.0, 2.0, 3.0, 0.1, 0.2, 0.3]);
        assert_eq!(cost.mean, [2.0, 1.0, 2.0, 0.1, 0.1, 0.2]);
        assert!((cost.total() - (8.6 + 5.4)).abs() < 1e-12);
        assert!((cost.parts().iter().map(|part| part.1).sum::<f64>() - cost.total()).abs() < 1e-12);
        assert!((accumulator.finish(Some(30.0), 30.0).penalty - 1000.0 / std::f64::consts::E).abs() < 1e-9);
        assert_eq!(accumulator.finish(Some(-1.0), 30.0).penalty, 1000.0);
        assert!((accumulator.finish(Some(12.0), 30.0).part_seen() - 0.4).abs() < 1e-12);
        assert_eq!((cost.part_seen(), accumulator.finish(Some(-1.0), 30.0).part_seen()), (1.0, 0.0));
    }
}
