//! Story: a result that depends on the seed and on nothing else.
//!
//! Parameters, costs and every attribute in journal.log are the same bits with one thread and with two, for a strategy
//! whose trials run side by side, one whose trials wait for each other, and one that is both; another seed gives others.
//! Only the order of the lines of trials that ran side by side, and the times of day, may differ.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{Trial, journal, result, run, scratch};

/// The journal of a campaign of six trials, and its result.
fn campaign(at: &Path, strategy: &str, seed: u64, threads: usize, name: &str) -> (Vec<Trial>, String) {
    let arguments = format!("--strategy {strategy} --seed {seed} --threads {threads} --out {name}");
    let document =
        run(at, &format!("tune --trials 6 --init 4 --stop-below never --phases random {arguments} --json")).ok().json();
    let trials = journal(&at.join(name));
    assert_eq!(trials.len(), 6);
    assert!(trials.iter().all(|trial| trial.end.is_some() && trial.params.len() == 14 && trial.attributes.len() == 7));
    (trials, result(&document))
}

fn depends_on_the_seed_alone(strategy: &str) {
    let at = scratch();
    let one = campaign(at.path(), strategy, 21, 1, "one");
    let two = campaign(at.path(), strategy, 21, 2, "two");
    assert_eq!(one, two, "{strategy}: one thread and two");

    let (other, _) = campaign(at.path(), strategy, 22, 2, "other");
    for (number, (a, b)) in one.0.iter().zip(&other).enumerate() {
        assert_ne!(a.end, b.end, "{strategy}: cost of trial {number} under another seed");
        // All begin with no compensation, whatever the seed: before a log the guard lets nothing else be tried.
        if number > 0 {
            assert_ne!(a.params, b.params, "{strategy}: parameters of trial {number} under another seed");
        }
    }
}

#[test]
fn random_search_depends_on_the_seed_alone() {
    depends_on_the_seed_alone("random");
}

#[test]
fn the_papers_search_depends_on_the_seed_alone() {
    depends_on_the_seed_alone("paper");
}

#[test]
fn grey_box_depends_on_the_seed_alone() {
    depends_on_the_seed_alone("grey_box");
}
