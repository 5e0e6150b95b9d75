//! The directory of a campaign: the one place that begins and opens it.
//!
//! ```text
//! campaign.yaml   the settings, written once; what they were is in the journal too, so that a change is found
//! journal.log     whoever holds its lock holds the campaign
//! trials/         the logs
//! ```
//!
//! To begin is to take the lock of an empty `journal.log` first; of several who begin at once one does, and the others change nothing.

use std::path::Path;

use serde_json::{Value, json};
use tribo_files::write_atomic;
use tribo_model::{ConfigError, FieldError, FileError, YamlDocument, to_yaml};

use crate::CampaignError;
use crate::config::TRIALS;
use crate::journal::{Clock, Journal, JournalTrial};
use crate::leftovers::{first_stranger, is_leftover, sweep};
use crate::recorded_settings::{check_unchanged, check_version};
use crate::{StopBelow, TuneConfig, ValidTune};

/// What is said of a directory without campaign.
const NO_CAMPAIGN: &str = "holds no campaign (no campaign.yaml)";
const SETTINGS: &str = "campaign.yaml";
const JOURNAL: &str = "journal.log";
const TRIAL_LOGS: &str = "trials";

/// Begins a campaign in a directory that is not there or empty: the lock, then the settings, then the journal. A directory in which
/// somebody was killed before all three were there is as good as empty, unless its settings are.
pub(crate) fn create(directory: &Path, config: &TuneConfig, run_by: RunBy, clock: Clock) -> Result<Journal, FileError> {
    check_free(directory)?;
    std::fs::create_dir_all(directory).map_err(FileError::io(directory))?;
    let mut journal = Journal::claim(&directory.join(JOURNAL), clock, run_by == RunBy::User)?;
    // Held: from here on nobody else begins one. Somebody may have been quicker.
    check_free(directory)?;
    std::fs::create_dir_all(directory.join(TRIAL_LOGS)).map_err(FileError::io(directory))?;
    let settings = directory.join(SETTINGS);
    let text = to_yaml(config).map_err(FileError::io(&settings))?;
    write_atomic(&settings, |file| file.write_all(text.as_bytes()))?;
    journal.begin(&json!(config))?;
    sweep(directory);
    Ok(journal)
}

/// Refuses a directory with a campaign, or with anything else that is somebody's.
fn check_free(directory: &Path) -> Result<(), FileError> {
    let refused = |message: String| Err(FileError::Campaign { path: directory.to_owned(), message });
    if directory.join(SETTINGS).exists() {
        return refused("holds a campaign already; give another --out, or --resume to go on with it".to_owned());
    }
    let begun = |name: &str, path: &Path| match name {
        JOURNAL => path.metadata().is_ok_and(|file| file.is_file() && file.len() == 0),
        TRIAL_LOGS => std::fs::read_dir(path).is_ok_and(|mut logs| logs.next().is_none()),
        name => is_leftover(name),
    };
    match first_stranger(directory, begun)? {
        Some(name) => refused(format!("is not empty ({name}) and holds no campaign; give a directory of its own")),
        None => Ok(()),
    }
}

/// Whether the trials of a campaign are run by the caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RunBy {
    /// By Tribo, on the simulated arm.
    Tribo,
    /// By the user, on theirs.
    User,
}

/// What may change of a campaign that goes on; none leaves it as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Changes {
    /// Its number of trials.
    pub trials: Option<usize>,
    /// When it ends before the last of them.
    pub stop_below: Option<StopBelow>,
}

/// Opens the campaign of a directory, which the caller then holds.
pub(crate) fn open<const N: usize>(
    directory: &Path,
    changes: Changes,
    run_by: RunBy,
    clock: Clock,
) -> Result<(ValidTune<N>, Journal, Vec<JournalTrial>), CampaignError> {
    let (config, document) = read_settings(directory, NO_CAMPAIGN)?;
    let refused = |message: &str| FileError::Campaign { path: directory.to_owned(), message: message.to_owned() };
    match (run_by, &config.user_trials) {
        (RunBy::Tribo, Some(_)) => {
            return Err(refused("its trials run elsewhere; go on with `tribo ask` and `tribo tell`").into());
        }
        (RunBy::User, None) => {
            return Err(refused("its trials run on the simulated arm; go on with `tribo tune --resume`").into());
        }
        _ => {}
    }
    let Changes { trials, stop_below } = changes;
    if let Some(trials) = trials {
        check_trials(trials)?;
    }
    let mut tune = config.validate().map_err(|error| explained(error, &document))?;
    let path = directory.join(JOURNAL);
    // A campaign that was killed in its first moment has settings and no journal; one that has logs has lost it.
    let lost = std::fs::read_dir(directory.join(TRIAL_LOGS)).is_ok_and(|mut logs| logs.next().is_some());
    let (mut journal, recorded) = match (path.exists(), run_by) {
        (false, _) if lost => return Err(refused("has trials and no journal.log: what they were is lost").into()),
        (false, _) => (Journal::create(&path, clock)?, Vec::new()),
        (true, RunBy::Tribo) => Journal::open(&path, clock)?,
        (true, RunBy::User) => Journal::open_when_free(&path, clock)?,
    };
    match &journal.study().settings {
        Some(began) => check_unchanged(began, &document, &path)?,
        None => journal.adopt_settings(&document.parse::<Value>()?)?,
    }
    if let Some(change) = journal.study().law_change {
        tune.change_law(change.law);
    }
    let known = journal.study().stop_below.or(tune.config.stop_below);
    tune.config.stop_below = stop_below.or(known);
    tune.config.check_stop_below().map_err(ConfigError::from)?;
    if let Some(changed) = tune.config.stop_below.filter(|stop| Some(*stop) != known) {
        journal.set_stop_below(changed)?;
    }
    let known = journal.study().trials.unwrap_or(tune.config.trials);
    tune.config.trials = trials.unwrap_or(known);
    if tune.config.trials != known {
        journal.set_trials(tune.config.trials)?;
    }
    std::fs::create_dir_all(directory.join(TRIAL_LOGS)).map_err(FileError::io(directory))?;
    sweep(directory);
    Ok((tune, journal, recorded))
}

/// Refuses a number of trials that no campaign has.
pub(crate) fn check_trials(trials: usize) -> Result<(), ConfigError> {
    if TRIALS.contains(&trials) {
        return Ok(());
    }
    Err(FieldError::new("trials", trials, format!("{} to {}", TRIALS.start(), TRIALS.end())).into())
}

/// The settings of the campaign in a directory, with their text; `missing` is said where there are none.
pub fn read_settings(directory: &Path, missing: &str) -> Result<(TuneConfig, YamlDocument), FileError> {
    let settings = directory.join(SETTINGS);
    if !settings.exists() {
        return Err(FileError::Campaign { path: directory.to_owned(), message: missing.to_owned() });
    }
    let document = YamlDocument::read(&settings)?;
    if document.parse::<Value>()?.is_null() {
        let error = FieldError::new("schema", "missing", "tribo.tune/1: the file is empty");
        return Err(document.explain(error));
    }
    let config: TuneConfig = document.parse()?;
    check_version(&config, &document)?;
    Ok((config, document))
}

/// An error of settings with the file and line to blame.
pub fn explained(error: ConfigError, document: &YamlDocument) -> ConfigError {
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
