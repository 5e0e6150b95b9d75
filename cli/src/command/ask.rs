//! `tribo ask`.

use serde_json::{Value, json};
use tribo_experiments::files::{FileError, to_yaml};
use tribo_experiments::{AnyTune, Asked, TuneConfig, UserCampaign, UserTrials};
use tribo_logs::write_atomic;

use super::{configured, now, set};
use crate::arguments::{Ask, Common};
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
        return match begun(arguments)? {
            AnyTune::Six(tune) => ask(UserCampaign::create(directory, tune, now)?, arguments, common),
            AnyTune::Seven(tune) => ask(UserCampaign::create(directory, tune, now)?, arguments, common),
        };
    }
    match TuneConfig::joints_of_campaign(directory)? {
        6 => ask(reopened(UserCampaign::<6>::open(directory, now)?, arguments)?, arguments, common),
        _ => ask(reopened(UserCampaign::<7>::open(directory, now)?, arguments)?, arguments, common),
    }
}

/// Settings of a new campaign.
fn begun(arguments: &Ask) -> anyhow::Result<AnyTune> {
    configured(arguments.config.as_deref(), |config| {
        // Nobody knows the truth about a robot elsewhere, and nothing depends on it.
        if arguments.config.is_none() {
            config.truth = tribo_experiments::scenario::TruthName::Frictionless;
        }
        arguments.settings.apply(config)?;
        let trials = config.user_trials.get_or_insert_default();
        apply(arguments, trials)
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
    // What files hold is compared by their names: flags name files.
    (wanted.trials, wanted.robot_content, wanted.truth_content, wanted.model_content) = (
        settings.trials,
        settings.robot_content.clone(),
        settings.truth_content.clone(),
        settings.model_content.clone(),
    );
    if let Some(field) = difference(&json!(settings), &json!(wanted)) {
        let message = format!(
            "{}: `{field}` is another in this campaign, which keeps the settings it began with",
            arguments.campaign.display()
        );
        return Err(BadInput(message).into());
    }
    if let Some(trials) = arguments.settings.trials.filter(|trials| *trials != settings.trials) {
        campaign.set_trials(trials)?;
    }
    Ok(campaign)
}

/// The first field that differs.
fn difference(a: &Value, b: &Value) -> Option<String> {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            a.keys().chain(b.keys()).find_map(|key| match (a.get(key), b.get(key)) {
                (Some(a), Some(b)) => {
                    difference(a, b).map(|below| if below.is_empty() { key.clone() } else { format!("{key}.{below}") })
                }
                _ => Some(key.clone()),
            })
        }
        _ => (a != b).then(String::new),
    }
}

fn ask<const N: usize>(mut campaign: UserCampaign<N>, arguments: &Ask, common: &Common) -> anyhow::Result<()> {
    let asked = match arguments.trial {
        Some(number) => campaign.asked(number)?,
        None => threads::pool(common)?.install(|| campaign.ask())?,
    };
    let out = arguments.out.as_deref();
    let text = to_yaml(&asked.file).map_err(FileError::io(out.unwrap_or(&arguments.campaign)))?;
    if let Some(out) = out {
        write_atomic(out, |file| file.write_all(text.as_bytes()))?;
    }
    if common.json {
        print_json(&document(&campaign, &asked));
    } else if out.is_none() {
        print(text.trim_end());
    }
    if !common.quiet {
        let directory = arguments.campaign.display();
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

fn document<const N: usize>(campaign: &UserCampaign<N>, asked: &Asked) -> Value {
    json!({
        "schema": "tribo.ask/1",
        "trial": asked.number,
        "origin": asked.origin,
        "params": campaign.tune().space.nested(&asked.theta),
        "compensator": asked.file,
        "running": campaign.running(),
    })
}
