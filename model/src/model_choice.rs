//! Which model logs are held against.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use tribo_logs::RobotLog;
use tribo_sim::TorqueSide;

use crate::ConfigError;
use crate::{AnyModel, FileError, ModelFile};

/// A model file, or a robot by name, URDF or MJCF, or neither: then the number of joints of the logs decides, seven being a
/// Panda's. A robot without a model file is bare, without friction.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ModelChoice {
    /// The model file.
    pub model: Option<PathBuf>,
    /// The robot, where there is no model file: a preset or the path of a URDF or MJCF.
    pub robot: Option<String>,
    /// Link at which the arm of such a file begins.
    pub base_link: Option<String>,
    /// Link whose frame is its flange.
    pub tip_link: Option<String>,
    /// Side of the gears on which the torques of such a robot are meant.
    pub torque_side: TorqueSide,
}

impl ModelChoice {
    /// The model file as it is and validated; `None` where none was given.
    ///
    /// # Errors
    /// A file that cannot be used.
    pub fn given(&self) -> Result<Option<(ModelFile, AnyModel)>, FileError> {
        let Some(path) = &self.model else { return Ok(None) };
        let (file, document) = ModelFile::read(path)?;
        let model = file.validate_any().map_err(|error| document.explain(error))?;
        Ok(Some((file, model)))
    }

    /// The bare robot for the log at `path` with so many joints; where all of `two_sided` have torque on both sides of the
    /// gears, rotors that weigh nothing.
    ///
    /// # Errors
    /// A robot that is not there, or none given for arms that have no default.
    pub fn bare(
        &self,
        path: &Path,
        joints: usize,
        two_sided: &[RobotLog],
    ) -> Result<(ModelFile, AnyModel), ConfigError> {
        let robot = match (&self.robot, joints) {
            (Some(robot), _) => robot.as_str(),
            (None, 7) => "panda",
            (None, joints) => return Err(FileError::NoRobot { path: path.to_owned(), joints }.into()),
        };
        let mut file = ModelFile::bare(robot, self.torque_side, two_sided);
        file.base_link.clone_from(&self.base_link);
        file.tip_link.clone_from(&self.tip_link);
        file.resolve(Path::new(""))?;
        let model = file.validate_any()?;
        Ok((file, model))
    }

    /// What the model is called in reports; `robot` is the name of its arm.
    pub fn name(&self, robot: &str) -> String {
        self.model
            .as_ref()
            .map_or_else(|| format!("the bare {robot} without friction"), |path| path.display().to_string())
    }
}
