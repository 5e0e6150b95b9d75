//! `tribo ask`.

use std::path::Path;

use serde_json::json;
use tribo_campaign::{AnyTune, Asked, CampaignError, TuneConfig, UserCampaign, UserTrials, first_difference};
use tribo_export::{Exported, export};
use tribo_files::write_atomic;

use super::{configured, named, now, opened, set};
use crate::arguments::{Ask, CampaignSettings, Common};
use crate::failure::BadInput;
use crate::output::{print, print_json};
use crate::threads;

/// Hands out the next parameters of a campaign; begins the campaign where there is none.
pub fn run(arguments: &Ask, common: &Common) -> anyhow::Result<()> {
    let directory = &arguments.campaign;
    if !directory.join("campaign.yaml").exists() {
        if let Some(trial) = arguments.trial {
            let message = format!("{}: holds no campaign yet, let alone trial {trial}", directory.display());
            return Err(BadInput(message).into());
        }
        match begun(arguments, common)? {
            AnyTune::Six(tune) => match UserCampaign::create(directory, tune, now) {
                Ok(campaign) => return ask(campaign, arguments, common),
                Err(error) => begun_by_another(directory, error)?,
            },
            AnyTune::Seven(tune) => match UserCampaign::create(directory, tune, now) {
                Ok(campaign) => return ask(campaign, arguments, common),
                Err(error) => begun_by_another(directory, error)?,
            },
        }
    }
    match TuneConfig::joints_of_campaign(directory)? {
        6 => ask(reopened(opened::<6>(directory)?, arguments)?, arguments, common),
        _ => ask(reopened(opened::<7>(directory)?, arguments)?, arguments, common),
    }
}

/// A campaign that somebody else began in this very moment is gone on with, like any other.
fn begun_by_another(directory: &Path, error: CampaignError) -> Result<(), CampaignError> {
    if directory.join("campaign.yaml").exists() { Ok(()) } else { Err(error) }
}

/// Settings of a new campaign.
fn begun(arguments: &Ask, common: &Common) -> anyhow::Result<AnyTune> {
    on_own_robot(arguments.config.as_deref(), &arguments.settings, common, |config| {
        apply(arguments, config.user_trials.get_or_insert_default())
    })
}

/// Settings of a new campaign on a robot that is not simulated: its friction is not known, and its trials are few. `more` has the last word.
pub(super) fn on_own_robot(
    file: Option<&Path>,
    settings: &CampaignSettings,
    common: &Common,
    more: impl FnOnce(&mut TuneConfig) -> anyhow::Result<()>,
) -> anyhow::Result<AnyTune> {
    configured(file, common, |config| {
        if file.is_none() {
            *config = TuneConfig::of_own_robot();
        }
        settings.apply(config)?;
        if file.is_none() && settings.trials.is_none() {
            config.take_own_robot_trials();
        }
        more(config)
    })
}

fn apply(arguments: &Ask, trials: &mut UserTrials) -> anyhow::Result<()> {
    trials.judged_from_s = arguments.judged_from.unwrap_or(trials.judged_from_s);
    trials.judged_s = arguments.judged.unwrap_or(trials.judged_s);
    set(&mut trials.torque, arguments.torque.as_ref())
}

/// A campaign that goes on: flags may repeat its settings and change nothing but its number of trials.
fn reopened<const N: usize>(mut campaign: UserCampaign<N>, arguments: &Ask) -> anyhow::Result<UserCampaign<N>> {
    let settings = &campaign.tune().config;
    if arguments.config.is_some() {
        let message = "--config is for a new campaign; this one keeps the settings it began with";
        return Err(BadInput(format!("{}: {message}", arguments.campaign.display())).into());
    }
    let mut wanted = settings.clone();
    arguments.settings.apply(&mut wanted)?;
    apply(arguments, wanted.user_trials.get_or_insert_default())?;
    wanted.stop_below = settings.stop_below;
    // A campaign may have gone over to another law since.
    if campaign.law_change().is_some() {
        (wanted.friction, wanted.change_law) = (settings.friction, settings.change_law);
    }
    // What files hold is compared by their names: flags name files.
    (wanted.trials, wanted.robot_content, wanted.truth_content, wanted.model_content) = (
        settings.trials,
        settings.robot_content.clone(),
        settings.truth_content.clone(),
        settings.model_content.clone(),
    );
    if let Some(field) = first_difference(&json!(settings), &json!(wanted)) {
        let message = format!(
            "{}: `{field}` is another in this campaign, which keeps the settings it began with",
            arguments.campaign.display()
        );
        return Err(BadInput(message).into());
    }
    if let Some(trials) = arguments.settings.trials.filter(|trials| *trials != settings.trials) {
        campaign.set_trials(trials)?;
    }
    if let Some(stop_below) =
        arguments.settings.stop_below.filter(|stop| Some(*stop) != campaign.tune().config.stop_below)
    {
        campaign.set_stop_below(stop_below)?;
    }
    Ok(campaign)
}

/// A campaign that has nothing left to gain, with what to do next.
fn how_to_go_on(error: anyhow::Error, directory: &Path) -> anyhow::Error {
    if !matches!(error.downcast_ref(), Some(CampaignError::NothingToGain { .. })) {
        return error;
    }
    let shown = directory.display();
    BadInput(format!(
        "{error}\nthe result: tribo export {shown} --format c; another trial all the same: tribo ask {shown} --anyway"
    ))
    .into()
}

fn ask<const N: usize>(mut campaign: UserCampaign<N>, arguments: &Ask, common: &Common) -> anyhow::Result<()> {
    let directory = &arguments.campaign;
    let (out, format) = (arguments.out.as_deref(), named(&arguments.format)?);
    // With --json alone nobody reads a text.
    let is_read = out.is_some() || !common.json;
    let text_of = |asked: &Asked| Ok(is_read.then(|| export(&asked.file, format, None)).transpose()?);
    let (asked, exported): (Asked, Option<Exported>) = match arguments.trial {
        Some(number) => {
            let asked = campaign.asked(number)?;
            let exported = text_of(&asked)?;
            (asked, exported)
        }
        None => threads::pool(common)?
            .install(|| campaign.ask_as(arguments.anyway, text_of))
            .map_err(|error| how_to_go_on(error, directory))?,
    };
    if let (Some(out), Some(exported)) = (out, &exported) {
        write_atomic(out, |file| file.write_all(exported.text.as_bytes()))?;
    }
    match &exported {
        _ if common.json => print_json(&campaign.ask_document(&asked)),
        Some(exported) if out.is_none() => print(exported.text.trim_end()),
        _ => {}
    }
    if !common.quiet {
        for loss in exported.iter().flat_map(|exported| &exported.losses) {
            message!("tribo: not in the {} text: {loss}", arguments.format);
        }
        let directory = arguments.campaign.display();
        if let Some(change) = campaign.law_change().filter(|change| change.from_trial == asked.number) {
            message!("tribo: {change}");
        }
        for remark in campaign.remarks() {
            message!("tribo: {remark}");
        }
        let chosen = asked.origin;
        message!(
            "trial {} of {} (chosen by {chosen}); when it has run: tribo tell {directory} LOG --trial {}",
            asked.number,
            campaign.tune().config.trials,
            asked.number
        );
    }
    Ok(())
}
