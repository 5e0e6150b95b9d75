//! Hidden causes against diagnoses, seed by seed, and the table of what was confused.
//!
//! ```sh
//! cargo run --release -p tribo-experiments --example diagnosis_confusion -- --seeds 0..87 --kind all --out result.json
//! ```
#![allow(clippy::unwrap_used, clippy::panic, reason = "a command line without users to be kind to")]

use std::sync::Mutex;

use rayon::prelude::*;
use tribo_experiments::hidden_effects::{CaseFilter, Outcome, Strength, Tally, World, judged};

const USAGE: &str = "diagnosis_confusion --seeds A..B [--kind all|null|pair|triple|outside|CAUSE] [--strength weak|medium|strong|plain] \
                     [--world identified|wrong-everywhere] [--verbose] [--wrong-only] [--out FILE.json]";

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let flag = |name: &str| arguments.iter().any(|argument| argument == name);
    let value = |name: &str| {
        let at = arguments.iter().position(|argument| argument == name)?;
        arguments.get(at + 1).cloned()
    };
    let Some(seeds) = value("--seeds").and_then(|text| {
        let (a, b) = text.split_once("..").map(|(a, b)| (a.to_owned(), b.to_owned()))?;
        Some(a.parse::<u64>().ok()?..b.parse::<u64>().ok()?)
    }) else {
        panic!("{USAGE}");
    };
    let strength = value("--strength")
        .map(|name| Strength::ALL.into_iter().find(|strength| strength.name() == name).expect(USAGE));
    let filter = CaseFilter::named(&value("--kind").unwrap_or("all".to_owned()), strength).expect(USAGE);

    let world = match value("--world").as_deref() {
        None | Some("identified") => World::Identified,
        Some("wrong-everywhere") => World::WrongEverywhere,
        Some(_) => panic!("{USAGE}"),
    };

    let lock = Mutex::new(());
    let mut outcomes: Vec<Outcome> = seeds
        .into_par_iter()
        .filter_map(|seed| {
            let kind = filter.kind_of(seed);
            let outcome = judged(seed, kind, world);
            let _one_at_a_time = lock.lock().unwrap();
            match outcome {
                Ok(outcome) => {
                    let line = outcome.line();
                    if !flag("--wrong-only") || !line.starts_with("ok") {
                        println!("{line}");
                        if flag("--verbose") {
                            println!("               {}", outcome.description);
                            for finding in &outcome.diagnosis.findings {
                                println!("               {:?} p {:.3}", finding.effect, finding.p_value);
                            }
                            for note in &outcome.diagnosis.notes {
                                println!("               note: {note}");
                            }
                            let rejected = &outcome.diagnosis.rejected;
                            for out in rejected.iter().filter(|out| out.evidence.is_some_and(|evidence| evidence > 0.0))
                            {
                                println!("               rejected: {:?}", out);
                            }
                        }
                    }
                    Some(outcome)
                }
                Err(error) => {
                    println!("ERROR {seed:>6} {kind}: {error}");
                    None
                }
            }
        })
        .collect();
    outcomes.sort_by_key(|outcome| outcome.seed);
    let tally = Tally::of(&outcomes);
    println!("\n{tally}");
    if let Some(path) = value("--out") {
        std::fs::write(&path, serde_json::to_string_pretty(&tally).unwrap() + "\n").unwrap();
    }
}
