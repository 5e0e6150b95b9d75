//! `tribo convert`.

use std::path::Path;

use serde_json::json;
use tribo_logs::{RobotLog, read_log, write_csv, write_parquet};

use crate::arguments::{Common, Convert};
use crate::failure::BadInput;
use crate::output::{print, print_json};

/// Reads a log of any known format and writes it as canonical CSV or Parquet.
pub fn run(arguments: &Convert, common: &Common) -> anyhow::Result<()> {
    check_extension(&arguments.out)?;
    let (log, summary) = read_log(&arguments.log)?;
    write_log(&arguments.out, &log)?;
    if common.json {
        print_json(&json!({
            "schema": "tribo.convert/1",
            "format": summary.format.to_string(),
            "joints": summary.joints,
            "rows": summary.rows,
            "dropped_repeats": summary.dropped_repeats,
            "duration_s": summary.duration_s,
            "rate_hz": summary.rate_hz,
            "bursts": summary.bursts,
            "longest_gap_s": summary.longest_gap_s,
            "unknown_columns": summary.unknown_columns,
            "warnings": summary.warnings,
            "out": arguments.out,
        }));
    } else if !common.quiet {
        print(&summary);
        print(format_args!("written        {}", arguments.out.display()));
    }
    Ok(())
}

/// Refuses a file name from which no format follows, before any work is done.
pub fn check_extension(path: &Path) -> anyhow::Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    if [".csv", ".csv.gz", ".parquet"].iter().any(|ending| name.ends_with(ending)) {
        return Ok(());
    }
    Err(BadInput(format!("{}: unknown ending; allowed: .csv, .csv.gz, .parquet", path.display())).into())
}

/// Writes a log in the format of its ending.
pub fn write_log(path: &Path, log: &RobotLog) -> anyhow::Result<()> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("parquet")) {
        write_parquet(path, log)?;
    } else {
        write_csv(path, log)?;
    }
    Ok(())
}
