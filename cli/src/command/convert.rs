//! `tribo convert`.

use std::path::Path;

use serde_json::{Value, json};
use tribo_campaign::switched_off_without;
use tribo_files::LogError;
use tribo_logs::{ColumnNames, LogSummary, LogTarget, Mapping, RobotLog, convert_by};

use super::believe::remarks_json;
use super::columns::show_proposal;
use crate::arguments::{Common, Convert};
use crate::failure::{BadInput, Stopped};
use crate::output::{print, print_json};
use crate::progress::{StageProgress, stop_on_signal};

/// Reads a log of any known format, writes it as canonical CSV, Parquet or MCAP, and tells what is in it.
pub fn run(arguments: &Convert, common: &Common) -> anyhow::Result<()> {
    let target = match (target_of(&arguments.out)?, arguments.reader.as_str()) {
        (LogTarget::Csv(_), "plotjuggler") => LogTarget::Csv(ColumnNames::Tree),
        (target, _) => target,
    };
    stop_on_signal();
    let progress = StageProgress::new(common.quiet);
    let name = arguments.log.display().to_string();
    let shown = progress.clone();
    let options = arguments.columns.options(Vec::new())?;
    let summary = convert_by(&arguments.log, &arguments.out, target, &options, move |part| shown.stage(&name, part));
    progress.finish();
    let summary = summary.map_err(|error| match error {
        LogError::Stopped { .. } => Stopped::empty_handed().into(),
        other => anyhow::Error::from(other),
    })?;
    show_proposal(&arguments.log, &summary, common.quiet);
    if common.json {
        let mut document = document(&summary);
        document["out"] = json!(arguments.out);
        print_json(&document);
    } else if !common.quiet {
        print(&summary);
        for (column, effect) in switched_off(&summary) {
            print(format_args!("without      {column}: {effect}"));
        }
        print(format_args!("written      {}", arguments.out.display()));
    }
    Ok(())
}

/// The columns that are missing and used somewhere, with what is off without them.
fn switched_off(summary: &LogSummary) -> impl Iterator<Item = (String, &'static str)> {
    summary.missing.iter().filter_map(|&quantity| Some((quantity.to_string(), switched_off_without(quantity)?)))
}

fn document(summary: &LogSummary) -> Value {
    json!({
        "schema": "tribo.convert/1",
        "format": summary.format.to_string(),
        "source": summary.source,
        "read_as": summary.mapping.as_ref().map(Mapping::to_json),
        "joints": summary.joints,
        "rows": summary.rows,
        "dropped_repeats": summary.dropped_repeats,
        "dropped_incomplete": summary.dropped_incomplete,
        "duration_s": summary.duration_s,
        "rate_hz": summary.rate_hz,
        "bursts": summary.bursts,
        "longest_gap_s": summary.longest_gap_s,
        "unwrapped_jumps": summary.unwrapped_jumps,
        "columns": summary.present.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "missing": summary.missing.iter().map(|&quantity| {
            json!({"column": quantity.to_string(), "switches_off": switched_off_without(quantity)})
        }).collect::<Vec<_>>(),
        "unknown_columns": summary.unknown_columns,
        "warnings": summary.warnings,
        "remarks": remarks_json(&summary.remarks),
    })
}

/// The format that the ending of a file's name asks for; refused before any work is done where there is none.
pub fn target_of(path: &Path) -> anyhow::Result<LogTarget> {
    LogTarget::of_path(path).ok_or_else(|| {
        let allowed = LogTarget::ENDINGS.join(", ");
        BadInput(format!("{}: unknown ending; allowed: {allowed}", path.display())).into()
    })
}

/// Writes a log in the format of its ending.
pub fn write_log(path: &Path, log: &RobotLog) -> anyhow::Result<()> {
    Ok(tribo_logs::write_log(path, log, target_of(path)?)?)
}
