//! The friction functions with trials that are aborted.

use tribo_bayesopt::{History, Outcome};

use super::friction::{TRUE14, TRUE35, WIDTH14, WIDTH35, fric14_aborted, fric35_aborted};
use super::random_source::RandomSource;

/// A function on the unit cube some of whose trials fail, and the trials that a search begins with; the least cost is 0, at a
/// point that does not fail.
#[derive(Clone, Copy)]
pub struct Crash {
    pub problem: &'static str,
    pub kind: &'static str,
    pub dimension: usize,
    /// From the ten given points of the protocol, or else by safe growth from zero compensation.
    pub given: bool,
    pub outcome: fn(&[f64]) -> Outcome,
}

pub const CRASHES: [Crash; 4] = [
    Crash { problem: "fric14", kind: "energy", dimension: 14, given: true, outcome: energy14 },
    Crash { problem: "fric35", kind: "energy", dimension: 35, given: true, outcome: energy35 },
    Crash { problem: "fric14", kind: "excess", dimension: 14, given: false, outcome: excess14 },
    Crash { problem: "fric35", kind: "excess", dimension: 35, given: false, outcome: excess35 },
];

impl Crash {
    /// The trials that seed s begins with.
    pub fn first_trials(&self, s: u64) -> History {
        let mut source = RandomSource::seed(1000 + s);
        let mut history = History::new();
        for _ in 0..if self.given { 10 } else { 0 } {
            let u = source.point(self.dimension);
            let outcome = (self.outcome)(&u);
            history.push(u, outcome);
        }
        history
    }
}

fn energy14(u: &[f64]) -> Outcome {
    outcome(fric14_aborted(u))
}

fn energy35(u: &[f64]) -> Outcome {
    outcome(fric35_aborted(u))
}

/// Cost, and ξ/T of a trial that was aborted.
fn outcome((value, part): (f64, Option<f64>)) -> Outcome {
    match part {
        None => Outcome::Value(value),
        Some(_) => Outcome::Failed { value: Some(value), part },
    }
}

fn excess14(u: &[f64]) -> Outcome {
    excess(u, TRUE14.as_flattened(), &WIDTH14, fric14_aborted(u).0)
}

fn excess35(u: &[f64]) -> Outcome {
    excess(u, TRUE35.as_flattened(), &WIDTH35, fric35_aborted(u).0)
}

/// Aborted at `ξ/T = bound/excess` where `excess = Σ max(0, u − u*) > bound = 0.12 √d`.
fn excess(u: &[f64], truth: &[f64], width: &[f64], cost: f64) -> Outcome {
    let bound = 0.12 * (u.len() as f64).sqrt();
    let excess: f64 = u.iter().enumerate().map(|(k, u)| (u - truth[k] / width[k % width.len()]).max(0.0)).sum();
    if excess <= bound {
        return Outcome::Value(cost);
    }
    let part = bound / excess;
    Outcome::Failed { value: Some(cost + 1000.0 * (-part).exp()), part: Some(part) }
}
