//! What a cell of a study computes.

use serde::{Deserialize, Serialize};
use tribo_friction::FrictionModel;
use tribo_model::file_name;
use tribo_trial::{AbortReason, EstimatorError};

use super::place::{Cell, Work};
use super::settings::Study;
use crate::reference_costs::compensated_cost;
use crate::{AnyTune, CampaignError, InMemory, References, ValidTune, references, run_in_memory};

/// What came of a cell. No time and no machine is in it: who computes it makes no difference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum CellResult {
    /// Costs to compare with.
    References {
        /// Mean J without compensation.
        uncompensated: f64,
        /// Mean J of the true friction.
        oracle: f64,
        /// Mean J without friction.
        frictionless: f64,
    },
    /// The trials of a campaign.
    Campaign {
        /// J of each trial, penalties included.
        cost: Vec<f64>,
        /// Why each was stopped, if it was.
        aborted: Vec<Option<AbortReason>>,
        /// Parameters of the trial that is believed best.
        best: Vec<f64>,
        /// Mean J of another trial with these, on the noise of the references: no campaign's luck is in it. None where no trial was seen to its
        /// end.
        again: Option<f64>,
    },
}

impl Cell {
    /// Its name, and that of its file.
    pub fn name(&self, study: &Study) -> String {
        let estimator = study.estimators[self.estimator].as_str();
        let work = match self.work {
            Work::References => "references".to_owned(),
            Work::Campaign(k) => {
                format!("{}_{}", file_name(&study.strategies[k].strategy), study.strategies[k].trials)
            }
        };
        format!("case{}_{estimator}_pose{}_seed{:04}_{work}", self.case, self.pose, self.seed)
    }

    /// Computes it, on this thread but for the references.
    ///
    /// # Errors
    /// Settings out of range, a strategy without an answer.
    pub fn run(&self, study: &Study) -> Result<CellResult, CampaignError> {
        match study.config_of(self).validate_any()? {
            AnyTune::Six(tune) => self.run_on(study, &tune),
            AnyTune::Seven(tune) => self.run_on(study, &tune),
        }
    }

    fn run_on<const N: usize>(&self, study: &Study, tune: &ValidTune<N>) -> Result<CellResult, CampaignError> {
        match self.work {
            Work::References => Ok(mean_references(tune, study.oracle_runs)?),
            Work::Campaign(_) => {
                let InMemory { trials, conclusion, space, .. } = run_in_memory(tune)?;
                let best = conclusion.best.map(|best| trials[best.trial].theta.clone());
                let again = best.as_ref().map(|theta| again(tune, &space.friction(theta), study.oracle_runs));
                Ok(CellResult::Campaign {
                    cost: trials.iter().map(|trial| trial.cost.total()).collect(),
                    aborted: trials.iter().map(|trial| trial.aborted).collect(),
                    best: best.unwrap_or_default(),
                    again: again.transpose()?,
                })
            }
        }
    }
}

fn mean_references<const N: usize>(tune: &ValidTune<N>, runs: u64) -> Result<CellResult, EstimatorError> {
    let mut sum = [0.0; 3];
    for run in 0..runs {
        let References { uncompensated, oracle, frictionless, .. } = references(&on_other_noise(tune, run))?;
        sum.iter_mut().zip([uncompensated, oracle, frictionless]).for_each(|(sum, cost)| *sum += cost);
    }
    let [uncompensated, oracle, frictionless] = sum.map(|sum| sum / runs as f64);
    Ok(CellResult::References { uncompensated, oracle, frictionless })
}

/// Mean J of a compensator that believes this friction, on the noise that [`mean_references`] has for the true one.
fn again<const N: usize>(tune: &ValidTune<N>, friction: &FrictionModel<N>, runs: u64) -> Result<f64, EstimatorError> {
    let costs = (0..runs).map(|run| compensated_cost(&on_other_noise(tune, run), friction));
    Ok(costs.sum::<Result<f64, EstimatorError>>()? / runs as f64)
}

/// The campaign on noise that none of its own trials has.
fn on_other_noise<const N: usize>(tune: &ValidTune<N>, run: u64) -> ValidTune<N> {
    let mut other = tune.clone();
    other.config.seed = tune.config.seed + 1_000_003 * (run + 1);
    other
}
