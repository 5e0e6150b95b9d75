//! `tribo tune`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use serde_json::json;
use tribo_campaign::strategy::BestTrial;
use tribo_campaign::{
    AgainstEkf, AnyTune, Campaign, CampaignError, CampaignResult, Changes, ParameterSpace, TuneConfig, against_ekf,
};
use tribo_model::FileError;
use tribo_robot::JointNames;
use tribo_sim::not_simulated;
use tribo_trial::{CostName, EstimatorName};
use tribo_watch::write_report;

use super::{CAMPAIGNS, configured, expected, now, show_remarks, warn_not_cancelled};
use crate::arguments::{CampaignSettings, Common, Tune};
use crate::failure::{BadInput, CheckFailed, Stopped};
use crate::output::{print, print_json, significant, table};
use crate::progress::{TrialProgress, stop_on_signal};
use crate::threads;

/// Runs or resumes a campaign.
pub fn run(arguments: &Tune, common: &Common) -> anyhow::Result<()> {
    let started = Instant::now();
    // Before there is anything to go on with: a signal between the directory and the first trial must say how.
    stop_on_signal();
    if arguments.resume {
        let directory = resumed(arguments)?;
        let CampaignSettings { trials, stop_below, .. } = arguments.settings;
        let changes = Changes { trials, stop_below };
        return match TuneConfig::joints_of_campaign(&directory)? {
            6 => finish(Campaign::<6>::resume(&directory, changes, now)?, &directory, arguments, common, started),
            _ => finish(Campaign::<7>::resume(&directory, changes, now)?, &directory, arguments, common, started),
        };
    }
    let (directory, tune) = configured_campaign(arguments, common)?;
    match tune {
        AnyTune::Six(tune) => finish(Campaign::create(&directory, tune, now)?, &directory, arguments, common, started),
        AnyTune::Seven(tune) => {
            finish(Campaign::create(&directory, tune, now)?, &directory, arguments, common, started)
        }
    }
}

/// Runs what is left of a campaign and shows what came of it.
fn finish<const N: usize>(
    campaign: Campaign<N>,
    directory: &Path,
    arguments: &Tune,
    common: &Common,
    started: Instant,
) -> anyhow::Result<()> {
    let (total, finished) = (campaign.tune().config.trials, campaign.finished());
    if !common.quiet {
        message!("campaign {} ({} of {total} trials done)", directory.display(), finished);
    }
    let not_simulated = not_simulated(&campaign.tune().trial.truth.effects, &campaign.tune().trial.model.joint_names);
    if !common.quiet {
        for limit in &not_simulated {
            message!("tribo: {limit}");
        }
    }
    if let Some(model) = &campaign.tune().controller_model {
        warn_not_cancelled(&model.not_cancelled, &model.arm.joint_names, common);
    }
    let mut progress = TrialProgress::new(total, finished, common.quiet);
    let pool = threads::pool(common)?;
    let tune = campaign.tune().clone();
    // The window watches through the journal, from this thread, as windows must; closing it does not stop the campaign.
    let result = std::thread::scope(|scope| {
        let running = scope.spawn(|| {
            let result = pool.install(|| campaign.run(&mut progress));
            // The report does not wait for somebody to close the window.
            let report = result.is_ok().then(|| write_report(directory, None, false));
            (result, report)
        });
        let window = if arguments.dashboard { super::dashboard::watch(directory) } else { Ok(()) };
        (running.join(), window)
    });
    let (result, window) = result;
    let (result, report) = result.map_err(|_| anyhow::anyhow!("the campaign's thread panicked"))?;
    progress.finish();
    if let Err(error) = window {
        message!("tribo: {error}");
    }
    let result = match result {
        Err(CampaignError::Stopped { finished }) => {
            let go_on = format!(
                "stopped after {finished} of {total} trials; go on with: tribo tune --resume --out {}",
                directory.display()
            );
            // What was asked for with --check is not known: that is no success.
            if arguments.check.is_some() {
                return Err(Stopped(go_on).into());
            }
            message!("tribo: {go_on}");
            return Ok(());
        }
        other => other?,
    };
    if let Some(change) = &result.law_change
        && !common.quiet
    {
        message!("tribo: {change}; --friction coulomb_viscous keeps the law");
    }
    if let Some(stop) = &result.early_stop
        && !common.quiet
    {
        message!("tribo: nothing left to gain: {stop}");
    }
    if tune.config.residual != EstimatorName::Ekf && !common.quiet {
        message!("the same campaign with the EKF, for comparison");
    }
    let judged = pool.install(|| against_ekf(&tune, &result))?;
    let wall_s = started.elapsed().as_secs_f64();
    let report = report.context("the campaign ended without a report")??;
    if common.json {
        let mut document = result.to_json(judged, wall_s);
        if !not_simulated.is_empty() {
            document["not_simulated"] = json!(not_simulated);
        }
        print_json(&document);
    } else if !common.quiet {
        show(&result, &tune.trial.model.joint_names, judged.as_ref(), directory, &report, wall_s);
    }
    match arguments.check {
        Some(limit) => check(&result, limit),
        None => Ok(()),
    }
}

