//! What a campaign tuned, as a file.

use tribo_friction::Compensator;
use tribo_model::TunedFile;

use crate::ValidTune;
use crate::strategy::BestTrial;

/// The compensator of a trial, with parameters θ; nothing is said of its cost.
pub fn trial_compensator<const N: usize>(tune: &ValidTune<N>, trial: usize, theta: &[f64]) -> TunedFile {
    let compensator: Compensator<N> = Compensator::new(tune.space.friction(theta), tune.config.velocity);
    let model = tune.config.model_content.as_ref().or(tune.config.robot_content.as_ref()).cloned();
    TunedFile::of_trial(&tune.trial.model.name, (tune.config.seed, trial), &compensator, model)
}

/// The compensator of the best trial, which has parameters θ, with its cost and that of not compensating, where it is known.
pub fn finished_compensator<const N: usize>(
    tune: &ValidTune<N>,
    theta: &[f64],
    best: &BestTrial,
    uncompensated_cost: Option<f64>,
) -> TunedFile {
    let BestTrial { trial, cost, sd, .. } = *best;
    TunedFile { cost: Some(cost), cost_sd: sd, uncompensated_cost, ..trial_compensator(tune, trial, theta) }
}
