//! The files that every campaign begins with.

use std::path::Path;

use tribo_logs::write_atomic;

use crate::CampaignError;
use crate::config::ConfigError;
use crate::files::{FileError, YamlDocument, to_yaml};
use crate::journal::{Clock, Journal, JournalTrial};
use crate::leftovers::sweep;
use crate::{TuneConfig, ValidTune};

/// What is said of a directory without campaign.
const NO_CAMPAIGN: &str = "holds no campaign (no campaign.yaml)";

/// Writes the settings of a campaign into a directory that has none yet, and begins its journal.
pub(crate) fn create(directory: &Path, config: &TuneConfig, clock: Clock) -> Result<Journal, FileError> {
    let settings = directory.join("campaign.yaml");
    if settings.exists() || directory.join("journal.log").exists() {
        let message = "holds a campaign already; give another --out, or --resume to go on with it".to_owned();
        return Err(FileError::Campaign { path: directory.to_owned(), message });
    }
    std::fs::create_dir_all(directory.join("trials")).map_err(FileError::io(directory))?;
    write_settings(directory, config)?;
    let journal = Journal::create(&directory.join("journal.log"), clock)?;
    sweep(directory);
    Ok(journal)
}

/// Writes `campaign.yaml`.
pub(crate) fn write_settings(directory: &Path, config: &TuneConfig) -> Result<(), FileError> {
    let settings = directory.join("campaign.yaml");
    let text = to_yaml(config).map_err(FileError::io(&settings))?;
    Ok(write_atomic(&settings, |file| file.write_all(text.as_bytes()))?)
}

/// Whether the trials of a campaign are run by the caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RunBy {
    /// By Tribo, on the simulated arm.
    Tribo,
    /// By the user, on theirs.
    User,
}

/// Opens the campaign of a directory, which the caller then holds; `trials` overrides its number of trials.
pub(crate) fn open<const N: usize>(
    directory: &Path,
    trials: Option<usize>,
    run_by: RunBy,
    clock: Clock,
) -> Result<(ValidTune<N>, Journal, Vec<JournalTrial>), CampaignError> {
    let (mut config, document) = read_settings(directory, NO_CAMPAIGN)?;
    let wrong = match (run_by, &config.user_trials) {
        (RunBy::Tribo, Some(_)) => Some("its trials run elsewhere; go on with `tribo ask` and `tribo tell`"),
        (RunBy::User, None) => Some("its trials run on the simulated arm; go on with `tribo tune --resume`"),
        _ => None,
    };
    if let Some(message) = wrong {
        return Err(FileError::Campaign { path: directory.to_owned(), message: message.to_owned() }.into());
    }
    config.trials = trials.unwrap_or(config.trials);
    let tune = config.validate().map_err(|error| explained(error, &document))?;
    let path = directory.join("journal.log");
    // A campaign killed between its two first files has settings and no journal.
    let (journal, recorded) = match (path.exists(), run_by) {
        (false, _) => (Journal::create(&path, clock)?, Vec::new()),
        (true, RunBy::Tribo) => Journal::open(&path, clock)?,
        (true, RunBy::User) => Journal::open_when_free(&path, clock)?,
    };
    std::fs::create_dir_all(directory.join("trials")).map_err(FileError::io(directory))?;
    sweep(directory);
    Ok((tune, journal, recorded))
}

/// The settings of the campaign in a directory, with their text; `missing` is said where there are none.
pub(crate) fn read_settings(directory: &Path, missing: &str) -> Result<(TuneConfig, YamlDocument), FileError> {
    let settings = directory.join("campaign.yaml");
    if !settings.exists() {
        return Err(FileError::Campaign { path: directory.to_owned(), message: missing.to_owned() });
    }
    let document = YamlDocument::read(&settings)?;
    Ok((document.parse()?, document))
}

/// An error of settings with the file and line to blame.
pub(crate) fn explained(error: ConfigError, document: &YamlDocument) -> ConfigError {
    match error {
        ConfigError::Field(field) => ConfigError::File(document.explain(field)),
        other => other,
    }
}

impl TuneConfig {
    /// Number of joints of the robot of the campaign in a directory.
    ///
    /// # Errors
    /// No campaign, or one whose settings are damaged.
    pub fn joints_of_campaign(directory: &Path) -> Result<usize, CampaignError> {
        let (mut config, document) = read_settings(directory, NO_CAMPAIGN)?;
        Ok(config.load().map_err(|error| explained(error, &document))?)
    }
}
