//! The report of a campaign: one HTML file for people without a window.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tribo_campaign::journal::Journal;
use tribo_campaign::strategy::BestTrial;
use tribo_campaign::{CampaignError, References, refresh_tuned};
use tribo_figure::Figure;
use tribo_figure::escape::{escape, escape_sentence};
use tribo_figure::number::{fixed, quantity_and_unit, significant};
use tribo_figure::page::{self, figures, section, table};
use tribo_files::write_atomic;
use tribo_model::FileError;

use super::{
    CampaignSnapshot, CampaignWatch, LoopTimes, Surrogate, TrialSnapshot, WatchedTrial, any_loop_times, arm_figures,
    campaign_figures, surrogate_figures, trial_figures,
};

/// Slices of the surrogate model in the report: the most relevant parameters.
const SLICES: usize = 4;
/// Name of the report in the directory of its campaign.
const REPORT: &str = "report.html";
/// What stands around the state of the campaign in its report.
const STATE_BEGINS: &str = "<meta name=\"tribo-campaign\" content=\"";
const STATE_ENDS: &str = "\">";
/// Part of a file in which that is looked for (bytes): it stands before the style sheet.
const HEAD_BYTES: u64 = 4096;

/// Writes `report.html` of the campaign in a directory, to `out` or beside its journal; finished or not. Without `loop_time`,
/// which is read from a clock, equal campaigns have equal reports, wherever they live.
pub fn write_report(directory: &Path, out: Option<&Path>, loop_time: bool) -> Result<PathBuf, CampaignError> {
    let mut watch = CampaignWatch::open(directory)?;
    if let Some(out) = out {
        check_replaceable(out)?;
    }
    let simulated = watch.tune().config().user_trials.is_none();
    if simulated && References::read(directory).is_none() {
        watch.set_references(watch.tune().references()?);
    }
    let campaign = {
        let idle = Journal::hold_if_idle(directory);
        let campaign = watch.poll()?.ok_or_else(|| FileError::Campaign {
            path: directory.to_owned(),
            message: "has no journal yet".to_owned(),
        })?;
        // Somebody who was killed may have left another one; a directory that cannot be written keeps what it has.
        if idle.is_some() && (directory.join("tuned.yaml").exists() || campaign.trials_by_user()) {
            let _ = refresh_tuned(directory, campaign.tuned().as_ref());
        }
        campaign
    };
    // Without enough trials, or with a kernel matrix beyond repair, the report does without the surrogate model.
    let surrogate = Surrogate::of(&campaign).ok().flatten();
    let best = match campaign.best() {
        Some(best) => {
            let without = campaign.uncompensated()?.map(Arc::new);
            Some(TrialSnapshot::read(directory, Arc::clone(&campaign.tune), best.clone(), without)?)
        }
        None => None,
    };
    let timed = best.as_ref().filter(|_| loop_time && simulated);
    let times = timed.map(|best| any_loop_times(&campaign.tune, &best.watched.trial.theta)).transpose()?;
    let page = campaign_page(&campaign, surrogate.as_ref(), best.as_ref(), times.as_ref());
    let path = out.map_or_else(|| directory.join(REPORT), Path::to_owned);
    write_atomic(&path, |file| file.write_all(page.as_bytes())).map_err(FileError::from)?;
    Ok(path)
}

/// Makes the report in the directory of a campaign true again, if there is one and trials have ended or were taken back since it was
/// written; a file that is no report of ours is left alone.
pub fn refresh_report(directory: &Path) -> Result<(), CampaignError> {
    let Some(told) = report_state(&directory.join(REPORT)) else { return Ok(()) };
    let campaign = CampaignWatch::open(directory)?.poll()?;
    if campaign.is_some_and(|campaign| state(&campaign) != told) {
        write_report(directory, None, false)?;
    }
    Ok(())
}

/// Refuses to replace a file that is no report.
fn check_replaceable(path: &Path) -> Result<(), FileError> {
    if !path.is_file() || report_state(path).is_some() {
        return Ok(());
    }
    let message = "is there and no report of a campaign; give another --out, or remove it".to_owned();
    Err(FileError::Campaign { path: path.to_owned(), message })
}

/// What a report tells of: its `<meta name="tribo-campaign">`; none of another file.
fn report_state(path: &Path) -> Option<String> {
    let mut head = Vec::new();
    File::open(path).ok()?.take(HEAD_BYTES).read_to_end(&mut head).ok()?;
    let head = String::from_utf8_lossy(&head);
    let (_, from) = head.split_once(STATE_BEGINS)?;
    Some(from.split_once(STATE_ENDS)?.0.to_owned())
}

/// The trials that a report tells of.
fn state(campaign: &CampaignSnapshot) -> String {
    let (ended, back, of) = (campaign.trials.len(), campaign.withdrawn.len(), campaign.tune.config().trials);
    let early = if campaign.early_stop.is_some() { ", ended early" } else { "" };
    format!("{ended} ended, {back} withdrawn, of {of}{early}, tribo {}", env!("CARGO_PKG_VERSION"))
}

