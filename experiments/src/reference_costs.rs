//! Costs that put a result into proportion.

use rayon::prelude::*;
use tribo_friction::FrictionModel;
use tribo_friction::law::CoulombViscous;

use crate::numbered_trial::{noise_seed, run_estimated};
use crate::{Trial, ValidTune};

/// Costs that put a campaign's result into proportion; known only in simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct References {
    /// J without compensation.
    pub uncompensated: f64,
    /// J with the true steady friction, cold, as compensator.
    pub oracle: f64,
    /// J of the same arm without friction.
    pub frictionless: f64,
}

/// The three reference costs, on noise of their own.
pub fn references(tune: &ValidTune) -> References {
    let none = FrictionModel::uniform(CoulombViscous::default().into());
    let mut smooth = tune.trial.clone();
    smooth.truth.friction = none;
    let runs: [(&Trial<7>, FrictionModel<7>); 3] =
        [(&tune.trial, none), (&tune.trial, tune.trial.truth.friction), (&smooth, none)];
    let costs: Vec<f64> = runs
        .par_iter()
        .enumerate()
        .map(|(k, (trial, friction))| {
            let seed = noise_seed(tune.config.seed, u64::MAX - k as u64);
            run_estimated(tune, trial, friction, seed).cost.total()
        })
        .collect();
    References { uncompensated: costs[0], oracle: costs[1], frictionless: costs[2] }
}
