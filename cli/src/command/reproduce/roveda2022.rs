//! `tribo reproduce roveda2022`.

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};
use tribo_experiments::files::YamlDocument;
use tribo_experiments::reproduce::{CellResult, Roveda2022, RowSummary, summarize};
use tribo_logs::write_atomic;

use crate::arguments::{Common, Reproduce};
use crate::failure::{BadInput, CheckFailed};
use crate::output::{print, significant, table};

use super::read_document;

/// The settings that ship with the experiment.
const ROVEDA2022: &str = include_str!("../../../../experiments/01_roveda2022/config.yaml");
/// Relative difference of a mean that `--check` accepts: the costs of this many campaigns repeat to 2–3 %.
const TOLERANCE: f64 = 0.05;

/// What `--out` writes and `--check` reads.
#[derive(Debug, Serialize, Deserialize)]
struct Document {
    schema: String,
    tribo_version: String,
    rows: Vec<RowSummary>,
    campaigns: Vec<CellResult>,
}

impl Document {
    /// JSON with one line per row and campaign, for diffs that people can read.
    fn text(&self) -> serde_json::Result<String> {
        fn lines<T: Serialize>(items: &[T]) -> serde_json::Result<String> {
            let lines: Vec<String> = items.iter().map(serde_json::to_string).collect::<Result<_, _>>()?;
            Ok(lines.join(",\n"))
        }
        Ok(format!(
            "{{\n\"schema\": \"{}\",\n\"tribo_version\": \"{}\",\n\"rows\": [\n{}\n],\n\"campaigns\": [\n{}\n]\n}}\n",
            self.schema,
            self.tribo_version,
            lines(&self.rows)?,
            lines(&self.campaigns)?
        ))
    }
}

/// Runs the campaigns of the experiment and prints one row per truth and strategy.
pub fn run(arguments: &Reproduce, common: &Common) -> anyhow::Result<()> {
    let expected = arguments.check.as_deref().map(read_document::<Document>).transpose()?;
    let mut config: Roveda2022 = match &arguments.config {
        Some(path) => {
            let document = YamlDocument::read(path)?;
            let config: Roveda2022 = document.parse()?;
            config.validate().map_err(|error| document.explain(error))?;
            config
        }
        None => YamlDocument::embedded("config.yaml", ROVEDA2022).parse()?,
    };
    config.seeds = arguments.seeds.unwrap_or(config.seeds);
    config.validate().map_err(|error| BadInput(error.to_string()))?;

    let bar = if common.quiet { ProgressBar::hidden() } else { ProgressBar::new(config.cells() as u64) };
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos}/{len} campaigns  {elapsed}  eta {eta}")?);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(common.threads).build().context("starting the threads")?;
    let cells = pool.install(|| config.run(|_| bar.inc(1)))?;
    bar.finish_and_clear();

    let rows = summarize(&cells);
    let document = Document {
        schema: "tribo.reproduce.result/1".to_owned(),
        tribo_version: env!("CARGO_PKG_VERSION").to_owned(),
        rows,
        campaigns: cells,
    };
    let text = document.text()?;
    if let Some(out) = &arguments.out {
        write_atomic(out, |file| file.write_all(text.as_bytes()))?;
    }
    if common.json {
        print(text.trim_end());
    } else if !common.quiet {
        show(&document.rows);
    }
    expected.map_or(Ok(()), |expected| check(&document, &expected))
}

/// Compares with the same campaigns of the expected result, so that fewer seeds can be checked too.
fn check(ours: &Document, expected: &Document) -> anyhow::Result<()> {
    let key = |cell: &CellResult| (cell.truth.clone(), cell.strategy, cell.seed, cell.pose);
    let keys: Vec<_> = ours.campaigns.iter().map(key).collect();
    let same: Vec<CellResult> = expected.campaigns.iter().filter(|cell| keys.contains(&key(cell))).cloned().collect();
    if same.len() != ours.campaigns.len() {
        let missing = ours.campaigns.len() - same.len();
        return Err(CheckFailed(format!("{missing} campaigns have no counterpart in the expected result")).into());
    }
    let references = summarize(&same);
    let pairs = ours.rows.iter().flat_map(|row| {
        let same_row = |other: &&RowSummary| other.truth == row.truth && other.strategy == row.strategy;
        references.iter().find(same_row).map(|reference| (row, reference))
    });
    for (row, reference) in pairs {
        let name = format!("{} {}", String::from(row.truth.clone()), serde_json::to_string(&row.strategy)?);
        let pairs = [
            ("second trial", row.second_mean, reference.second_mean),
            ("best", row.best_mean[2], reference.best_mean[2]),
        ];
        for (what, got, want) in pairs {
            if (got / want - 1.0).abs() > TOLERANCE {
                return Err(
                    CheckFailed(format!("{name}: mean J/J_oracle, {what}: {got:.3}, expected {want:.3}")).into()
                );
            }
        }
    }
    Ok(())
}

fn show(rows: &[RowSummary]) {
    let mut rows_of_table = table(&[
        "truth",
        "strategy",
        "campaigns",
        "J0",
        "2nd mean",
        "2nd worst",
        "best of 5",
        "best of 20",
        "best",
        "worst best",
        "trials to 1.1",
        "never",
        "penalties",
    ]);
    for row in rows {
        rows_of_table.add_row([
            String::from(row.truth.clone()),
            serde_json::to_string(&row.strategy).unwrap_or_default().trim_matches('"').to_owned(),
            row.campaigns.to_string(),
            significant(row.uncompensated_ratio, 3),
            significant(row.second_mean, 3),
            significant(row.second_worst, 3),
            significant(row.best_mean[0], 3),
            significant(row.best_mean[1], 3),
            significant(row.best_mean[2], 3),
            significant(row.best_worst, 3),
            row.trials_to_1_1.map_or("-".to_owned(), |trials| significant(trials, 3)),
            row.never.to_string(),
            significant(row.penalties, 2),
        ]);
    }
    print(rows_of_table);
    print("\nCosts are ratios to J_oracle, the mean cost with the true steady friction as compensator.");
}
