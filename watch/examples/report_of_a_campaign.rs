//! A campaign run from code, watched as any other process would, and its report.
//!
//! `cargo run --release -p tribo-watch --example report_of_a_campaign -- [DIRECTORY]`
//!
//! With a directory: the report of the campaign that lies there. Without: a campaign of three trials in a temporary one.

use std::path::PathBuf;

use tribo_campaign::{Campaign, CampaignObserver, TuneConfig};
use tribo_watch::{CampaignWatch, headline, write_report};

/// Says nothing.
struct Quiet;

impl CampaignObserver for Quiet {}

/// Time stamps of the journal; a real clock goes here.
fn long_ago() -> String {
    "2000-01-01T00:00:00.000000+00:00".to_owned()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let directory = match std::env::args().nth(1) {
        Some(directory) => PathBuf::from(directory),
        None => {
            let directory = folder.path().join("campaign");
            let tune = TuneConfig { trials: 3, ..TuneConfig::default() }.validate::<7>()?;
            Campaign::create(&directory, tune, long_ago)?.run(&mut Quiet)?;
            directory
        }
    };
    let mut watch = CampaignWatch::open(&directory)?;
    let campaign = watch.poll()?.ok_or("a campaign has something to show")?;
    println!("{}", headline(&campaign));
    for trial in &campaign.trials {
        println!("trial {}: {}", trial.trial.number, trial.state());
    }
    let report = write_report(&directory, None, false)?;
    println!("report: {} bytes of HTML", std::fs::metadata(report)?.len());
    Ok(())
}
