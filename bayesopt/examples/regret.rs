//! Simple regret after 50 evaluations on the problems of `docs/optimiser_problems.md` and on variants of them.
//!
//! `cargo run --release -p tribo-bayesopt --example regret -- [seeds|FROM..TO] [paper|bo] [problem…]`
//!
//! Where problems are named, the regret of every seed follows, in order: the same ten points as `benches/peers/botorch_regret.py` begins with.
//! Milliseconds are processor time of a thread per suggestion, fit and search together. Seeds 20 to 39 served to choose
//! the settings of `bo`; seeds 0 to 19, the default, are the ones to report.

#[path = "../tests/optimiser/common/mod.rs"]
mod common;

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use common::{PROBLEMS, Problem, VARIANTS, median, random_regret, seeds_of, simple_regret};
use tribo_bayesopt::{BayesoptError, Settings};

fn main() -> Result<(), BayesoptError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let seeds = arguments.first().and_then(|text| seeds_of(text)).unwrap_or(0..20);
    let paper = arguments.get(1).is_some_and(|text| text == "paper");
    let chosen = arguments.get(2..).unwrap_or_default();
    println!("| problem | median | quartiles | worst | random | ms |\n|---|---|---|---|---|---|");
    let asked = |p: &&Problem| chosen.is_empty() || chosen.iter().any(|name| name == p.name);
    for problem in PROBLEMS.iter().chain(&VARIANTS).filter(asked) {
        let settings = if paper { Settings::paper() } else { Settings::bo(vec![0.0; problem.dimension]) };
        let (by_seed, ms) = regrets(problem, &settings, seeds.clone())?;
        let mut regrets = by_seed.clone();
        regrets.sort_by(f64::total_cmp);
        let count = regrets.len();
        println!(
            "| {} | {:.2e} | {:.1e} – {:.1e} | {:.1e} | {:.1e} | {ms:.0} |",
            problem.name,
            median(regrets.clone()),
            regrets[count / 4],
            regrets[3 * count / 4],
            regrets[count - 1],
            median(seeds.clone().map(|s| random_regret(problem, s, 50)).collect()),
        );
        if !chosen.is_empty() {
            let list: Vec<String> = by_seed.iter().map(|regret| format!("{regret:.4e}")).collect();
            println!("{}", list.join(" "));
        }
    }
    Ok(())
}

/// Regret of each seed, in order, and the milliseconds of a suggestion; seeds are shared among the processors.
fn regrets(problem: &Problem, settings: &Settings, seeds: Range<u64>) -> Result<(Vec<f64>, f64), BayesoptError> {
    let next = AtomicU64::new(seeds.start);
    let found = Mutex::new((vec![], 0.0));
    let threads = std::thread::available_parallelism().map_or(1, |count| count.get());
    let work = || -> Result<(), BayesoptError> {
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                return Ok(());
            }
            let begin = thread_seconds();
            let regret = simple_regret(problem, settings, seed, 50)?;
            let mut found = found.lock().unwrap_or_else(PoisonError::into_inner);
            found.0.push((seed, regret));
            found.1 += thread_seconds() - begin;
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().unwrap_or(Ok(())))
    })?;
    let (mut regrets, seconds) = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    let asks = 40.0 * regrets.len() as f64;
    regrets.sort_by_key(|(seed, _)| *seed);
    Ok((regrets.into_iter().map(|(_, regret)| regret).collect(), 1e3 * seconds / asks))
}

/// Processor time of this thread where the system tells (Linux), else the time of the day [s].
fn thread_seconds() -> f64 {
    let schedule = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = schedule.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    let wall = || SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64());
    nanoseconds.map_or_else(wall, |nanoseconds| 1e-9 * nanoseconds)
}
