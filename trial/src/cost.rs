//! The tuning cost.

use serde::{Deserialize, Serialize};
use tribo_robot::Wrench;

/// Which J a trial is judged by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CostName {
    /// Largest values, N and Nm added as they are (roveda2022 eqs. 29–32).
    #[default]
    Paper,
    /// 99 % quantiles, moments as forces on a lever arm.
    Robust,
}

impl CostName {
    /// Unit of J.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Paper => "N + Nm",
            Self::Robust => "N",
        }
    }

    /// What [`Cost::parts`] are, with their units.
    pub fn part_names(self) -> [&'static str; 5] {
        match self {
            Self::Paper => {
                ["max |force| [N]", "max |moment| [Nm]", "mean |force| [N]", "mean |moment| [Nm]", "penalty"]
            }
            Self::Robust => [
                "99 % |force| [N]",
                "99 % |moment|/lever [N]",
                "mean |force| [N]",
                "mean |moment|/lever [N]",
                "penalty",
            ],
        }
    }
}

/// How the wrench of a trial becomes its cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CostMeasure {
    /// `J = Σ_i (max_t |h_i| + 1/T ∫ |h_i| dt) + Γ`.
    #[default]
    Paper,
    /// `J = Σ_i w_i (q99_t |h_i| + 1/T ∫ |h_i| dt) + Γ`, w = 1 for forces, 1/ℓ for moments: one unit, and no single sample decides.
    Robust {
        /// ℓ, the distance at which a force makes the moment (m).
        lever_arm_m: f64,
    },
}

/// Share of the samples below the robust peak.
const QUANTILE: f64 = 0.99;

/// Cost of one trial and its parts (roveda2022 eqs. 29–32):
///
/// ```text
/// J = Σ_i (max_t |h_i| + 1/T ∫ |h_i| dt) + Γ,     Γ = 1000 exp(−ξ/T) if a limit was violated at ξ, else 0
/// ```
///
/// N and Nm are added, as in the paper. An aborted trial is judged on [0, ξ]. Of the robust measure ([`CostMeasure::Robust`]) `max` holds
/// the 99 % quantiles, and moments come as forces (N).
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

/// Peak and mean of the estimated wrench over the judged part of a trial, as they come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CostAccumulator {
    measure: CostMeasure,
    max: [f64; 6],
    sum: [f64; 6],
    ticks: u64,
    /// Every |h_i|, where a quantile is wanted.
    samples: [Vec<f64>; 6],
}

impl CostAccumulator {
    /// Nothing seen yet.
    pub fn new(measure: CostMeasure) -> Self {
        Self { measure, ..Self::default() }
    }

    /// Takes the wrench of one tick.
    #[inline]
    pub fn add(&mut self, wrench: &Wrench) {
        for (i, value) in wrench.to_force_moment().iter().enumerate() {
            self.max[i] = self.max[i].max(value.abs());
            self.sum[i] += value.abs();
            if self.measure != CostMeasure::Paper {
                self.samples[i].push(value.abs());
            }
        }
        self.ticks += 1;
    }

    /// The cost; `violated_at_s` is ξ (s), counted from the start of the judged part, and `duration_s` is T (s).
    pub fn finish(self, violated_at_s: Option<f64>, duration_s: f64) -> Cost {
        let ticks = self.ticks.max(1) as f64;
        let (mut max, mut mean) = (self.max, self.sum.map(|sum| sum / ticks));
        if let CostMeasure::Robust { lever_arm_m } = self.measure {
            max = self.samples.map(quantile);
            for moment in max[3..].iter_mut().chain(&mut mean[3..]) {
                *moment /= lever_arm_m;
            }
        }
        let penalty = violated_at_s.map_or(0.0, |xi| BARRIER * (-xi.max(0.0) / duration_s).exp());
        Cost { max, mean, penalty }
    }
}

/// The smallest sample that no more than 1 % of them exceed; 0 of none.
fn quantile(mut samples: Vec<f64>) -> f64 {
    if samples.is_empty() {
        return 0.0;
    }
    let rank = (QUANTILE * samples.len() as f64).ceil() as usize;
    *samples.select_nth_unstable_by(rank.saturating_sub(1), f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_the_papers_formula() {
        let mut accumulator = CostAccumulator::new(CostMeasure::Paper);
        accumulator.add(&Wrench::from_force_moment(&[1.0, -2.0, 3.0, -0.1, 0.2, 0.3]));
        accumulator.add(&Wrench::from_force_moment(&[-3.0, 0.0, 1.0, 0.1, 0.0, -0.1]));
        let finished = |at| accumulator.clone().finish(at, 30.0);
        let cost = finished(None);
        assert_eq!(cost.max, [3.0, 2.0, 3.0, 0.1, 0.2, 0.3]);
        assert_eq!(cost.mean, [2.0, 1.0, 2.0, 0.1, 0.1, 0.2]);
        assert!((cost.total() - (8.6 + 5.4)).abs() < 1e-12);
        assert!((cost.parts().iter().map(|part| part.1).sum::<f64>() - cost.total()).abs() < 1e-12);
        assert!((finished(Some(30.0)).penalty - 1000.0 / std::f64::consts::E).abs() < 1e-9);
        assert_eq!(finished(Some(-1.0)).penalty, 1000.0);
        assert!((finished(Some(12.0)).part_seen() - 0.4).abs() < 1e-12);
        assert_eq!((cost.part_seen(), finished(Some(-1.0)).part_seen()), (1.0, 0.0));
    }

    /// Closed form: of 1000 samples 0.001 to 1, ten lie above 0.99. One wild sample moves the paper's J and not this one.
    #[test]
    fn a_robust_peak_is_a_quantile_and_moments_are_forces() {
        let judged = |measure, wild: f64| {
            let mut accumulator = CostAccumulator::new(measure);
            for k in (1..=1000).rev() {
                let h = if k == 1000 { wild } else { 1e-3 * f64::from(k) };
                accumulator.add(&Wrench::from_force_moment(&[h, -h, 0.0, 0.1 * h, 0.0, 0.0]));
            }
            accumulator.finish(None, 30.0)
        };
        let cost = judged(CostMeasure::Robust { lever_arm_m: 0.2 }, 1.0);
        let expected = [0.99, 0.99, 0.0, 0.1 * 0.99 / 0.2, 0.0, 0.0];
        assert!(cost.max.iter().zip(expected).all(|(max, expected)| (max - expected).abs() < 1e-12), "{cost:?}");
        assert!((cost.mean[0] - 0.5005).abs() < 1e-12 && (cost.mean[3] - 0.25025).abs() < 1e-12);
        assert_eq!(judged(CostMeasure::Robust { lever_arm_m: 0.2 }, 500.0).max, cost.max);
        assert!(judged(CostMeasure::Paper, 500.0).max[0] == 500.0);
        assert_eq!(CostAccumulator::new(CostMeasure::Robust { lever_arm_m: 0.2 }).finish(None, 30.0).total(), 0.0);
    }
}
