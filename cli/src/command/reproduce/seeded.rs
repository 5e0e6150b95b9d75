//! Experiments that are a list of numbers per seed: `tribo reproduce simoni2017`, `simoni2019`.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tribo_experiments::reproduce::{QuantitySummary, SeedRun, SeededExperiment, summarize_quantities};

use super::rerun::{self, RESULT_SCHEMA, deliver, expected, json_lines, with_progress};
use crate::arguments::{Common, Reproduce};
use crate::failure::{BadInput, CheckFailed};
use crate::output::{print, significant, table};

/// Relative difference that `--check` accepts: one seed is the same bits on one platform, and another platform's exp and
/// sin may move a time of settling by a few samples.
const TOLERANCE: f64 = 0.02;
/// Difference below which numbers count as equal whatever their size.
const SMALLEST: f64 = 1e-3;

/// What `--out` writes and `--check` reads.
#[derive(Debug, Serialize, Deserialize)]
struct Document {
    schema: String,
    tribo_version: String,
    paper: String,
    quantities: Vec<QuantitySummary>,
    runs: Vec<SeedRun>,
}

impl Document {
    fn text(&self) -> serde_json::Result<String> {
        Ok(format!(
            "{{\n\"schema\": \"{}\",\n\"tribo_version\": \"{}\",\n\"paper\": \"{}\",\n\"quantities\": [\n{}\n],\n\"runs\": [\n{}\n]\n}}\n",
            self.schema,
            self.tribo_version,
            self.paper,
            json_lines(&self.quantities)?,
            json_lines(&self.runs)?
        ))
    }
}

/// Runs every seed and prints one row per quantity.
pub fn run<E: SeededExperiment>(
    paper: &str,
    settings: &str,
    arguments: &Reproduce,
    common: &Common,
) -> anyhow::Result<()> {
    let expected = expected::<Document>(arguments)?;
    let mut experiment: E = rerun::settings(arguments, settings, E::validate, E::seeds)?;
    let seeds = *experiment.seeds();
    let runs: Vec<SeedRun> = with_progress(common, seeds, "seeds", |bar| {
        let one = |seed: u64| {
            let run = experiment.measure(seed).map_err(|error| BadInput(format!("seed {seed}: {error}")));
            bar.inc(1);
            run
        };
        Ok((1..=seeds).into_par_iter().map(one).collect::<Result<_, _>>()?)
    })?;

    let document = Document {
        schema: RESULT_SCHEMA.to_owned(),
        tribo_version: env!("CARGO_PKG_VERSION").to_owned(),
        paper: paper.to_owned(),
        quantities: summarize_quantities(&experiment.quantities(), &runs),
        runs,
    };
    let text = document.text()?;
    deliver(&text, arguments, common, || show(&document.quantities))?;
    expected.map_or(Ok(()), |expected| check(&document, &expected))
}

/// Compares seed by seed, so that fewer seeds can be checked too.
fn check(ours: &Document, expected: &Document) -> anyhow::Result<()> {
    let names = |document: &Document| -> Vec<String> {
        document.quantities.iter().map(|summary| summary.quantity.name.clone()).collect()
    };
    if ours.paper != expected.paper || names(ours) != names(expected) {
        return Err(CheckFailed("the expected result is of another experiment".to_owned()).into());
    }
    for run in &ours.runs {
        let Some(reference) = expected.runs.iter().find(|reference| reference.seed == run.seed) else {
            return Err(CheckFailed(format!("seed {} has no counterpart in the expected result", run.seed)).into());
        };
        for ((got, want), name) in run.values.iter().zip(&reference.values).zip(names(ours)) {
            if (got - want).abs() > (TOLERANCE * want.abs()).max(SMALLEST) {
                let message = format!("seed {}: {name}: {got}, expected {want}", run.seed);
                return Err(CheckFailed(message).into());
            }
        }
    }
    Ok(())
}

fn show(quantities: &[QuantitySummary]) {
    let mut rows = table(&["quantity", "unit", "paper", "mean", "sd", "least", "largest"]);
    for summary in quantities {
        rows.add_row([
            summary.quantity.name.clone(),
            summary.quantity.unit.clone(),
            summary.quantity.paper.map_or("-".to_owned(), |paper| significant(paper, 4)),
            significant(summary.mean, 4),
            significant(summary.sd, 2),
            significant(summary.min, 4),
            significant(summary.max, 4),
        ]);
    }
    print(rows);
}
