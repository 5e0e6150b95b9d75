//! `tribo reproduce overcompensation`.

use tribo_experiments::reproduce::{OverCompensation, ScaleRow, shipped};

use super::rerun::{Rows, deliver, expected, settings, with_progress};
use crate::arguments::{Common, Reproduce};
use crate::failure::{BadInput, CheckFailed};
use crate::output::{print, significant, table};

/// Runs every situation at every scale and prints one row per situation.
pub fn run(arguments: &Reproduce, common: &Common) -> anyhow::Result<()> {
    let expected = expected::<Rows<ScaleRow>>(arguments)?;
    let config =
        settings(arguments, shipped::OVERCOMPENSATION, OverCompensation::validate, |config| &mut config.seeds)?;
    let rows = with_progress(common, config.trials() as u64, "trials", |bar| {
        Ok(config.run(|| bar.inc(1)).map_err(|error| BadInput(error.to_string()))?)
    })?;
    let document = Rows::new(config.seeds, rows);
    deliver(&document.text()?, arguments, common, || show(&document.rows))?;
    expected.map_or(Ok(()), |expected| check(&document, &expected))
}

/// Another platform's rounding may move a trip by a tick, hence not which situations trip, and what one would have seen.
fn check(ours: &Rows<ScaleRow>, expected: &Rows<ScaleRow>) -> anyhow::Result<()> {
    if ours.seeds != expected.seeds || ours.rows.len() != expected.rows.len() {
        let (got, want) = (ours.rows.len(), expected.rows.len());
        let message = format!(
            "the expected result has {} seeds and {want} rows, this one {} and {got}",
            expected.seeds, ours.seeds
        );
        return Err(CheckFailed(message).into());
    }
    for (row, want) in ours.rows.iter().zip(&expected.rows) {
        if (row.trips, row.visible) != (want.trips, want.visible) {
            let message = format!(
                "{} at {}: {} trips and {} visible, expected {} and {}",
                situation(row),
                row.scale,
                row.trips,
                row.visible,
                want.trips,
                want.visible
            );
            return Err(CheckFailed(message).into());
        }
    }
    Ok(())
}

fn situation(row: &ScaleRow) -> String {
    let (truth, velocity) =
        (String::from(row.truth.clone()).replace('_', "-"), format!("{:?}", row.velocity).to_lowercase());
    let motion = if row.moving { "moving" } else { "holding" };
    format!("{truth}, {velocity}, {motion}, Dn {}", row.nullspace_damping_per_s)
}

fn show(rows: &[ScaleRow]) {
    let head = ["situation", "trips from", "why", "seen from", "least lead [s]", "deviation [mm]", "elbow [rad]"];
    let mut shown = table(&head);
    for rows in rows.chunk_by(|a, b| situation(a) == situation(b)) {
        let first = rows.iter().find(|row| row.trips > 0);
        let seen = rows.iter().find(|row| row.visible > 0);
        let percent = |row: &ScaleRow| format!("{:.0} %", 100.0 * row.scale);
        let lead = rows.iter().filter_map(|row| row.lead_s).reduce(f64::min);
        let worst = |value: fn(&ScaleRow) -> [f64; 2], unit: f64| {
            let most = |k: usize| rows.iter().map(|row| value(row)[k]).fold(0.0, f64::max);
            format!("{} → {}", significant(unit * most(0), 2), significant(unit * most(1), 2))
        };
        shown.add_row([
            situation(&rows[0]),
            first.map_or_else(String::new, percent),
            first.and_then(|row| row.reason).map_or_else(String::new, |reason| reason.to_string()),
            seen.map_or_else(String::new, percent),
            lead.map_or_else(String::new, |lead| significant(lead, 2)),
            worst(|row| row.deviation_m, 1e3),
            worst(|row| row.elbow_rad, 1.0),
        ]);
    }
    print(shown);
}