/// The whole file, from what is known.
pub fn campaign_page(
    campaign: &CampaignSnapshot,
    surrogate: Option<&Surrogate>,
    best: Option<&TrialSnapshot>,
    times: Option<&LoopTimes>,
) -> String {
    let body = [
        head(campaign),
        result(campaign),
        failures(campaign),
        withdrawn(campaign),
        search(campaign, surrogate),
        best.map_or(String::new(), |best| best_trial(best, times)),
        all_trials(campaign),
    ];
    let page = page::page(&headline(campaign), &body.concat());
    page.replacen("<title>", &format!("{STATE_BEGINS}{}{STATE_ENDS}\n<title>", escape(&state(campaign))), 1)
}

/// What came of it, in one sentence.
pub fn headline(campaign: &CampaignSnapshot) -> String {
    let (done, total) = (campaign.trials.len(), campaign.total());
    let Some(best) = campaign.best_trial() else {
        return match done {
            0 => "No trial has finished yet.".to_owned(),
            _ => format!("All {done} trials so far have failed: none has a cost to compare."),
        };
    };
    let without = campaign.uncompensated_cost().map_or(String::new(), |uncompensated| {
        format!(", from {} without compensation", significant(uncompensated, 3))
    });
    let oracle = campaign.references.map_or(String::new(), |references| {
        format!("; with the true friction it would be {}", significant(references.oracle, 3))
    });
    let progress = if campaign.is_complete() { format!("of {done}") } else { format!("({done} of {total} done)") };
    format!("J = {} with the parameters of trial {} {progress}{without}{oracle}.", expected(&best), best.trial)
}

/// `2.98 ± 0.05`: J expected of another trial with the best parameters.
pub fn expected(best: &BestTrial) -> String {
    let cost = significant(best.cost, 3);
    best.sd.map_or(cost.clone(), |sd| format!("{cost} ± {}", significant(sd, 2)))
}

fn head(campaign: &CampaignSnapshot) -> String {
    let (class, state) = match campaign.is_complete() {
        true if campaign.early_stop.is_some() => ("nothing_missing", "ended early: nothing left to gain"),
        true => ("nothing_missing", "finished"),
        false => ("ambiguous", "not finished"),
    };
    let facts = campaign.facts().into_iter().map(|(what, value)| format!("{what}: {value}"));
    let mut facts: Vec<String> = facts.collect();
    facts.push(format!("tribo {}", campaign.tune.config().tribo_version));
    facts.push("joints and trials count from 0; wrenches are by the robot on the environment, base axes".to_owned());
    let torn = if campaign.torn {
        "<p class=\"meta\">The last line of the journal is incomplete and was left out: its writer is at work or was killed \
         (whoever goes on with the campaign repairs it).</p>\n"
    } else {
        ""
    };
    format!(
        "<header>\n<span class=\"badge {class}\">{state}</span>\n<h1>{}</h1>\n<p class=\"meta\">{}</p>\n{torn}</header>\n",
        escape_sentence(&headline(campaign)),
        escape(&facts.join(" · "))
    )
}

fn result(campaign: &CampaignSnapshot) -> String {
    let mut rows = Vec::new();
    let oracle = campaign.references.map(|references| references.oracle);
    let mut row = |what: String, cost: f64| {
        let ratio = oracle.map_or("–".to_owned(), |oracle| significant(cost / oracle, 3));
        rows.push([what, significant(cost, 4), ratio]);
    };
    if let Some(uncompensated) = campaign.uncompensated_cost() {
        row("none".to_owned(), uncompensated);
    }
    if let Some(best) = campaign.best_trial() {
        row(format!("tuned (trial {}), expected of another trial", best.trial), best.cost);
    }
    if let Some(references) = campaign.references {
        row("true friction".to_owned(), references.oracle);
        row("an arm without friction".to_owned(), references.frictionless);
    }
    let unit = format!("J [{}]", campaign.cost_name().unit());
    let mut body = table(&["compensation", &unit, "J / J with the true friction"], &[0], rows.into_iter());
    let failed = campaign.failed().next().is_some();
    let mut drawn = vec![campaign_figures::cost_per_trial(campaign), campaign_figures::cost_parts(campaign, false)];
    if failed {
        drawn.push(campaign_figures::cost_parts(campaign, true));
    }
    body += &figures(&drawn);
    if let Some(best) = campaign.best() {
        body +=
            &format!("<h3>Tuned parameters (trial {})</h3>\n{}", best.trial.number, parameter_table(campaign, best));
    }
    for sentence in campaign.remarks() {
        body += &format!("<p>{}</p>\n", escape_sentence(&sentence));
    }
    section("Result", &body)
}

