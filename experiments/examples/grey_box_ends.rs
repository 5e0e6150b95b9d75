//! How good `grey_box` is when it ends, run again on noise that no trial has seen.
//!
//! ```sh
//! cargo run --release -p tribo-experiments --example grey_box_ends -- 1..41 coulomb_viscous stribeck lugre gaz soft
//! ```
//!
//! For each simulated (true) friction: expected J of trial 2, and of the best trial, over that of the true friction, all three on the same
//! eight draws of noise; trials until the campaign ended; how many campaigns went over to another law.

use std::error::Error;

use rayon::prelude::*;
use tribo_campaign::scenario::TruthName;
use tribo_campaign::{AnyEstimator, InMemory, Phases, TuneConfig, ValidTune, run_in_memory, run_trial};
use tribo_friction::FrictionModel;

/// Draws of noise on which a compensator is judged.
const DRAWS: usize = 8;
/// First number of trials that no campaign runs.
const UNSEEN: usize = 20_000;

/// What came of one campaign.
struct Ended {
    /// J of trial 2 over that of the true friction.
    second: f64,
    /// The same of the best trial.
    best: f64,
    /// Mean of J of the best trial less that of trial 2, and its standard error, over J of the true friction.
    gain: [f64; 2],
    trials: usize,
    changed_law: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let range = arguments.next().ok_or("usage: grey_box_ends FIRST..END TRUTH ...")?;
    let (first, end) = range.split_once("..").ok_or("seeds are FIRST..END")?;
    let seeds: Vec<u64> = (first.parse()?..end.parse()?).collect();
    println!(
        "| simulated friction | campaigns | trial 2: median, 95 %, worst | ≤ 1.05 | best trial: median, worst | worse than trial 2 by > 1 SE, > 2 SE, at most | trials: median, most | other law |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for truth in arguments {
        let ended = seeds.par_iter().map(|seed| run(&truth, *seed)).collect::<Result<Vec<_>, String>>()?;
        let sorted = |of: &dyn Fn(&Ended) -> f64| {
            let mut values: Vec<f64> = ended.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let at = |values: &[f64], share: f64| values[((share * values.len() as f64).ceil() as usize).max(1) - 1];
        let (second, best) = (sorted(&|it| it.second), sorted(&|it| it.best));
        let trials = sorted(&|it| it.trials as f64);
        let worse = |deviations: f64| ended.iter().filter(|it| it.gain[0] > deviations * it.gain[1]).count();
        println!(
            "| {truth} | {} | {:.3}, {:.3}, {:.3} | {} | {:.3}, {:.3} | {}, {}, {:.3} | {}, {} | {} |",
            ended.len(),
            at(&second, 0.5),
            at(&second, 0.95),
            at(&second, 1.0),
            second.iter().filter(|ratio| **ratio <= 1.05).count(),
            at(&best, 0.5),
            at(&best, 1.0),
            worse(1.0),
            worse(2.0),
            ended.iter().map(|it| it.gain[0]).fold(0.0, f64::max),
            at(&trials, 0.5),
            at(&trials, 1.0),
            ended.iter().filter(|it| it.changed_law).count(),
        );
    }
    Ok(())
}

fn run(truth: &str, seed: u64) -> Result<Ended, String> {
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
            None => (trial.believing(&tune.oracle), tune.oracle.friction),
        };
        let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, &trial.model, &friction);
        let estimator = estimator.map_err(|error| error.to_string())?;
        Ok(run_trial(&trial, &friction, estimator, seed).cost.total())
    };
    (0..DRAWS).map(draw).collect()
}
