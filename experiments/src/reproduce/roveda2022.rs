//! Tuning campaigns of roveda2022 section 5.4 over seeds, poses and truths, strategies side by side.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tribo_campaign::strategy::StrategyName;
use tribo_campaign::{CampaignError, Phases, StopBelow, TuneConfig, TunedLaw, references, run_in_memory};
use tribo_friction::VelocitySource;
use tribo_model::FieldError;
use tribo_trial::scenario::{POSES, TruthName};

/// Settings of the experiment, `schema: tribo.reproduce/1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Roveda2022 {
    /// `tribo.reproduce/1`.
    pub schema: String,
    /// Seeds 1 to this one.
    pub seeds: u64,
    /// Velocity the compensator believes near zero.
    pub velocity: VelocitySource,
    /// Runs over which the oracle's cost is averaged; one alone repeats to 2–3 %.
    pub oracle_runs: u64,
    /// Truths and the compensator's law on each.
    pub cases: Vec<CaseConfig>,
    /// Strategies and their budgets.
    pub strategies: Vec<StrategyConfig>,
}

/// A truth and the law tuned on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseConfig {
    /// What the simulated arm is like.
    pub truth: TruthName,
    /// Friction law of the compensator.
    pub friction: TunedLaw,
}

/// A strategy and its budget.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrategyConfig {
    /// The strategy.
    pub strategy: StrategyName,
    /// Trials per campaign.
    pub trials: usize,
    /// Poses, each with every seed.
    pub poses: Vec<usize>,
    /// Only the first seeds of the experiment; all, if not given.
    #[serde(default)]
    pub seeds: Option<u64>,
}

/// One campaign of the experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CellResult {
    /// Truth.
    pub truth: TruthName,
    /// Strategy.
    pub strategy: StrategyName,
    /// Seed.
    pub seed: u64,
    /// Pose.
    pub pose: usize,
    /// Mean cost of the oracle.
    pub oracle: f64,
    /// Cost without compensation.
    pub uncompensated: f64,
    /// Cost of each trial over the oracle's, penalties included.
    pub ratio: Vec<f64>,
    /// Number of aborted trials.
    pub penalties: usize,
}

/// The campaigns of one truth and strategy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowSummary {
    /// Truth.
    pub truth: TruthName,
    /// Strategy.
    pub strategy: StrategyName,
    /// Campaigns.
    pub campaigns: usize,
    /// Mean J_0/J_oracle.
    pub uncompensated_ratio: f64,
    /// Mean J/J_oracle of the second trial.
    pub second_mean: f64,
    /// Worst J/J_oracle of the second trial.
    pub second_worst: f64,
    /// Mean over campaigns of the best J/J_oracle within 5, 20 and all trials.
    pub best_mean: [f64; 3],
    /// Worst campaign's best J/J_oracle at the end.
    pub best_worst: f64,
    /// Median over campaigns of the number of trials until J/J_oracle ≤ 1.1; none where half of them never get there.
    pub trials_to_1_1: Option<f64>,
    /// Campaigns that never reach 1.1.
    pub never: usize,
    /// Mean number of aborted trials per campaign.
    pub penalties: f64,
}

impl Roveda2022 {
    /// Checks every field.
    pub fn validate(&self) -> Result<(), FieldError> {
        if self.schema != "tribo.reproduce/1" {
            return Err(FieldError::new("schema", &self.schema, "tribo.reproduce/1"));
        }
        FieldError::check("seeds", self.seeds as f64, 1.0, 10_000.0)?;
        FieldError::check("oracle_runs", self.oracle_runs as f64, 1.0, 100.0)?;
        for strategy in &self.strategies {
            FieldError::check("strategies.trials", strategy.trials as f64, 2.0, 10_000.0)?;
            if let Some(seeds) = strategy.seeds {
                FieldError::check("strategies.seeds", seeds as f64, 1.0, 10_000.0)?;
            }
            if let Some(pose) = strategy.poses.iter().find(|&&pose| pose >= POSES) {
                return Err(FieldError::new("strategies.poses", pose, format!("0 to {}", POSES - 1)));
            }
        }
        Ok(())
    }

    /// Number of campaigns.
    pub fn cells(&self) -> usize {
        let campaigns = |strategy: &StrategyConfig| strategy.poses.len() * self.seeds_of(strategy) as usize;
        self.strategies.iter().map(campaigns).sum::<usize>() * self.cases.len()
    }

    fn seeds_of(&self, strategy: &StrategyConfig) -> u64 {
        strategy.seeds.map_or(self.seeds, |seeds| seeds.min(self.seeds))
    }

    /// Runs every campaign, on the threads of the current rayon pool; `done` is told of each as it ends.
    pub fn run(&self, done: impl Fn(&CellResult) + Sync) -> Result<Vec<CellResult>, CampaignError> {
        let mut cells = Vec::new();
        for case in &self.cases {
            for strategy in &self.strategies {
                for seed in 1..=self.seeds_of(strategy) {
                    cells.extend(strategy.poses.iter().map(|&pose| (case, strategy, seed, pose)));
                }
            }
        }
        cells
            .par_iter()
            .map(|&(case, strategy, seed, pose)| {
                let cell = self.run_cell(case, strategy, seed, pose)?;
                done(&cell);
                Ok(cell)
            })
            .collect()
    }