fn parameter_table(campaign: &CampaignSnapshot, best: &WatchedTrial) -> String {
    let space = campaign.tune.space();
    let named = space.names_of_joint().map(|name| {
        let (quantity, unit) = quantity_and_unit(name);
        if unit.is_empty() { quantity } else { format!("{quantity} [{unit}]") }
    });
    let truth = campaign.tune.true_parameters();
    let named = named.flat_map(|name| std::iter::once(name).chain(truth.as_ref().map(|_| "true".to_owned())));
    let header: Vec<String> = std::iter::once("joint".to_owned()).chain(named).collect();
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let joints = best.trial.theta.chunks(space.parameters_per_joint()).enumerate();
    let rows = joints.map(|(joint, values)| {
        let cells = values.iter().enumerate().flat_map(|(k, value)| {
            let of_truth = truth.as_ref().map(|truth| significant(truth[joint * space.parameters_per_joint() + k], 4));
            std::iter::once(significant(*value, 4)).chain(of_truth)
        });
        std::iter::once(campaign.tune.joint_names().of(joint).to_string()).chain(cells).collect::<Vec<_>>()
    });
    table(&header, &[0], rows)
}

/// Trials that were taken back, and why.
fn withdrawn(campaign: &CampaignSnapshot) -> String {
    if campaign.withdrawn.is_empty() {
        return String::new();
    }
    let rows = campaign.withdrawn.iter().map(|(number, reason)| [number.to_string(), reason.clone()]);
    section(
        &format!("Withdrawn trials ({})", campaign.withdrawn.len()),
        &table(&["trial", "why it counts no more"], &[0, 1], rows),
    )
}

fn failures(campaign: &CampaignSnapshot) -> String {
    let failed: Vec<&WatchedTrial> = campaign.failed().collect();
    if failed.is_empty() {
        return String::new();
    }
    let rows = failed.iter().map(|watched| {
        let at = watched.aborted_at_s.map_or("–".to_owned(), |at_s| fixed(at_s, 2));
        [watched.trial.number.to_string(), watched.reason(), at, significant(watched.trial.cost.penalty, 3)]
    });
    let count = failed.len();
    section(
        &format!("Failed trials ({count})"),
        &table(&["trial", "limit violated", "at [s]", "penalty"], &[0, 1], rows),
    )
}

fn search(campaign: &CampaignSnapshot, surrogate: Option<&Surrogate>) -> String {
    let mut body = figures(&campaign_figures::parameters(campaign));
    if let Some(surrogate) = surrogate {
        let mut order: Vec<usize> = (0..surrogate.names.len()).collect();
        order.sort_by(|a, b| surrogate.lengthscales[*a].total_cmp(&surrogate.lengthscales[*b]));
        let mut drawn: Vec<Figure> = vec![surrogate_figures::relevance(surrogate, campaign)];
        for k in order.into_iter().take(SLICES) {
            drawn.extend(surrogate_figures::slice(surrogate, campaign, k));
            drawn.extend(surrogate_figures::acquisition(surrogate, campaign, k));
        }
        body += &format!(
            "<h3>What the trials say about the rest of the space</h3>\n<p class=\"hint\">Gaussian process on {} trials: {}. \
             Slices run through the incumbent, along the most relevant parameters.</p>\n{}",
            surrogate.trials,
            escape(surrogate.whose),
            figures(&drawn)
        );
    }
    section("Search", &body)
}

fn best_trial(best: &TrialSnapshot, times: Option<&LoopTimes>) -> String {
    let joints = 0..best.log.joints();
    let drawn = [
        ("Wrench", trial_figures::wrenches(best)),
        ("Tracking", trial_figures::tracked(best)),
        ("Arm", arm_figures::arm(best)),
        ("Torque by term", joints.clone().map(|joint| trial_figures::torque_terms(best, joint)).collect()),
        ("Friction against velocity", joints.map(|joint| trial_figures::friction(best, joint)).collect()),
    ];
    let part = |(heading, drawn): (&str, Vec<Figure>)| format!("<h3>{heading}</h3>\n{}", figures(&drawn));
    let mut body: String = drawn.into_iter().map(part).collect();
    if let Some(times) = times {
        let at = |p: f64| times.quantile(p).map_or("–".to_owned(), |us| significant(us, 3));
        body += &format!(
            "<h3>Loop time on this computer</h3>\n<p class=\"hint\">The loop of this trial once more, with a clock around each of \
             its {} ticks: median {} µs, 99.9 % {} µs, longest {} µs, of {} µs.</p>\n{}",
            times.tick_us.len(),
            at(0.5),
            at(0.999),
            at(1.0),
            significant(times.period_us, 3),
            figures([&trial_figures::loop_time(times)])
        );
    }
    section(&format!("Best trial ({})", best.watched.trial.number), &body)
}

fn all_trials(campaign: &CampaignSnapshot) -> String {
    let rows = campaign.trials.iter().map(|watched| {
        let (trial, parts) = (&watched.trial, watched.trial.cost.parts());
        let mut row = vec![trial.number.to_string(), significant(trial.cost.total(), 4)];
        row.extend(parts.iter().map(|part| significant(part.1, 3)));
        row.extend([trial.origin.to_string(), watched.state()]);
        row
    });
    let cost = campaign.cost_name();
    let total = format!("J [{}]", cost.unit());
    let header: Vec<&str> =
        ["trial", &total].into_iter().chain(cost.part_names()).chain(["chosen by", "state"]).collect();
    section("All trials", &table(&header, &[0, 7, 8], rows))
}
