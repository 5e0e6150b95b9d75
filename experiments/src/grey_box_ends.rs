//! How good `grey_box` is when it ends, on noise that no trial has seen.

use tribo_campaign::{InMemory, Phases, TuneConfig, ValidTune, run_in_memory};
use tribo_friction::FrictionModel;
use tribo_trial::scenario::TruthName;
use tribo_trial::{AnyEstimator, run_trial};

/// Draws of noise on which a compensator is judged.
const DRAWS: usize = 8;
/// First number of trials that no campaign runs.
const UNSEEN: usize = 20_000;

/// What came of one campaign.
#[derive(Clone, Debug)]
pub struct Ended {
    /// J of trial 2 over that of the true friction.
    pub second: f64,
    /// The same of the best trial.
    pub best: f64,
    /// Mean of J of the best trial less that of trial 2, and its standard error, over J of the true friction.
    pub gain: [f64; 2],
    /// Trials until it ended.
    pub trials: usize,
    /// Whether it went over to another friction law.
    pub changed_law: bool,
}

/// Runs a campaign of `grey_box` to its end on a simulated Panda with that friction, phases and noise by the seed, and judges it on eight draws of noise, the
/// same for trial 2, the best trial and the true friction.
///
/// # Errors
/// What the campaign says: an unknown friction, a strategy without an answer.
pub fn grey_box_to_its_end(truth: &str, seed: u64) -> Result<Ended, String> {
    let truth = TruthName::from(truth.to_owned());
    let config = TuneConfig { seed, phases: Phases::Random, truth, ..TuneConfig::default() };
    let tune = config.validate::<7>().map_err(|error| error.to_string())?;
    let InMemory { trials, conclusion, space, law_change, .. } =
        run_in_memory(&tune).map_err(|error| error.to_string())?;
    let best = conclusion.best.ok_or("no trial was seen to its end")?.trial;
    let friction = |number: usize| space.friction(&trials[number.min(trials.len() - 1)].theta);
    let oracle = costs(&tune, None)?;
    let (second, last) = (costs(&tune, Some(&friction(2)))?, costs(&tune, Some(&friction(best)))?);
    let mean = |costs: &[f64]| costs.iter().sum::<f64>() / costs.len() as f64;
    let differences: Vec<f64> = last.iter().zip(&second).map(|(last, second)| last - second).collect();
    let difference = mean(&differences);
    let spread = differences.iter().map(|it| (it - difference).powi(2)).sum::<f64>() / (DRAWS - 1) as f64;
    Ok(Ended {
        second: mean(&second) / mean(&oracle),
        best: mean(&last) / mean(&oracle),
        gain: [difference, (spread / DRAWS as f64).sqrt()].map(|it| it / mean(&oracle)),
        trials: trials.len(),
        changed_law: law_change.is_some(),
    })
}

/// J on unseen noise of a compensator that believes this friction; none is a controller that believes the truth.
fn costs(tune: &ValidTune<7>, friction: Option<&FrictionModel<7>>) -> Result<Vec<f64>, String> {
    let draw = |draw: usize| {
        let (trial, seed) = tune.numbered(UNSEEN + draw);
        let (trial, friction) = match friction {
            Some(friction) => (trial, *friction),
            None => (trial.with_controller_model(&tune.oracle), tune.oracle.friction),
        };
        let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, &trial, &friction);
        let estimator = estimator.map_err(|error| error.to_string())?;
        Ok(run_trial(&trial, &friction, estimator, seed).cost.total())
    };
    (0..DRAWS).map(draw).collect()
}
