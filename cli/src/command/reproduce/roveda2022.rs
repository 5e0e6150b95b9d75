//! `tribo reproduce roveda2022`.

use serde::{Deserialize, Serialize};
use tribo_experiments::reproduce::{CellResult, Roveda2022, RowSummary, shipped, summarize};

use super::rerun::{RESULT_SCHEMA, deliver, expected, json_lines, settings, with_progress};
use crate::arguments::{Common, Reproduce};
use crate::failure::CheckFailed;
use crate::output::{print, significant, table};

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
        Ok(format!(
            "{{\n\"schema\": \"{}\",\n\"tribo_version\": \"{}\",\n\"rows\": [\n{}\n],\n\"campaigns\": [\n{}\n]\n}}\n",
            self.schema,
            self.tribo_version,
            json_lines(&self.rows)?,
            json_lines(&self.campaigns)?
        ))
    }
}

/// Runs the campaigns of the experiment and prints one row per truth and strategy.
pub fn run(arguments: &Reproduce, common: &Common) -> anyhow::Result<()> {
    let expected = expected::<Document>(arguments)?;
    let config = settings(arguments, shipped::ROVEDA2022, Roveda2022::validate, |config| &mut config.seeds)?;
    let cells = with_progress(common, config.cells() as u64, "campaigns", |bar| Ok(config.run(|_| bar.inc(1))?))?;

    let rows = summarize(&cells);
    let document = Document {
        schema: RESULT_SCHEMA.to_owned(),
        tribo_version: env!("CARGO_PKG_VERSION").to_owned(),
        rows,
        campaigns: cells,
    };
    let text = document.text()?;
    deliver(&text, arguments, common, || show(&document.rows))?;
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
