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
use tribo_experiments::grey_box_ends::{Ended, grey_box_to_its_end};

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
        let ended =
            seeds.par_iter().map(|seed| grey_box_to_its_end(&truth, *seed)).collect::<Result<Vec<_>, String>>()?;
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