/// The settings of a new campaign, and its directory.
fn configured_campaign(arguments: &Tune, common: &Common) -> anyhow::Result<(PathBuf, AnyTune)> {
    let tune = configured(arguments.config.as_deref(), common, |config| arguments.settings.apply(config))?;
    Ok((new_directory(arguments)?, tune))
}

/// The directory of a new campaign.
pub(super) fn new_directory(arguments: &Tune) -> Result<PathBuf, FileError> {
    arguments.out.clone().map_or_else(next_campaign, Ok)
}

/// A numbered directory that nobody has, made: of several who begin at once each gets one of its own.
fn next_campaign() -> Result<PathBuf, FileError> {
    std::fs::create_dir_all(CAMPAIGNS).map_err(FileError::io(CAMPAIGNS))?;
    loop {
        let next = last_campaign().map_or(1, |(number, _)| number + 1);
        let directory = Path::new(CAMPAIGNS).join(format!("{next:04}"));
        match std::fs::create_dir(&directory) {
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            made => return made.map(|()| directory.clone()).map_err(FileError::io(directory)),
        }
    }
}

/// The directory of the campaign to go on with.
pub(super) fn resumed(arguments: &Tune) -> anyhow::Result<PathBuf> {
    // What is frozen within a campaign cannot be changed half-way.
    let settings = &arguments.settings;
    let frozen = [
        ("a settings file", arguments.config.is_some()),
        ("--robot", settings.scenario.robot.is_some()),
        ("--base-link", settings.scenario.ends.base_link.is_some()),
        ("--tip-link", settings.scenario.ends.tip_link.is_some()),
        ("--seed", settings.scenario.seed.is_some()),
        ("--friction", settings.friction.is_some()),
        ("--residual", settings.residual.is_some()),
        ("--cost", settings.cost.is_some()),
        ("--strategy", settings.strategy.is_some()),
        ("--init", settings.init.is_some()),
        ("--batch", settings.batch.is_some()),
        ("--truth", settings.scenario.truth.is_some()),
        ("--pose", settings.scenario.pose.is_some()),
        ("--velocity", settings.scenario.velocity.is_some()),
        ("--model", settings.scenario.model.is_some()),
        ("--bounds", settings.bounds.is_some()),
        ("--phases", settings.phases.is_some()),
    ];
    if let Some((name, _)) = frozen.iter().find(|(_, given)| *given) {
        let message = format!("{name} cannot be combined with --resume; a campaign keeps the settings it began with");
        return Err(BadInput(message).into());
    }
    if let Some(directory) = &arguments.out {
        return Ok(directory.clone());
    }
    let last = last_campaign().map(|(_, directory)| directory);
    Ok(last.ok_or_else(|| BadInput(format!("no campaign in {CAMPAIGNS}/ to resume; name one with --out")))?)
}

/// The numbered campaign directory with the highest number.
fn last_campaign() -> Option<(u32, PathBuf)> {
    let entries = std::fs::read_dir(CAMPAIGNS).ok()?;
    entries
        .flatten()
        .filter_map(|entry| Some((entry.file_name().to_str()?.parse::<u32>().ok()?, entry.path())))
        .max_by_key(|(number, _)| *number)
}

