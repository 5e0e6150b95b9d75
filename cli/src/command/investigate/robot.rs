//! A robot that makes motions when it is asked.

use std::path::Path;
use std::process::{Command, Stdio};

use tribo_campaign::TuneConfig;
use tribo_friction::FrictionModel;
use tribo_model::TrajectoryFile;
use tribo_sim::TorqueSide;

use super::settings::Settings;
use crate::arguments::Investigate;
use crate::command::convert::write_log;
use crate::command::live::{Link, confirm, of_seven_joints, preset_of, seen_from};
use crate::failure::BadInput;

/// A live Franka, or a command.
pub(super) enum Robot {
    /// Its connection and its preset.
    Live(Link, &'static str),
    /// With `{trajectory}` and `{log}` in it.
    Command(String),
}

impl Robot {
    /// The robot that was asked for; a live one has been spoken to.
    pub(super) fn of(arguments: &Investigate) -> anyhow::Result<Self> {
        if let Some(host) = &arguments.live {
            let how = "half a radian about its ready pose, then as the diagnosis advises";
            confirm(host, arguments.drive, how)?;
            let link = Link::to(host, arguments.drive);
            let preset = preset_of(link.connect()?.version());
            return Ok(Self::Live(link, preset));
        }
        let command = arguments.robot_command.clone().unwrap_or_default();
        for place in ["{trajectory}", "{log}"] {
            if !command.contains(place) {
                return Err(BadInput(format!("--robot-command has no {place}")).into());
            }
        }
        Ok(Self::Command(command))
    }

    /// The preset of a live robot.
    pub(super) fn preset(&self) -> Option<&'static str> {
        match self {
            Self::Live(_, preset) => Some(preset),
            Self::Command(_) => None,
        }
    }

    /// Makes a motion; the log appears whole or not at all. A live robot that is asked about its motors has `sensors` besides: the same motion
    /// with the torques that they measured.
    pub(super) fn make(
        &self,
        trajectory: &Path,
        log: &Path,
        sensors: &Path,
        settings: &Settings,
    ) -> anyhow::Result<()> {
        match self {
            Self::Live(link, preset) => {
                let config = TuneConfig {
                    robot: settings.model.is_none().then(|| (*preset).to_owned()),
                    model: settings.model.clone(),
                    ..TuneConfig::default()
                };
                let tune = of_seven_joints(config.validate_any()?)?;
                let motion = TrajectoryFile::read(trajectory, &tune.trial.model)?.path();
                let resume = "the same command goes on";
                let side = settings.side()?;
                let made = link.play(&tune.trial, &FrictionModel::none(), &motion, resume)?;
                if side == TorqueSide::Motor {
                    write_log(sensors, &seen_from(TorqueSide::Link, made.clone())?)?;
                }
                write_log(log, &seen_from(side, made)?)
            }
            Self::Command(command) => called(command, trajectory, log),
        }
    }
}

/// Runs a command that writes a log beside its place, where it then goes at once.
fn called(command: &str, trajectory: &Path, log: &Path) -> anyhow::Result<()> {
    let name = log.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let unfinished = log.with_file_name(format!("unfinished_{name}"));
    let line = command
        .replace("{trajectory}", &quoted(&trajectory.to_string_lossy()))
        .replace("{log}", &quoted(&unfinished.to_string_lossy()));
    let status = Command::new("sh").args(["-c", &line]).stdin(Stdio::null()).stdout(Stdio::null()).status()?;
    if !status.success() {
        return Err(BadInput(format!("the robot's command failed ({status}): {line}")).into());
    }
    if !unfinished.exists() {
        return Err(BadInput(format!("the robot's command has written no {}: {line}", unfinished.display())).into());
    }
    Ok(std::fs::rename(&unfinished, log)?)
}

/// A path as one word of the shell.
fn quoted(path: &str) -> String {
    format!("'{}'", path.replace('\'', r"'\''"))
}
