//! Median simple regret after 50 evaluations on the problems of `reference/FUNCTIONS.md` §4, beside random search.
//!
//! `cargo run --release -p tribo-bayesopt --example regret -- [seeds] [paper|bo] [problem…]`

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use common::{PROBLEMS, given_history, median, random_regret, simple_regret};
use tribo_bayesopt::{BayesoptError, Settings};

fn main() -> Result<(), BayesoptError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let seeds: u64 = arguments.first().and_then(|text| text.parse().ok()).unwrap_or(5);
    let paper = arguments.get(1).is_some_and(|text| text == "paper");
    let chosen = arguments.get(2..).unwrap_or_default();
    println!("{:10} {:>12} {:>12} {:>12} {:>10}  per seed", "problem", "regret", "worst", "random", "ms/ask");
    for problem in PROBLEMS.iter().filter(|p| chosen.is_empty() || chosen.iter().any(|name| name == p.name)) {
        let settings = if paper { Settings::paper() } else { Settings::bo(vec![0.0; problem.dimension]) };
        let begin = Instant::now();
        let regrets = (0..seeds).map(|s| simple_regret(problem, &settings, s, 50)).collect::<Result<Vec<f64>, _>>()?;
        let asks = seeds as f64 * (50 - given_history(problem, 0).len()) as f64;
        let ms = begin.elapsed().as_secs_f64() * 1e3 / asks;
        let worst = regrets.iter().copied().fold(0.0, f64::max);
        let random = median((0..seeds).map(|s| random_regret(problem, s, 50)).collect());
        let each: Vec<String> = regrets.iter().map(|r| format!("{r:.2e}")).collect();
        println!(
            "{:10} {:12.3e} {:12.3e} {:12.3e} {:10.1}  {}",
            problem.name,
            median(regrets),
            worst,
            random,
            ms,
            each.join(" ")
        );
    }
    Ok(())
}
