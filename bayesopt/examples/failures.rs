//! Trials that fail, and what is found in spite of them: 50 evaluations of the friction functions of `docs/optimiser_problems.md`
//! with two kinds of abort.
//!
//! `cargo run --release -p tribo-bayesopt --example failures -- [seeds|FROM..TO] [with|without] [energy|excess]`
//!
//! `energy`: the function's own crash (energy above 2) is an abort at ξ instead of a penalised cost. `excess`: a trial is aborted
//! where the coordinates lie more than 0.12 √d above the optimum in all (Σ max(0, u − u*)), at `ξ/T = bound/excess`; from zero
//! compensation as on a robot, since none of the ten given points of the protocol would be finished.

#[path = "../tests/optimiser/common/mod.rs"]
mod common;

use std::ops::Range;
use std::sync::Mutex;

use common::crash::{CRASHES, Crash};
use common::{median, seeds_of};
use tribo_bayesopt::{BayesoptError, Domain, Outcome, Settings, Study};

fn main() -> Result<(), BayesoptError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let seeds = arguments.first().and_then(|text| seeds_of(text)).unwrap_or(0..20);
    let feasibility = arguments.get(1).is_none_or(|text| text != "without");
    let only = arguments.get(2);
    println!("| function | abort | start | failed of 50, mean | after the design | median cost | quartiles |");
    println!("|---|---|---|---|---|---|---|");
    for crash in CRASHES.iter().filter(|crash| only.is_none_or(|kind| kind == crash.kind)) {
        let (mut failed, mut late, mut costs) = (0, 0, Vec::new());
        for run in runs(crash, feasibility, seeds.clone())? {
            failed += run.failed;
            late += run.failed_late;
            costs.push(run.cost);
        }
        costs.sort_by(f64::total_cmp);
        let (n, count) = (costs.len(), costs.len() as f64);
        println!(
            "| {} | {} | {} | {:.1} | {:.1} | {:.2} | {:.1} – {:.1} |",
            crash.problem,
            crash.kind,
            if crash.given { "given" } else { "zero" },
            f64::from(failed) / count,
            f64::from(late) / count,
            median(costs.clone()),
            costs[n / 4],
            costs[3 * n / 4],
        );
    }
    Ok(())
}

/// What came of fifty trials.
struct Run {
    failed: u32,
    failed_late: u32,
    cost: f64,
}

fn runs(crash: &Crash, feasibility: bool, seeds: Range<u64>) -> Result<Vec<Run>, BayesoptError> {
    let next = Mutex::new(seeds);
    let work = || -> Result<Vec<Run>, BayesoptError> {
        let mut found = Vec::new();
        loop {
            let seed = next.lock().unwrap_or_else(std::sync::PoisonError::into_inner).next();
            let Some(seed) = seed else { return Ok(found) };
            found.push(run(crash, feasibility, seed)?);
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..2).map(|_| scope.spawn(work)).collect();
        let mut all = Vec::new();
        for worker in workers {
            all.extend(worker.join().unwrap_or(Ok(vec![]))?);
        }
        Ok(all)
    })
}

fn run(crash: &Crash, feasibility: bool, seed: u64) -> Result<Run, BayesoptError> {
    let d = crash.dimension;
    let mut settings = Settings::bo(vec![0.0; d]);
    if let Some(model) = settings.model.as_mut() {
        model.feasibility &= feasibility;
    }
    let mut study = Study::resume(settings, Domain::unit_cube(d)?, seed, crash.first_trials(seed))?;
    while study.history().len() < 50 {
        let suggestion = study.ask()?;
        study.tell(suggestion.trial, (crash.outcome)(&suggestion.point))?;
    }
    let failures = |from: usize| {
        let later = &study.history().trials[from..];
        later.iter().filter(|trial| matches!(trial.outcome, Outcome::Failed { .. })).count() as u32
    };
    let cost = study.incumbent().map_or(f64::INFINITY, |(_, cost)| cost);
    Ok(Run { failed: failures(0), failed_late: failures(10), cost })
}
