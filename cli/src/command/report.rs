//! `tribo report`.

use serde_json::json;
use tribo_watch::write_report;

use crate::arguments::{Common, Report};
use crate::failure::BadInput;
use crate::output::{print, print_json};

/// Writes the report of a campaign, finished or not.
pub fn run(arguments: &Report, common: &Common) -> anyhow::Result<()> {
    if arguments.campaign.is_file() {
        let log = arguments.campaign.display();
        let message = format!(
            "{log}: is a file, not the directory of a campaign; of a log, `tribo diagnose {log} --model MODEL.yaml --report REPORT.html` writes the report"
        );
        return Err(BadInput(message).into());
    }
    let path = write_report(&arguments.campaign, arguments.out.as_deref(), true)?;
    if common.json {
        print_json(&json!({"schema": "tribo.report/1", "written": path}));
    } else if !common.quiet {
        print(format_args!("written {}", path.display()));
    }
    Ok(())
}