/// The tuned parameters joint by joint, each beside the true one where the simulated arm has such a parameter.
pub(super) fn show_parameters(space: &ParameterSpace, names: &JointNames, theta: &[f64], truth: Option<&[f64]>) {
    let mut header = vec!["joint"];
    for name in space.names_of_joint() {
        header.push(name);
        header.extend(truth.map(|_| "(true)"));
    }
    let mut parameters = table(&header);
    let per_joint = space.parameters_per_joint();
    for (joint, values) in theta.chunks(per_joint).enumerate() {
        let cells = values.iter().enumerate().flat_map(|(k, value)| {
            let of_truth = truth.map(|truth| significant(truth[joint * per_joint + k], 4));
            std::iter::once(significant(*value, 4)).chain(of_truth)
        });
        parameters.add_row(std::iter::once(names.of(joint).to_string()).chain(cells));
    }
    print(format_args!("\n{parameters}"));
}

fn check(result: &CampaignResult, limit: f64) -> anyhow::Result<()> {
    let ratio = result.conclusion.best.map_or(f64::INFINITY, |best| best.cost / result.references.oracle);
    if ratio <= limit {
        return Ok(());
    }
    Err(CheckFailed(format!("best J is {ratio:.3} of the oracle's; allowed: {limit}")).into())
}

fn show(
    result: &CampaignResult,
    names: &JointNames,
    judged: Option<&AgainstEkf>,
    directory: &Path,
    report: &Path,
    wall_s: f64,
) {
    let unit = format!("J [{}]", result.config.cost.unit());
    let peak = match result.config.cost {
        CostName::Paper => "max F+M",
        CostName::Robust => "99 % F+M/ℓ",
    };
    let mut trials = table(&["trial", &unit, "J/J_oracle", peak, "mean", "penalty", "chosen by", "state"]);
    let best = result.conclusion.best.map(|best| best.trial);
    for trial in &result.trials {
        let cost = trial.cost.total();
        let mark = if Some(trial.number) == best { " *" } else { "" };
        let state = trial.aborted.map_or("complete".to_owned(), |reason| format!("failed: {reason}"));
        trials.add_row([
            format!("{}{mark}", trial.number),
            significant(cost, 4),
            significant(cost / result.references.oracle, 3),
            significant(trial.cost.max.iter().sum(), 3),
            significant(trial.cost.mean.iter().sum(), 3),
            significant(trial.cost.penalty, 3),
            trial.origin.to_string(),
            state,
        ]);
    }
    print(trials);
    let references = &result.references;
    let mut summary = table(&["", &unit]);
    summary.add_row(["uncompensated".to_owned(), significant(references.uncompensated, 4)]);
    if let Some(best) = result.conclusion.best {
        summary.add_row([format!("tuned (trial {}), expected of another trial", best.trial), expected(&best)]);
    }
    summary.add_row(["oracle (true friction)".to_owned(), significant(references.oracle, 4)]);
    summary.add_row(["no friction at all".to_owned(), significant(references.frictionless, 4)]);
    print(format_args!("\n{summary}"));
    if let Some(best) = best {
        show_parameters(&result.space, names, &result.trials[best].theta, result.truth.as_deref());
    }
    let find_out = format!(
        "find out what: tribo simulate {} --trial 0 --log free_motion.csv   (yours comes from your robot)\n\
         \x20              tribo diagnose free_motion.csv   (several causes may fit so small a motion: it names the one that tells)",
        directory.join("campaign.yaml").display(),
    );
    show_remarks(&result.conclusion, names, &find_out);
    if let Some(judged) = judged {
        let name = result.config.residual.as_str();
        let verb = if judged.excess() > 0.0 { "costs" } else { "gains" };
        print(format_args!(
            "\njudged by the EKF: J = {} with the parameters {name} found, {} with those the EKF finds; the choice {verb} {:.1} %",
            significant(judged.cost, 4),
            significant(judged.cost_of_ekf_campaign, 4),
            100.0 * judged.excess().abs()
        ));
    }
    print(format_args!(
        "\n{} trials in {wall_s:.1} s; written {} and {}",
        result.trials.len(),
        directory.join("tuned.yaml").display(),
        report.display()
    ));
    if let Some(BestTrial { cost, .. }) = result.conclusion.best {
        print(format_args!(
            "next: tribo export {} --format c   (or rust, ros2, crisp, urdf, mjcf, yaml, json; J {:.1} -> {:.1})",
            directory.display(),
            references.uncompensated,
            cost
        ));
    }
}
