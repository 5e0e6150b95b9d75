//! `tribo reproduce uhlmann2023`.

use serde::{Deserialize, Serialize};
use tribo_experiments::reproduce::shipped;
use tribo_experiments::reproduce::uhlmann2023::{Uhlmann2023, VariantResult, VariantSummary, summarize};

use super::rerun::{RESULT_SCHEMA, deliver, expected, settings, with_progress};
use crate::arguments::{Common, Reproduce};
use crate::failure::{BadInput, CheckFailed};
use crate::output::{print, significant, table};

/// Difference of a share or a relative error of one model on one seed that `--check` accepts. One machine repeats all
/// bits; elsewhere the last ascent of a likelihood may stop a step earlier.
const TOLERANCE: f64 = 0.01;

/// What `--out` writes and `--check` reads.
#[derive(Debug, Serialize, Deserialize)]
struct Document {
    schema: String,
    tribo_version: String,
    rows: Vec<VariantSummary>,
    results: Vec<VariantResult>,
}

/// Runs every model on every seed and prints one row per model.
pub fn run(arguments: &Reproduce, common: &Common) -> anyhow::Result<()> {
    let expected = expected::<Document>(arguments)?;
    let config = settings(arguments, shipped::UHLMANN2023, Uhlmann2023::validate, |config| &mut config.seeds)?;
    let cells = config.seeds * config.variants.len() as u64;
    let results = with_progress(common, cells, "models", |bar| {
        Ok(config.run(|_| bar.inc(1)).map_err(|error| BadInput(error.to_string()))?)
    })?;

    let document = Document {
        schema: RESULT_SCHEMA.to_owned(),
        tribo_version: env!("CARGO_PKG_VERSION").to_owned(),
        rows: summarize(&results),
        results,
    };
    let text = serde_json::to_string_pretty(&document)? + "\n";
    deliver(&text, arguments, common, || show(&document.rows))?;
    expected.map_or(Ok(()), |expected| check(&document.results, &expected.results))
}

/// Compares model by model and seed by seed, so that fewer seeds can be checked too.
fn check(ours: &[VariantResult], expected: &[VariantResult]) -> anyhow::Result<()> {
    for got in ours {
        let name = format!("{} seed {}", got.variant.name(), got.seed);
        let same = |other: &&VariantResult| other.variant == got.variant && other.seed == got.seed;
        let Some(want) = expected.iter().find(same) else {
            return Err(CheckFailed(format!("{name} has no counterpart in the expected result")).into());
        };
        let pairs = [
            ("error of the free deflection", got.test_error, want.test_error),
            ("coverage on the test poses", got.test_coverage, want.test_coverage),
            ("force error", got.force_error, want.force_error),
            ("wrench error", got.wrench_error, want.wrench_error),
            ("share below 25 %", got.below_25, want.below_25),
            ("coverage of the wrench", got.wrench_coverage, want.wrench_coverage),
        ];
        for (what, got, want) in pairs {
            if (got - want).abs() > TOLERANCE {
                return Err(CheckFailed(format!("{name}: {what}: {got:.4}, expected {want:.4}")).into());
            }
        }
    }
    Ok(())
}

fn show(rows: &[VariantSummary]) {
    let mut rows_of_table = table(&[
        "model",
        "seeds",
        "error of free deflection",
        "in band, test",
        "in band, circle",
        "force error",
        "wrench error",
        "worst seed",
        "below 25 %",
        "wrench in band",
        "band N",
        "band Nm",
    ]);
    let percent = |x: f64| format!("{:.1} %", 100.0 * x);
    for row in rows {
        rows_of_table.add_row([
            row.variant.name().to_owned(),
            row.seeds.to_string(),
            percent(row.test_error),
            percent(row.test_coverage),
            percent(row.circle_coverage),
            percent(row.force_error),
            percent(row.wrench_error),
            percent(row.wrench_error_worst),
            percent(row.below_25),
            percent(row.wrench_coverage),
            significant(row.half_width[0], 3),
            significant(row.half_width[1], 3),
        ]);
    }
    print(rows_of_table);
    print("\nErrors are medians over the circle, relative to the wrench of the air spring; bands are those of 95 %.");
}
