//! What an investigation is about; it stays the same from run to run.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use tribo_model::{AnyModel, Model, ModelChoice, ModelFile, YamlDocument, to_yaml};
use tribo_robot::Arm;
use tribo_sim::TorqueSide;

use super::super::diagnose::write_text;
use super::super::named;
use crate::arguments::Investigate;
use crate::failure::BadInput;

/// Settings on disk, `schema: tribo.investigation/1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Settings {
    schema: String,
    /// Model file that the robot is held against.
    pub(super) model: Option<PathBuf>,
    /// Preset, URDF or MJCF, where there is no model file.
    pub(super) robot: Option<String>,
    /// Ends of the arm in that file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) base_link: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) tip_link: Option<String>,
    /// Side of the gears of the measured torque, where there is no model file.
    pub(super) torque_side: String,
    /// Ending of the logs.
    pub(super) log_format: String,
    /// Seed of motions and diagnosis.
    pub(super) seed: u64,
}

/// Name of the file.
const FILE: &str = "investigation.yaml";

impl Settings {
    /// Settings of this call; a live robot has said what preset it is.
    pub(super) fn of(arguments: &Investigate, live: Option<&str>) -> Self {
        let given = arguments.of.robot.clone().or_else(|| live.map(str::to_owned));
        Self {
            schema: "tribo.investigation/1".to_owned(),
            robot: if arguments.of.model.is_some() { None } else { Some(given.unwrap_or_else(|| "panda".to_owned())) },
            base_link: arguments.of.ends.base_link.clone(),
            tip_link: arguments.of.ends.tip_link.clone(),
            model: arguments.of.model.clone(),
            torque_side: arguments.of.torque_side.clone(),
            log_format: if live.is_some() { "parquet".to_owned() } else { arguments.log_format.clone() },
            seed: arguments.seed,
        }
    }

    /// The arm as the model has it.
    pub(super) fn arm(&self) -> anyhow::Result<Arm<7>> {
        Ok(self.held_against()?.1.arm)
    }

    /// Side of the gears of the torque that the model is about.
    pub(super) fn side(&self) -> anyhow::Result<TorqueSide> {
        Ok(self.held_against()?.1.torque_side)
    }

    /// The model that sensors behind the gears are held against.
    pub(super) fn of_sensors(&self) -> anyhow::Result<ModelFile> {
        Ok(self.held_against()?.0.behind_gears())
    }

    fn held_against(&self) -> anyhow::Result<(ModelFile, Model<7>)> {
        let choice = ModelChoice {
            model: self.model.clone(),
            robot: self.robot.clone(),
            base_link: self.base_link.clone(),
            tip_link: self.tip_link.clone(),
            torque_side: named(&self.torque_side)?,
        };
        let (file, model) = match choice.given()? {
            Some(given) => given,
            None => choice.bare(Path::new(FILE), 7, &[])?,
        };
        match model {
            AnyModel::Seven(model) => Ok((file, model)),
            AnyModel::Six(_) => Err(BadInput("investigate moves arms of seven joints".to_owned()).into()),
        }
    }

    /// Writes the settings into a new directory; refuses one of another investigation.
    pub(super) fn agree_with(&self, directory: &Path) -> anyhow::Result<()> {
        let path = directory.join(FILE);
        if !path.exists() {
            return write_text(&path, &to_yaml(self)?);
        }
        let held: Self = YamlDocument::read(&path)?.parse()?;
        for (what, same) in [
            ("model", held.model == self.model),
            ("robot", held.robot == self.robot),
            ("base or tip", (&held.base_link, &held.tip_link) == (&self.base_link, &self.tip_link)),
            ("torque side", held.torque_side == self.torque_side),
            ("log format", held.log_format == self.log_format),
            ("seed", held.seed == self.seed),
        ] {
            if !same {
                return Err(differs(directory, what));
            }
        }
        Ok(())
    }
}

/// A directory of another investigation.
fn differs(directory: &Path, what: &str) -> anyhow::Error {
    let message = format!("{}: holds an investigation with another {what}; choose another --out", directory.display());
    BadInput(message).into()
}
