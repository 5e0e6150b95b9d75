//! Costs that do not repeat: which trial to believe, and which to try again.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

use crate::common::random_source::RandomSource;
use tribo_bayesopt::{Domain, History, Outcome, Phase, Settings, recommend, suggest};

const DIMENSION: usize = 4;
const TRIALS: usize = 35;
const SEEDS: u64 = 30;

fn bowl(x: &[f64]) -> f64 {
    1.0 + x.iter().map(|x| (x - 0.4).powi(2)).sum::<f64>()
}

fn settings(noise_aware: bool, repeat_one_in: Option<usize>) -> Settings {
    let mut settings = Settings::bo(vec![0.1; DIMENSION]);
    let model = settings.model.as_mut().unwrap();
    (model.noise_aware, model.repeat_one_in) = (noise_aware, repeat_one_in);
    settings
}

/// A search on the bowl with noise of this deviation; the history and how many trials were repeats.
fn search(settings: &Settings, noise: f64, seed: u64) -> (History, usize) {
    let domain = Domain::unit_cube(DIMENSION).unwrap();
    let mut source = RandomSource::seed(77 + seed);
    let (mut history, mut repeats) = (History::new(), 0);
    for _ in 0..TRIALS {
        let suggestion = suggest(settings, &domain, &history, seed).unwrap();
        repeats += usize::from(suggestion.phase == Phase::Repeat);
        let cost = bowl(&suggestion.point) + noise * source.normal();
        history.push(suggestion.point, Outcome::Value(cost));
    }
    (history, repeats)
}

/// True excess cost of the recommended point, mean over the seeds, and repeats in all.
fn excess(settings: &Settings, noise: f64) -> (f64, usize) {
    let domain = Domain::unit_cube(DIMENSION).unwrap();
    let runs = (0..SEEDS).map(|seed| {
        let (history, repeats) = search(settings, noise, seed);
        let chosen = recommend(settings, &domain, &history, seed).unwrap().unwrap();
        (bowl(&chosen.point) - 1.0, repeats)
    });
    let (excess, repeats): (Vec<f64>, Vec<usize>) = runs.unzip();
    (excess.iter().sum::<f64>() / SEEDS as f64, repeats.iter().sum())
}

#[test]
fn what_is_recommended_is_truly_cheaper_than_the_luckiest_trial() {
    let plain = excess(&settings(false, None), 0.05);
    let aware = excess(&settings(true, None), 0.05);
    let repeating = excess(&settings(true, Some(5)), 0.05);
    println!("plain {plain:?} aware {aware:?} repeating {repeating:?}");
    assert!(aware.0 < plain.0, "{plain:?} {aware:?}");
    assert!(repeating.0 < plain.0, "{plain:?} {repeating:?}");
    assert!(repeating.1 > 0 && repeating.1 <= SEEDS as usize * (TRIALS - 10) / 5, "{repeating:?}");
}

#[test]
fn a_cost_that_repeats_is_left_alone() {
    let domain = Domain::unit_cube(DIMENSION).unwrap();
    let chosen = settings(true, Some(5));
    let (history, repeats) = search(&chosen, 0.0, 3);
    assert_eq!(repeats, 0);
    let recommended = recommend(&chosen, &domain, &history, 3).unwrap().unwrap();
    assert_eq!((recommended.trial, recommended.cost), history.incumbent().unwrap());
    assert_eq!(history, search(&settings(false, None), 0.0, 3).0);
}

#[test]
fn nothing_is_recommended_before_a_trial_has_finished() {
    let (domain, mut history) = (Domain::unit_cube(DIMENSION).unwrap(), History::new());
    history.push(vec![0.3; DIMENSION], Outcome::FAILED);
    assert_eq!(recommend(&settings(true, None), &domain, &history, 1).unwrap(), None);
}
