//! `tribo tell`.

use std::path::Path;

use serde_json::json;
use tribo_campaign::strategy::BestTrial;
use tribo_campaign::{JudgedLog, RecognisedTrial, Told, TuneConfig, UserCampaign, judge_log, recognise_trial};
use tribo_diagnose::Diagnosable;
use tribo_logs::RobotLog;
use tribo_logs::recognise::Use;
use tribo_regression::Nominal;
use tribo_trial::AbortReason;
use tribo_watch::refresh_report;

use super::believe::{Refused, believe};
use super::{expected, learnt, opened, read_log, show_remarks};
use crate::arguments::{Common, Tell};
use crate::failure::BadInput;
use crate::output::{print, print_json, significant, table};

/// Records what came of a trial.
pub fn run(arguments: &Tell, common: &Common) -> anyhow::Result<()> {
    let joints = TuneConfig::joints_of_campaign(&arguments.campaign)?;
    // Read before the campaign is held: a log may be a pipe, and others ask and tell while it is waited for.
    let log = match &arguments.log {
        Some(path) => {
            let (log, _) = read_log(path, &arguments.columns.options(Vec::new())?, common)?;
            Some((path.as_path(), log))
        }
        None => None,
    };
    match joints {
        6 => tell(opened::<6>(&arguments.campaign)?, log, arguments, common)?,
        _ => tell(opened::<7>(&arguments.campaign)?, log, arguments, common)?,
    }
    Ok(refresh_report(&arguments.campaign)?)
}

fn tell<const N: usize>(
    mut campaign: UserCampaign<N>,
    log: Option<(&Path, RobotLog)>,
    arguments: &Tell,
    common: &Common,
) -> anyhow::Result<()>
where
    Nominal<N>: Diagnosable,
{
    if let (Some(number), Some(reason)) = (arguments.withdraw, &arguments.reason) {
        campaign.withdraw(number, reason)?;
        show_withdrawn(&campaign, number, reason, common);
        return Ok(());
    }
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
    let judged =
        log.map(|(path, log)| judged_trial(&campaign, number, (path, &log), failed.is_some(), common)).transpose()?;
    let told = match (&judged, failed) {
        (Some(judged), failed) => campaign.tell(number, judged, failed)?,
        (None, reason) => campaign.tell_failed(number, reason.unwrap_or_default())?,
    };
    if common.json {
        print_json(&campaign.tell_document(&told, judged.as_ref(), failed)?);
    } else if !common.quiet {
        show(&campaign, &told, judged.as_ref());
        learnt::show(&campaign.learnt()?, &campaign.tune().trial.model.joint_names);
        what_next(&campaign, &told, arguments);
    }
    Ok(())
}

/// Says that a trial counts no more.
fn show_withdrawn<const N: usize>(campaign: &UserCampaign<N>, number: usize, reason: &str, common: &Common) {
    let (best, finished) = (campaign.best(), campaign.finished().count());
    if common.json {
        print_json(&campaign.withdrawn_document(number, reason));
    } else if !common.quiet {
        let total = campaign.tune().config.trials;
        print(format_args!("trial {number} withdrawn: {finished} of {total} count; {}", best_so_far(best)));
    }
}

/// `best: trial 3, expected J 2.93 ± 0.05`.
fn best_so_far(best: Option<BestTrial>) -> String {
    best.map_or("no trial has succeeded yet".to_owned(), |best| {
        format!("best: trial {}, expected J {}", best.trial, expected(&best))
    })
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
pub(super) fn judged_trial<const N: usize>(
    campaign: &UserCampaign<N>,
    number: usize,
    (path, log): (&Path, &RobotLog),
    failed: bool,
    common: &Common,
) -> anyhow::Result<JudgedLog<N>>
where
    Nominal<N>: Diagnosable,
{
    let theta = campaign.asked(number)?.theta;
    let RecognisedTrial { log, remarks } = recognise_trial(campaign.tune(), campaign.user_trials(), log, failed);
    for remarks in &remarks {
        believe(path, remarks, Use::Trial, Refused::IsAnError, common.quiet)?;
    }
    let judged = judge_log(campaign.tune(), campaign.user_trials(), &theta, &log, failed);
    Ok(judged.map_err(|error| BadInput(format!("{}: {error}", path.display())))?)
}

fn show<const N: usize>(campaign: &UserCampaign<N>, told: &Told, judged: Option<&JudgedLog<N>>) {
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
    let best = best_so_far(told.conclusion.best);
    let (number, total) = (told.trial.number, campaign.tune().config.trials);
    let failed = match told.trial.aborted {
        None => "",
        Some(AbortReason::Stopped) => " as stopped from outside, which does not count against its parameters",
        Some(_) => " as failed, which counts against its parameters",
    };
    print(format_args!("trial {number} told{failed}: {} of {total}; {best}", told.finished));
}

/// How to go on after the last trial.
fn what_next<const N: usize>(campaign: &UserCampaign<N>, told: &Told, arguments: &Tell) {
    let (directory, total) = (arguments.campaign.display(), campaign.tune().config.trials);
    let find_out = "find out what: tribo diagnose LOG, with a log of a motion that takes every joint both ways";
    show_remarks(&told.conclusion, &campaign.tune().trial.model.joint_names, find_out);
    if let Some(stop) = &told.early_stop {
        print(format_args!("nothing left to gain: {stop}"));
    }
    if told.finished >= total || told.early_stop.is_some() {
        print(format_args!("next: tribo export {directory} --format c, or tribo report {directory}"));
    }
}
