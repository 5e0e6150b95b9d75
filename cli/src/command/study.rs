//! `tribo study`.

use std::path::Path;

use serde_json::json;
use tribo_campaign::study::{Shard, Study, StudyRow, StudyStore, StudySummary, run_shard, study_page};
use tribo_diagnose::report::number::probability;
use tribo_files::write_atomic;
use tribo_model::FileError;

use crate::arguments::{Common, Study as Arguments};
use crate::failure::{BadInput, Stopped};
use crate::output::{print, print_json, significant, table};
use crate::progress::{CellProgress, stop_on_signal};
use crate::threads;

/// Computes what is left of a slice of a study; with the last cell of all slices there, writes and shows the comparison.
pub fn run(arguments: &Arguments, common: &Common) -> anyhow::Result<()> {
    let shard = shard(arguments)?;
    let study = Study::read(&arguments.study)?;
    let directory = arguments.out.clone().unwrap_or_else(|| arguments.study.with_extension(""));
    if directory == arguments.study {
        let message = format!("{}: say where the study goes with --out", directory.display());
        return Err(BadInput(message).into());
    }
    stop_on_signal();
    let store = StudyStore::open(&directory, &study)?;
    if !common.quiet {
        let (cells, all) = (shard.cells(&study).len(), study.cells().len());
        let done = all - left(&study, &store)?;
        message!("study {}: slice {shard} of {cells} cells; {done} of all {all} are done", directory.display());
    }
    let mut progress = CellProgress::new(common.quiet);
    let whole = threads::pool(common)?.install(|| run_shard(&study, &store, shard, &mut progress));
    progress.finish();
    if !whole? {
        return Err(Stopped("stopped; every finished cell is kept: start it again to go on".to_owned()).into());
    }
    match StudySummary::of(&study, &store)? {
        Some(summary) => deliver(&study, &summary, &directory, common),
        None => {
            let left = left(&study, &store)?;
            if common.json {
                print_json(&json!({"schema": "tribo.study.result/1", "cells_left": left}));
            } else if !common.quiet {
                print(format_args!("slice {shard} is complete; {left} cells of other slices are not"));
            }
            Ok(())
        }
    }
}

/// The slice asked for, or that of the job array.
fn shard(arguments: &Arguments) -> anyhow::Result<Shard> {
    let bad = |error: tribo_campaign::study::ShardError| BadInput(error.to_string());
    if let Some(text) = &arguments.shard {
        return Ok(text.parse().map_err(bad)?);
    }
    Ok(Shard::of_job_array(|name| std::env::var(name).ok()).map_err(bad)?.unwrap_or_default())
}

fn left(study: &Study, store: &StudyStore) -> Result<usize, FileError> {
    let mut left = 0;
    for cell in study.cells() {
        left += usize::from(store.read(study, &cell)?.is_none());
    }
    Ok(left)
}

fn deliver(study: &Study, summary: &StudySummary, directory: &Path, common: &Common) -> anyhow::Result<()> {
    let document = summary.to_json(study);
    write_atomic(directory.join("results.json"), |file| writeln!(file, "{document:#}"))?;
    write_atomic(directory.join("report.html"), |file| file.write_all(study_page(study, summary).as_bytes()))?;
    if common.json {
        print_json(&document);
    } else if !common.quiet {
        show(&summary.rows);
        print(format_args!(
            "J over that of the true friction; best: the parameters that are expected to cost least, run again on noise of their own;\n\
             over first: that J over the one of the first strategy on the same robot, motion and noise;\n\
             p: signed-rank test of those pairs, Bonferroni. Written {} and {}",
            directory.join("results.json").display(),
            directory.join("report.html").display()
        ));
    }
    Ok(())
}

fn show(rows: &[StudyRow]) {
    let mut shown = table(&[
        "truth",
        "estimator",
        "strategy",
        "trials",
        "campaigns",
        "J0",
        "2nd (worst)",
        "best (quartiles)",
        "worst",
        "within 1.1",
        "aborted",
        "over first",
        "p",
    ]);
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| significant(value, 3));
    for row in rows {
        let [q1, median, q3, worst] = row.best.map(number);
        let [second, second_worst] = row.second.map(number);
        shown.add_row([
            row.case.clone(),
            row.estimator.clone(),
            row.strategy.clone(),
            row.trials.to_string(),
            row.campaigns.to_string(),
            number(row.uncompensated),
            format!("{second} ({second_worst})"),
            format!("{median} ({q1} - {q3})"),
            worst,
            row.within_1_1.to_string(),
            significant(row.aborted, 2),
            number(row.over_first),
            row.p.map_or("-".to_owned(), probability),
        ]);
    }
    print(shown);
}
