//! One file per command.

pub mod ask;
mod believe;
pub mod bench;
mod columns;
pub mod convert;
pub mod dashboard;
mod dashboard_live;
pub mod diagnose;
pub mod estimate;
pub mod export;
pub mod investigate;
mod learnt;
pub mod listen;
mod live;
pub mod report;
pub mod reproduce;
mod robot_model;
pub mod serve;
pub mod shell;
pub mod simulate;
pub mod study;
pub mod tell;
mod transmission;
pub mod tune;
pub mod tune_live;

use std::path::Path;

use serde::de::DeserializeOwned;
use tribo_campaign::strategy::BestTrial;
use tribo_campaign::{AnyTune, CampaignError, Conclusion, TuneConfig, UserCampaign};
use tribo_files::LogError;
use tribo_logs::{LogSummary, ReadOptions, RobotLog, read_watched};
use tribo_model::{AnyModel, ConfigError, ModelFile, NotCancelled, YamlDocument};
use tribo_robot::JointNames;
use tribo_watch::refresh_report;

use crate::arguments::{CampaignSettings, Common, Scenario};
use crate::failure::{BadInput, Stopped};
use crate::output::{print, significant};
use crate::progress::StageProgress;

/// Where campaigns go when nobody says where.
const CAMPAIGNS: &str = "campaigns";

/// Opens a campaign whose trials the user runs; a report beside it is made true again where somebody was killed before it was.
fn opened<const N: usize>(directory: &Path) -> Result<UserCampaign<N>, CampaignError> {
    let campaign = UserCampaign::open(directory, now)?;
    refresh_report(directory)?;
    Ok(campaign)
}

/// The time, for the stamps in a journal.
pub fn now() -> String {
    // Optuna reads Python's isoformat, which wants +00:00 in place of Z.
    jiff::Timestamp::now().strftime("%Y-%m-%dT%H:%M:%S.%6f+00:00").to_string()
}

/// The value of an option whose spelling clap has checked.
fn named<T: DeserializeOwned>(name: &str) -> anyhow::Result<T> {
    Ok(serde_json::from_value(serde_json::Value::String(name.to_owned()))?)
}

/// Puts an option's value, if given, over a field.
fn set<T: DeserializeOwned>(field: &mut T, name: Option<&String>) -> anyhow::Result<()> {
    if let Some(name) = name {
        *field = named(name)?;
    }
    Ok(())
}

impl Scenario {
    /// Puts the flags that were given over the settings.
    fn apply(&self, config: &mut TuneConfig) -> anyhow::Result<()> {
        if self.robot.is_some() {
            config.robot.clone_from(&self.robot);
            config.base_link.clone_from(&self.ends.base_link);
            config.tip_link.clone_from(&self.ends.tip_link);
            config.robot_content = None;
        }
        if self.truth.is_some() {
            set(&mut config.truth, self.truth.as_ref())?;
            config.truth_content = None;
        }
        if self.unguarded {
            config.guard = None;
        }
        if self.model.is_some() {
            config.model.clone_from(&self.model);
            config.model_content = None;
        }
        set(&mut config.velocity, self.velocity.as_ref())?;
        config.seed = self.seed.unwrap_or(config.seed);
        config.pose = self.pose.map_or(config.pose, usize::from);
        Ok(())
    }
}

impl CampaignSettings {
    /// Puts the flags that were given over the settings.
    fn apply(&self, config: &mut TuneConfig) -> anyhow::Result<()> {
        set(&mut config.strategy, self.strategy.as_ref())?;
        set(&mut config.friction, self.friction.as_ref())?;
        if self.friction.is_some() {
            config.change_law = Some(false);
        }
        set(&mut config.bounds, self.bounds.as_ref())?;
        set(&mut config.residual, self.residual.as_ref())?;
        set(&mut config.cost, self.cost.as_ref())?;
        set(&mut config.phases, self.phases.as_ref())?;
        config.trials = self.trials.unwrap_or(config.trials);
        config.init = self.init.unwrap_or(config.init);
        config.batch = self.batch.unwrap_or(config.batch);
        config.stop_below = self.stop_below.or(config.stop_below);
        self.scenario.apply(config)
    }
}

/// Reads a log as `options` say; a bar shows how far, and goes when it is read. What the names of its columns were taken for is said.
fn read_log(path: &Path, options: &ReadOptions, common: &Common) -> anyhow::Result<(RobotLog, LogSummary)> {
    let (progress, name) = (StageProgress::new(common.quiet), path.display().to_string());
    let shown = progress.clone();
    let read = read_watched(path, options, move |part| shown.stage(&name, part));
    progress.finish();
    if let Ok((_, summary)) = &read {
        columns::show_proposal(path, summary, common.quiet);
    }
    read.map_err(|error| match error {
        LogError::Stopped { .. } => Stopped::empty_handed().into(),
        other => other.into(),
    })
}

/// Refuses a log of another robot than the model's.
fn check_joints(path: &Path, log: &RobotLog, model: &AnyModel) -> anyhow::Result<()> {
    if log.joints() == model.joints() {
        return Ok(());
    }
    let message = format!("{}: {} joints; the model has {}", path.display(), log.joints(), model.joints());
    Err(BadInput(message).into())
}

/// `2.93 ± 0.05`: J expected of the best trial when it is run again.
fn expected(best: &BestTrial) -> String {
    let cost = significant(best.cost, 4);
    best.sd.map_or(cost.clone(), |sd| format!("{cost} ± {}", significant(sd, 2)))
}

/// Says that joints stand, and that the friction law does not explain the robot, with the way to find out what else is at work.
fn show_remarks(conclusion: &Conclusion, names: &JointNames, find_out: &str) {
    for remark in conclusion.remarks(names) {
        print(format_args!("\n{remark}"));
    }
    if conclusion.law_check.is_some_and(|check| !check.passed()) {
        print(find_out);
    }
}

/// Says what a believed model holds that its controller cannot act on.
fn warn_not_cancelled(left: &[NotCancelled], names: &JointNames, common: &Common) {
    if !common.quiet {
        for effect in left {
            message!("tribo: {}", effect.sentence(names));
        }
    }
}

/// Says what was decided about a robot whose description leaves it open.
fn show_robot(file: &ModelFile, common: &Common) {
    if !common.quiet {
        for remark in file.remarks() {
            message!("tribo: {}: {remark}", file.robot);
        }
    }
}

/// Settings from a file (or the defaults), changed by `overrides`, validated; errors name the file where it is to blame.
fn configured(
    path: Option<&Path>,
    common: &Common,
    overrides: impl FnOnce(&mut TuneConfig) -> anyhow::Result<()>,
) -> anyhow::Result<AnyTune> {
    let document = path.map(YamlDocument::read).transpose()?;
    let mut config = document.as_ref().map(YamlDocument::parse::<TuneConfig>).transpose()?.unwrap_or_default();
    overrides(&mut config)?;
    let valid = config.validate_any().map_err(|error| match (error, &document) {
        (ConfigError::Field(field), Some(document)) if document.line_of(&field.field).is_some() => {
            ConfigError::File(document.explain(field))
        }
        (error, _) => error,
    })?;
    if let Some(robot) = &valid.config().robot_content {
        show_robot(robot, common);
    }
    Ok(valid)
}
