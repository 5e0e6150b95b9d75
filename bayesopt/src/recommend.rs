//! What to use after the last trial.

use serde::{Deserialize, Serialize};

use crate::{BayesoptError, Domain, History, Settings, SurrogateModel};

/// The point to use.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recommendation {
    /// The trial that tried it, the first that did.
    pub trial: usize,
    /// The point, real units.
    pub point: Vec<f64>,
    /// What it will cost: the posterior median of noisy costs, else the cost that was seen.
    pub cost: f64,
    /// Standard deviation of that expectation, from the central 68 % of the noise-free cost; none where what was seen counts.
    pub sd: Option<f64>,
}

/// The trial with the least cost, or, of noisy costs, with the least posterior mean: the luckiest of fifty trials is seldom the best.
/// None before the first trial that did not fail.
///
/// The rule is that of the incumbent in [`crate::suggest()`]; settings without model, or with `noise_aware` off, take the least cost.
///
/// # Errors
/// A setting out of range, a history that does not fit the domain, or a kernel matrix beyond repair.
pub fn recommend(
    settings: &Settings,
    domain: &Domain,
    history: &History,
    seed: u64,
) -> Result<Option<Recommendation>, BayesoptError> {
    settings.validate(domain)?;
    let Some((least, seen)) = history.incumbent() else { return Ok(None) };
    let surrogate = match &settings.model {
        Some(model) if model.noise_aware => SurrogateModel::of(model, domain, history, seed)?,
        _ => None,
    };
    let (trial, cost, sd) = match surrogate {
        Some(surrogate) if surrogate.noisy => {
            let place = domain.to_unit(&history.trials[surrogate.incumbent].point)?;
            let at = surrogate.gp.posterior_batch(&[place])[0];
            let [low, high] = [-at.sd, at.sd].map(|step| surrogate.targets.cost(surrogate.best_target + step));
            (surrogate.incumbent, surrogate.targets.cost(surrogate.best_target), Some(0.5 * (high - low).abs()))
        }
        _ => (least, seen, None),
    };
    Ok(Some(Recommendation { trial, point: history.trials[trial].point.clone(), cost, sd }))
}
