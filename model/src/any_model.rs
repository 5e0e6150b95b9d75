//! A robot model, validated, of an arm with any number of joints that there are.

use std::path::Path;

use crate::{FileError, Model, ModelFile};

/// A model of an arm with as many joints as it happens to have.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "both are large, and few exist")]
pub enum AnyModel {
    /// Of an arm with six joints.
    Six(Model<6>),
    /// Of an arm with seven joints.
    Seven(Model<7>),
}

impl AnyModel {
    /// Reads and validates a model file.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let (file, document) = ModelFile::read(path)?;
        file.validate_any().map_err(|error| document.explain(error))
    }

    /// Width of the smooth sign on logs (rad/s).
    pub fn smoothing_rad_s(&self) -> f64 {
        match self {
            Self::Six(model) => model.smoothing_rad_s,
            Self::Seven(model) => model.smoothing_rad_s,
        }
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        match self {
            Self::Six(_) => 6,
            Self::Seven(_) => 7,
        }
    }

    /// Name of the arm.
    pub fn robot(&self) -> &str {
        match self {
            Self::Six(model) => &model.robot.arm.name,
            Self::Seven(model) => &model.robot.arm.name,
        }
    }
}
