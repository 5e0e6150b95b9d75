//! Trials that fail: the model of where they do.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

use crate::common::{PROBLEMS, given_history};
use tribo_bayesopt::{Domain, Outcome, Settings, Study, suggest};

fn settings(feasibility: bool, dimension: usize) -> Settings {
    let mut settings = Settings::bo(vec![0.0; dimension]);
    settings.model.as_mut().unwrap().feasibility = feasibility;
    settings
}

#[test]
fn without_a_failed_trial_nothing_changes_to_the_last_bit() {
    let problem = &PROBLEMS[1];
    let domain = Domain::unit_cube(problem.dimension).unwrap();
    let mut history = given_history(problem, 2);
    history.push(vec![0.4; 6], Outcome::Pending);
    let ask = |feasibility| suggest(&settings(feasibility, 6), &domain, &history, 2).unwrap();
    assert_eq!(ask(true), ask(false));
}

/// The minimum lies near a region in which every trial fails, the sooner the further inside.
fn near_the_edge(x: &[f64]) -> Outcome {
    let excess = x.iter().map(|x| (x - 0.3).max(0.0)).sum::<f64>() - 0.15;
    if excess > 0.0 {
        return Outcome::Failed { value: None, part: Some((-4.0 * excess).exp()) };
    }
    Outcome::Value(1.0 + x.iter().map(|x| (x - 0.3).powi(2)).sum::<f64>())
}

#[test]
fn fewer_trials_fail_and_as_much_is_found() {
    let run = |feasibility, seed| {
        let mut study = Study::new(settings(feasibility, 4), Domain::unit_cube(4).unwrap(), seed).unwrap();
        for _ in 0..30 {
            let suggestion = study.ask().unwrap();
            study.tell(suggestion.trial, near_the_edge(&suggestion.point)).unwrap();
        }
        let trials = &study.history().trials[10..];
        let failed = trials.iter().filter(|trial| trial.outcome.success().is_none()).count();
        (failed, study.incumbent().unwrap().1)
    };
    let total = |feasibility| {
        let runs: Vec<(usize, f64)> = (1..=12).map(|seed| run(feasibility, seed)).collect();
        (runs.iter().map(|run| run.0).sum::<usize>(), runs.iter().map(|run| run.1).sum::<f64>() / 12.0)
    };
    let (with, without) = (total(true), total(false));
    assert!(with.0 < without.0, "{with:?} {without:?}");
    assert!(with.1 < without.1 + 0.002, "{with:?} {without:?}");
}
