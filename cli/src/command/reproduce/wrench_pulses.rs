//! `tribo reproduce wrench_pulses`.

use tribo_experiments::reproduce::{PushRow, PushedTool, shipped};

use super::rerun::{Rows, deliver, expected, settings, with_progress};
use crate::arguments::{Common, Reproduce};
use crate::failure::{BadInput, CheckFailed};
use crate::output::{print, significant, table};

/// Relative difference of a figure that `--check` accepts: another platform's rounding moves a bisection by one step.
const TOLERANCE: f64 = 0.05;

/// Runs every estimator in every situation and prints one row for each.
pub fn run(arguments: &Reproduce, common: &Common) -> anyhow::Result<()> {
    let expected = expected::<Rows<PushRow>>(arguments)?;
    let config = settings(arguments, shipped::WRENCH_PULSES, PushedTool::validate, |config| &mut config.seeds)?;
    let rows = with_progress(common, config.trials() as u64, "trials", |bar| {
        Ok(config.run(|| bar.inc(1)).map_err(|error| BadInput(error.to_string()))?)
    })?;

    let document = Rows::new(config.seeds, rows);
    deliver(&document.text()?, arguments, common, || show(&document.rows))?;
    expected.map_or(Ok(()), |expected| check(&document, &expected))
}

fn check(ours: &Rows<PushRow>, expected: &Rows<PushRow>) -> anyhow::Result<()> {
    if ours.seeds != expected.seeds {
        let message = format!("the expected result is of {} seeds, this one of {}", expected.seeds, ours.seeds);
        return Err(CheckFailed(message).into());
    }
    for row in &ours.rows {
        let name = format!("{}, {}", situation(row), row.estimator.as_str());
        let same = |other: &&PushRow| other.case == row.case && other.estimator == row.estimator;
        let Some(want) = expected.rows.iter().find(same) else {
            return Err(CheckFailed(format!("{name} has no counterpart in the expected result")).into());
        };
        let pairs = [
            ("force", row.reading.rmse_force_n, want.reading.rmse_force_n),
            ("moment", row.reading.rmse_moment_nm, want.reading.rmse_moment_nm),
            ("force with prior", row.rarely_touched.rmse_force_n, want.rarely_touched.rmse_force_n),
            ("coverage", row.coverage95, want.coverage95),
            ("half-width", row.half_width_force_n, want.half_width_force_n),
        ];
        for (what, got, want) in pairs {
            let differs = (got / want - 1.0).abs();
            if differs.is_nan() || differs > TOLERANCE {
                return Err(CheckFailed(format!("{name}: {what}: {got:.4}, expected {want:.4}")).into());
            }
        }
    }
    Ok(())
}

fn situation(row: &PushRow) -> String {
    let friction = match (row.case.friction, row.case.compensated) {
        (false, _) => "no friction",
        (true, false) => "not compensated",
        (true, true) => "compensated",
    };
    let motion = if row.case.moving { "moving" } else { "fixed" };
    let payload =
        if row.case.payload_kg > 0.0 { format!(", {} kg unknown", row.case.payload_kg) } else { String::new() };
    format!("{friction}, {motion}{payload}")
}

fn show(rows: &[PushRow]) {
    let mut shown = table(&[
        "situation",
        "estimator",
        "RMSE [N]",
        "[Nm]",
        "untouched [N]",
        "[Nm]",
        "bias [N]",
        "[Nm]",
        "delay [ms]",
        "in 95 %",
        "worst axis",
        "± [N]",
        "± [Nm]",
        "noise ×",
        "prior: RMSE [N]",
        "[Nm]",
        "bias [N]",
        "[Nm]",
    ]);
    let mut last = String::new();
    for row in rows {
        let name = situation(row);
        let (read, likely) = (&row.reading, &row.rarely_touched);
        shown.add_row([
            if name == last { String::new() } else { name.clone() },
            row.estimator.as_str().to_owned(),
            significant(read.rmse_force_n, 3),
            significant(read.rmse_moment_nm, 3),
            significant(read.untouched_force_n, 2),
            significant(read.untouched_moment_nm, 2),
            significant(read.bias_force_n, 2),
            significant(read.bias_moment_nm, 2),
            significant(read.delay_ms, 2),
            format!("{:.1} %", 100.0 * row.coverage95),
            format!("{:.1} %", 100.0 * row.coverage95_worst),
            significant(row.half_width_force_n, 3),
            significant(row.half_width_moment_nm, 3),
            significant(row.noise_factor, 2),
            significant(likely.rmse_force_n, 3),
            significant(likely.rmse_moment_nm, 3),
            significant(likely.bias_force_n, 2),
            significant(likely.bias_moment_nm, 2),
        ]);
        last = name;
    }
    print(shown);
}
