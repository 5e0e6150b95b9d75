//! `tribo tell`.

use std::path::Path;

use serde_json::{Map, Value, json};
use tribo_experiments::{AbortReason, JudgedLog, Told, TuneConfig, UserCampaign, judge_log, trial_remarks};
use tribo_logs::read_log;
use tribo_logs::recognise::{Fault, Use, recognise};

use super::believe::believe;
use super::now;
use crate::arguments::{Common, Tell};
use crate::failure::BadInput;
use crate::output::{print, print_json, significant, table};

/// Records what came of a trial.
pub fn run(arguments: &Tell, common: &Common) -> anyhow::Result<()> {
    match TuneConfig::joints_of_campaign(&arguments.campaign)? {
        6 => tell(UserCampaign::<6>::open(&arguments.campaign, now)?, arguments, common),
        _ => tell(UserCampaign::<7>::open(&arguments.campaign, now)?, arguments, common),
    }
}

fn tell<const N: usize>(mut campaign: UserCampaign<N>, arguments: &Tell, common: &Common) -> anyhow::Result<()> {
    let number = which(&campaign, arguments)?;
    if arguments.give_up {
        campaign.give_up(number)?;
        if common.json {
            print_json(&json!({"schema": "tribo.tell/1", "trial": number, "state": "given_up"}));
        } else if !common.quiet {
            print(format_args!("trial {number} given up"));
        }
        return Ok(());
    }
    let failed = arguments.failed.as_deref();
    let judged = match &arguments.log {
        Some(path) => Some(judged(&campaign, number, path, failed.is_some(), common)?),
        None => None,
    };
    let told = match (&judged, failed) {
        (Some(judged), failed) => campaign.tell(number, judged, failed)?,
        (None, reason) => campaign.tell_failed(number, reason.unwrap_or_default())?,
    };
    if common.json {
        print_json(&document(&campaign, &told, judged.as_ref(), failed));
    } else if !common.quiet {
        show(&campaign, &told, judged.as_ref(), arguments);
    }
    Ok(())
}

/// The trial that is meant.
fn which<const N: usize>(campaign: &UserCampaign<N>, arguments: &Tell) -> anyhow::Result<usize> {
    let running = campaign.running();
    let message = match (arguments.trial, running.as_slice()) {
        (Some(number), _) => return Ok(number),
        (None, [number]) => return Ok(*number),
        (None, []) => "no trial is running; ask for one first".to_owned(),
        (None, several) => format!("trials {several:?} are running; say which with --trial"),
    };
    Err(BadInput(format!("{}: {message}", arguments.campaign.display())).into())
}

/// What the log of a trial is worth.
fn judged<const N: usize>(
    campaign: &UserCampaign<N>,
    number: usize,
    path: &Path,
    failed: bool,
    common: &Common,
) -> anyhow::Result<JudgedLog<N>> {
    let theta = campaign.asked(number)?.theta;
    let (log, _) = read_log(path)?;
    // Somebody may have stopped a trial before the arm moved.
    let mut remarks = recognise(&log);
    remarks.retain(|remark| !failed || remark.fault != Fault::Standstill);
    believe(path, &remarks, Use::Trial, common.quiet)?;
    let remarks = trial_remarks(campaign.tune(), campaign.user_trials(), &log, failed);
    believe(path, &remarks, Use::Trial, common.quiet)?;
    let judged = judge_log(campaign.tune(), campaign.user_trials(), &theta, &log, failed);
    Ok(judged.map_err(|error| BadInput(format!("{}: {error}", path.display())))?)
}

fn document<const N: usize>(
    campaign: &UserCampaign<N>,
    told: &Told,
    judged: Option<&JudgedLog<N>>,
    failed: Option<&str>,
) -> Value {
    let cost = &told.trial.cost;
    json!({
        "schema": "tribo.tell/1",
        "trial": told.trial.number,
        "state": if failed.is_some() { "failed" } else { "complete" },
        "cost": cost.total(),
        "cost_parts": cost.parts().into_iter().map(|(k, v)| (k.to_owned(), json!(v))).collect::<Map<_, _>>(),
        "penalty": cost.penalty,
        "reason": failed,
        "aborted_at_s": told.aborted_at_s,
        "faults": judged.map(|judged| judged.faults),
        "logged_compensation": judged.map(|judged| judged.logged_compensation),
        "best": told.best.map(|(trial, cost)| json!({"trial": trial, "cost": cost})),
        "finished": told.finished,
        "trials": campaign.tune().config.trials,
        "running": campaign.running(),
    })
}

fn show<const N: usize>(campaign: &UserCampaign<N>, told: &Told, judged: Option<&JudgedLog<N>>, arguments: &Tell) {
    let cost = &told.trial.cost;
    let mut rows = table(&["part", &format!("cost [{}]", campaign.tune().config.cost.unit())]);
    for (name, value) in cost.parts() {
        rows.add_row([name.replace('_', " "), significant(value, 4)]);
    }
    rows.add_row(["J".to_owned(), significant(cost.total(), 4)]);
    print(rows);
    if let Some(judged) = judged {
        if judged.faults > 0 {
            message!("tribo: the estimator could not use {} of the judged samples", judged.faults);
        }
        if !judged.logged_compensation {
            message!("tribo: no tau_friction in the log; what the compensator added is worked out from dq");
        }
    }
    let best = told.best.map_or("no trial has succeeded yet".to_owned(), |(trial, cost)| {
        format!("best J {} in trial {trial}", significant(cost, 4))
    });
    let (number, total) = (told.trial.number, campaign.tune().config.trials);
    let failed = match told.trial.aborted {
        None => "",
        Some(AbortReason::Stopped) => " as stopped from outside, which does not count against its parameters",
        Some(_) => " as failed, which counts against its parameters",
    };
    print(format_args!("trial {number} told{failed}: {} of {total}; {best}", told.finished));
    let directory = arguments.campaign.display();
    if told.finished >= total {
        print(format_args!("next: tribo export {directory} --format c, or tribo report {directory}"));
    }
}