    fn run_cell(
        &self,
        case: &CaseConfig,
        strategy: &StrategyConfig,
        seed: u64,
        pose: usize,
    ) -> Result<CellResult, CampaignError> {
        let config = TuneConfig {
            // Poses of one seed differ in phases and noise too.
            seed: seed * 10 + pose as u64,
            strategy: strategy.strategy,
            friction: case.friction,
            truth: case.truth.clone(),
            velocity: self.velocity,
            trials: strategy.trials,
            stop_below: Some(StopBelow::Never),
            change_law: Some(false),
            pose,
            phases: Phases::Random,
            // The paper's search tries whatever it draws.
            guard: None,
            ..TuneConfig::default()
        };
        let tune = config.validate::<7>().map_err(CampaignError::Config)?;
        let mut oracle = 0.0;
        let mut uncompensated = 0.0;
        for run in 0..self.oracle_runs {
            let mut other_noise = tune.clone();
            other_noise.config.seed = tune.config.seed + 1_000_003 * (run + 1);
            let costs = references(&other_noise)?;
            oracle += costs.oracle / self.oracle_runs as f64;
            uncompensated += costs.uncompensated / self.oracle_runs as f64;
        }
        let trials = run_in_memory(&tune)?.trials;
        Ok(CellResult {
            truth: case.truth.clone(),
            strategy: strategy.strategy,
            seed,
            pose,
            oracle,
            uncompensated,
            // Four decimals: costs repeat to per cents.
            ratio: trials.iter().map(|trial| (1e4 * trial.cost.total() / oracle).round() / 1e4).collect(),
            penalties: trials.iter().filter(|trial| trial.aborted.is_some()).count(),
        })
    }
}

/// One row per truth and strategy, in the order in which they first appear.
pub fn summarize(cells: &[CellResult]) -> Vec<RowSummary> {
    let mut keys: Vec<(&TruthName, StrategyName)> = Vec::new();
    for cell in cells {
        if !keys.contains(&(&cell.truth, cell.strategy)) {
            keys.push((&cell.truth, cell.strategy));
        }
    }
    keys.into_iter()
        .map(|(truth, strategy)| {
            let of_row: Vec<&CellResult> =
                cells.iter().filter(|cell| &cell.truth == truth && cell.strategy == strategy).collect();
            let count = of_row.len() as f64;
            let mean = |value: &dyn Fn(&CellResult) -> f64| of_row.iter().map(|cell| value(cell)).sum::<f64>() / count;
            let worst = |value: &dyn Fn(&CellResult) -> f64| of_row.iter().map(|cell| value(cell)).fold(0.0, f64::max);
            let best = |cell: &CellResult, trials: usize| {
                cell.ratio.iter().take(trials).copied().fold(f64::INFINITY, f64::min)
            };
            let mut reached: Vec<f64> = of_row
                .iter()
                .map(|cell| cell.ratio.iter().position(|&r| r <= 1.1).map_or(f64::INFINITY, |k| k as f64 + 1.0))
                .collect();
            reached.sort_by(f64::total_cmp);
            let median = 0.5 * (reached[(reached.len() - 1) / 2] + reached[reached.len() / 2]);
            RowSummary {
                truth: truth.clone(),
                strategy,
                campaigns: of_row.len(),
                uncompensated_ratio: mean(&|cell| cell.uncompensated / cell.oracle),
                second_mean: mean(&|cell| cell.ratio[1]),
                second_worst: worst(&|cell| cell.ratio[1]),
                best_mean: [5, 20, usize::MAX].map(|trials| mean(&|cell| best(cell, trials))),
                best_worst: worst(&|cell| best(cell, usize::MAX)),
                trials_to_1_1: median.is_finite().then_some(median),
                never: reached.iter().filter(|trials| trials.is_infinite()).count(),
                penalties: mean(&|cell| cell.penalties as f64),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_model::YamlDocument;

    /// Ten seeds and three poses of three strategies, four seeds of the fourth, on three truths.
    #[test]
    fn a_strategy_may_have_fewer_seeds() {
        let text = crate::reproduce::shipped::ROVEDA2022;
        let mut shipped: Roveda2022 = YamlDocument::embedded("config.yaml", text).parse().unwrap();
        shipped.validate().unwrap();
        assert_eq!(shipped.cells(), 3 * (3 * 10 + 4) * 3);
        shipped.seeds = 2;
        assert_eq!(shipped.cells(), 3 * 4 * 2 * 3);
        shipped.strategies[0].seeds = Some(0);
        let error = shipped.validate().unwrap_err().to_string();
        assert!(error.contains("strategies.seeds"), "{error}");
    }
}
