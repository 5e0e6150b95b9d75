//! The result of a campaign on disk.

use std::path::Path;

use serde::{Deserialize, Serialize};
use tribo_friction::{Compensator, FrictionModel, VelocitySource};

use crate::joints_of_preset;
use crate::{FieldError, FileError, FrictionSection, Model, ModelFile, YamlDocument};

/// Schema name of tuned parameters.
const SCHEMA: &str = "tribo.tuned/1";

/// `tuned.yaml`: the best compensator of a campaign and what it achieved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TunedFile {
    /// `tribo.tuned/1`.
    pub schema: String,
    /// Version of Tribo that wrote it.
    pub tribo_version: String,
    /// Name of the arm: of a preset, or the one that its URDF gives it.
    pub robot: String,
    /// Seed of the campaign.
    pub seed: u64,
    /// Trial the parameters come from.
    pub trial: usize,
    /// Expected J of a trial with these parameters [N + Nm, or N]; none of one that has been asked for and not been run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<f64>,
    /// Standard deviation of that expectation, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost_sd: Option<f64>,
    /// Cost J without compensation [N + Nm], where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncompensated_cost: Option<f64>,
    /// Velocity the compensator believes near zero.
    pub velocity: VelocitySource,
    /// Speed above which the hybrid source trusts the measurement [rad/s].
    pub hybrid_threshold_rad_s: f64,
    /// The compensator's friction law; `smoothing_rad_s` is the width of its smooth sign.
    pub friction: FrictionSection,
    /// The model of the controller: its arm, and its effects on top of the law; none is the preset's bare arm.
    /// An arm from a URDF is always here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<ModelFile>,
}

impl TunedFile {
    /// This compensator, of a trial of a campaign with this seed; nothing is said of its cost.
    pub fn of_trial<const N: usize>(
        robot: &str,
        (seed, trial): (u64, usize),
        compensator: &Compensator<N>,
        model: Option<ModelFile>,
    ) -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            tribo_version: env!("CARGO_PKG_VERSION").to_owned(),
            robot: robot.to_owned(),
            seed,
            trial,
            cost: None,
            cost_sd: None,
            uncompensated_cost: None,
            velocity: compensator.source,
            hybrid_threshold_rad_s: compensator.hybrid_threshold_rad_s,
            friction: FrictionSection::of(&compensator.friction, compensator.smoothing_rad_s),
            model,
        }
    }

    /// Reads and validates a file.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        Self::parse(&YamlDocument::read(path)?)
    }

    /// The tuned parameters in a document, validated.
    pub fn parse(document: &YamlDocument) -> Result<Self, FileError> {
        let tuned: Self = document.parse()?;
        match tuned.joints() {
            6 => tuned.check::<6>(),
            _ => tuned.check::<7>(),
        }
        .map_err(|error| document.explain(error))?;
        Ok(tuned)
    }

    /// Number of joints of the robot.
    pub fn joints(&self) -> usize {
        joints_of_preset(&self.robot).unwrap_or(self.friction.joints.len())
    }

    fn check<const N: usize>(&self) -> Result<(), FieldError> {
        self.compensator::<N>()?;
        self.controller_model::<N>()?;
        Ok(())
    }

    /// The model of the controller, if the file has one.
    pub fn controller_model<const N: usize>(&self) -> Result<Option<Model<N>>, FieldError> {
        let within = |error: FieldError| FieldError { field: format!("model.{}", error.field), ..error };
        self.model.as_ref().map(ModelFile::validate).transpose().map_err(within)
    }

    /// The compensator of the friction law alone; the model's effects are not in it.
    pub fn compensator<const N: usize>(&self) -> Result<Compensator<N>, FieldError> {
        if self.schema != SCHEMA {
            return Err(FieldError::new("schema", &self.schema, SCHEMA));
        }
        FieldError::check("hybrid_threshold_rad_s", self.hybrid_threshold_rad_s, 0.0, 10.0)?;
        let friction: FrictionModel<N> = self.friction.to_model("friction")?;
        Ok(Compensator {
            smoothing_rad_s: self.friction.smoothing_rad_s,
            hybrid_threshold_rad_s: self.hybrid_threshold_rad_s,
            ..Compensator::new(friction, self.velocity)
        })
    }
}
