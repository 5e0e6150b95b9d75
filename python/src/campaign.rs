//! Campaigns whose trials the user runs, as `tribo ask` and `tribo tell` run them.
//!
//! Nothing stays in memory between two calls: the journal in the campaign's directory holds everything, and the command and this module
//! may take turns.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use tribo_campaign::{AnyTune, CampaignError, RecognisedTrial, TuneConfig, UserCampaign, judge_log, recognise_trial};
use tribo_cli::now;
use tribo_diagnose::Diagnosable;
use tribo_logs::recognise::Use;
use tribo_regression::Nominal;
use tribo_watch::refresh_report;

use crate::failure::{bad, raised};
use crate::interrupt::interruptible;
use crate::log::PyLog;
use crate::remarks::accept;
use crate::tune::settings;

/// Runs the same block for a campaign of either number of joints.
macro_rules! opened {
    ($directory:expr, $campaign:ident => $body:expr) => {
        match TuneConfig::joints_of_campaign($directory).map_err(raised)? {
            6 => {
                let mut $campaign = open::<6>($directory)?;
                $body
            }
            _ => {
                let mut $campaign = open::<7>($directory)?;
                $body
            }
        }
    };
}

fn open<const N: usize>(directory: &Path) -> PyResult<UserCampaign<N>> {
    UserCampaign::open(directory, now).map_err(raised)
}

fn refreshed(directory: &Path) -> PyResult<()> {
    refresh_report(directory).map(drop).map_err(raised)
}

/// Hands out the next parameters, or those of a running trial once more; begins the campaign with the settings (JSON) where there is none. Gives the document of `tribo ask
/// --json` and the text of the compensator's file.
#[pyfunction]
#[pyo3(signature = (directory, given, anyway, trial))]
pub(crate) fn ask(
    py: Python<'_>,
    directory: PathBuf,
    given: &str,
    anyway: bool,
    trial: Option<usize>,
) -> PyResult<(String, String)> {
    if !directory.join("campaign.yaml").exists() {
        match begun(given)? {
            AnyTune::Six(tune) => UserCampaign::create(&directory, tune, now).map(drop).map_err(raised)?,
            AnyTune::Seven(tune) => UserCampaign::create(&directory, tune, now).map(drop).map_err(raised)?,
        }
    }
    let answer = opened!(&directory, campaign => {
        let asked = interruptible(py, |_| match trial {
            Some(number) => campaign.asked(number),
            None => campaign.ask(anyway),
        })?
        .map_err(|error| match error {
            CampaignError::NothingToGain { .. } => bad(format!("{error}; another trial all the same: ask(anyway=True)")),
            other => raised(other),
        })?;
        (campaign.ask_document(&asked).to_string(), tribo_model::to_yaml(&asked.file).map_err(raised)?)
    });
    refreshed(&directory)?;
    Ok(answer)
}

/// Settings of a campaign on one's own robot.
fn begun(given: &str) -> PyResult<AnyTune> {
    let mut config = TuneConfig::of_own_robot();
    let says_trials = settings(&mut config, given)?;
    if !says_trials {
        config.take_own_robot_trials();
    }
    config.user_trials.get_or_insert_default();
    config.validate_any().map_err(raised)
}

/// Records what came of a trial; gives the document of `tribo tell --json`.
#[pyfunction]
#[pyo3(signature = (directory, log, trial, failed))]
pub(crate) fn tell(
    py: Python<'_>,
    directory: PathBuf,
    log: Option<Bound<'_, PyLog>>,
    trial: Option<usize>,
    failed: Option<String>,
) -> PyResult<String> {
    let log = log.as_ref().map(|log| log.get());
    let document = opened!(&directory, campaign => told(py, &mut campaign, log, trial, failed.as_deref()))?;
    refreshed(&directory)?;
    Ok(document)
}

fn told<const N: usize>(
    py: Python<'_>,
    campaign: &mut UserCampaign<N>,
    log: Option<&PyLog>,
    trial: Option<usize>,
    failed: Option<&str>,
) -> PyResult<String>
where
    Nominal<N>: Diagnosable,
{
    let number = match (trial, campaign.running().as_slice()) {
        (Some(number), _) => number,
        (None, [number]) => *number,
        (None, []) => return Err(bad("no trial is running; ask for one first")),
        (None, several) => return Err(bad(format!("trials {several:?} are running; say which"))),
    };
    let Some(log) = log else {
        let reason = failed.ok_or_else(|| bad("no log, and no reason why the trial failed"))?;
        let told = interruptible(py, |_| campaign.tell_failed(number, reason))?.map_err(raised)?;
        return Ok(campaign.tell_document(&told, None, failed).map_err(raised)?.to_string());
    };
    let theta = campaign.asked(number).map_err(raised)?.theta;
    let (tune, user_trials) = (campaign.tune().clone(), *campaign.user_trials());
    let RecognisedTrial { log: cleaned, remarks } = recognise_trial(&tune, &user_trials, &log.log, failed.is_some());
    for remarks in &remarks {
        accept(py, &log.name, remarks, Use::Trial, false)?;
    }
    let judged = judge_log(&tune, &user_trials, &theta, &cleaned, failed.is_some())
        .map_err(|error| bad(format!("{}: {error}", log.name)))?;
    let told = interruptible(py, |_| campaign.tell(number, &judged, failed))?.map_err(raised)?;
    Ok(campaign.tell_document(&told, Some(&judged), failed).map_err(raised)?.to_string())
}

/// Takes a told trial back, with a reason.
#[pyfunction]
pub(crate) fn withdraw(directory: PathBuf, trial: usize, reason: &str) -> PyResult<String> {
    let document = opened!(&directory, campaign => {
        campaign.withdraw(trial, reason).map_err(raised)?;
        campaign.withdrawn_document(trial, reason).to_string()
    });
    refreshed(&directory)?;
    Ok(document)
}

/// Gives a running trial up, as if it had never been asked for.
#[pyfunction]
pub(crate) fn give_up(directory: PathBuf, trial: usize) -> PyResult<()> {
    opened!(&directory, campaign => campaign.give_up(trial).map_err(raised)?);
    refreshed(&directory)
}

/// Numbers of the finished trials and of the running ones, and how many the campaign is to have.
#[pyfunction]
pub(crate) fn campaign_state(directory: PathBuf) -> PyResult<(Vec<usize>, Vec<usize>, usize)> {
    let state = opened!(&directory, campaign => {
        let _: &mut _ = &mut campaign;
        let finished = campaign.finished().map(|trial| trial.number).collect();
        (finished, campaign.running(), campaign.tune().config.trials)
    });
    Ok(state)
}
