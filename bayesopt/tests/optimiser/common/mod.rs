//! A library of problems with known answers (`docs/optimiser_problems.md`), shared by all tests and examples.
#![allow(dead_code, missing_docs)]

pub mod crash;
pub mod friction;
pub mod random_source;
pub mod standard;
pub mod variants;

use random_source::RandomSource;
use tribo_bayesopt::{BayesoptError, Domain, History, Outcome, Settings, suggest};

/// A function on the unit cube with its least value.
#[derive(Clone, Copy)]
pub struct Problem {
    pub name: &'static str,
    pub dimension: usize,
    pub value: fn(&[f64]) -> f64,
    pub least: f64,
}

pub const PROBLEMS: [Problem; 6] = [
    Problem { name: "branin2", dimension: 2, value: standard::branin2, least: 0.39788735772973816 },
    Problem { name: "hartmann6", dimension: 6, value: standard::hartmann6, least: -3.322368011391339 },
    Problem { name: "ackley14", dimension: 14, value: standard::ackley14, least: 0.0 },
    Problem { name: "levy14", dimension: 14, value: standard::levy14, least: 0.0 },
    Problem { name: "fric14", dimension: 14, value: friction::fric14, least: 0.0 },
    Problem { name: "fric35", dimension: 35, value: friction::fric35, least: 0.0 },
];

/// What the settings were not chosen on.
pub const VARIANTS: [Problem; 6] = [
    Problem { name: "ackley14_shifted", dimension: 14, value: variants::ackley14_shifted, least: 0.0 },
    Problem { name: "ackley14_mixed", dimension: 14, value: variants::ackley14_mixed, least: 0.0 },
    Problem { name: "levy14_shifted", dimension: 14, value: variants::levy14_shifted, least: 0.0 },
    Problem { name: "levy14_mixed", dimension: 14, value: variants::levy14_mixed, least: 0.0 },
    Problem { name: "hartmann6_in_14", dimension: 14, value: variants::hartmann6_in_14, least: -3.322368011391339 },
    Problem { name: "ellipsoid14", dimension: 14, value: variants::ellipsoid14, least: 0.0 },
];

/// The ten given points of seed s, by the protocol of `docs/optimiser_problems.md`.
pub fn given_history(problem: &Problem, s: u64) -> History {
    let mut source = RandomSource::seed(1000 + s);
    let mut history = History::new();
    for _ in 0..10 {
        let u = source.point(problem.dimension);
        let value = (problem.value)(&u);
        history.push(u, Outcome::Value(value));
    }
    history
}

/// Simple regret after `evaluations`, of `settings` after the ten given points.
pub fn simple_regret(problem: &Problem, settings: &Settings, s: u64, evaluations: usize) -> Result<f64, BayesoptError> {
    let domain = Domain::unit_cube(problem.dimension)?;
    let mut history = given_history(problem, s);
    while history.len() < evaluations {
        let suggestion = suggest(settings, &domain, &history, s)?;
        let value = (problem.value)(&suggestion.point);
        history.push(suggestion.point, Outcome::Value(value));
    }
    Ok(best_cost(&history) - problem.least)
}

/// Simple regret of the peers' random search, by the protocol of `docs/optimiser_problems.md`.
pub fn random_regret(problem: &Problem, s: u64, evaluations: usize) -> f64 {
    let mut source = RandomSource::seed(900_000 + s);
    let mut best = best_cost(&given_history(problem, s));
    for _ in 10..evaluations {
        best = best.min((problem.value)(&source.point(problem.dimension)));
    }
    best - problem.least
}

fn best_cost(history: &History) -> f64 {
    history.incumbent().map_or(f64::INFINITY, |(_, cost)| cost)
}

pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) }
}

/// `20` or `20..40`.
pub fn seeds_of(text: &str) -> Option<std::ops::Range<u64>> {
    let (from, to) = text.split_once("..").unwrap_or(("0", text));
    Some(from.parse().ok()?..to.parse().ok()?).filter(|range| !range.is_empty())
}
