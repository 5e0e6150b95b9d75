//! Poses, truths and model errors a campaign can be run on.

use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, SVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use tribo_robot::{Payload, presets};
use tribo_sim::{Sensors, Truth};

use crate::files::{FieldError, Model, ModelFile, YamlDocument};
use crate::{Believed, ConfigError};

/// The three configurations about which the tool moves (rad): the ready pose and two others of the workspace.
pub fn pose(index: usize) -> Option<SVector<f64, 7>> {
    match index {
        0 => Some(presets::panda_ready_pose()),
        1 => Some(SVector::from([0.4, -0.3, 0.2, -2.0, 0.3, 1.9, 0.5])),
        2 => Some(SVector::from([-0.5, 0.1, -0.3, -1.8, -0.2, 1.8, 1.0])),
        _ => None,
    }
}

/// Number of poses.
pub const POSES: usize = 3;

/// What the simulated arm is like.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", from = "String", into = "String")]
pub enum TruthName {
    /// Coulomb and viscous friction.
    CoulombViscous,
    /// Stribeck friction.
    Stribeck,
    /// Bristle friction.
    Lugre,
    /// The sigmoid of Gaz et al. 2019.
    Gaz,
    /// Coulomb and viscous friction that fades with operating time.
    Thermal,
    /// No friction.
    Frictionless,
    /// A model file.
    File(PathBuf),
}

impl From<String> for TruthName {
    fn from(name: String) -> Self {
        match name.as_str() {
            "coulomb_viscous" => Self::CoulombViscous,
            "stribeck" => Self::Stribeck,
            "lugre" => Self::Lugre,
            "gaz" => Self::Gaz,
            "thermal" => Self::Thermal,
            "frictionless" => Self::Frictionless,
            _ => Self::File(PathBuf::from(name)),
        }
    }
}

impl From<TruthName> for String {
    fn from(name: TruthName) -> Self {
        match name {
            TruthName::CoulombViscous => "coulomb_viscous".to_owned(),
            TruthName::Stribeck => "stribeck".to_owned(),
            TruthName::Lugre => "lugre".to_owned(),
            TruthName::Gaz => "gaz".to_owned(),
            TruthName::Thermal => "thermal".to_owned(),
            TruthName::Frictionless => "frictionless".to_owned(),
            TruthName::File(path) => path.display().to_string(),
        }
    }
}

/// A truth, and the model of it that leaves nothing to wish for.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedTruth {
    /// What the plant obeys.
    pub truth: Truth<7>,
    /// What an oracle knows of it.
    pub oracle: Believed,
}

impl TruthName {
    /// The truth. A file is read, unless its `content` is given already, validated, and left in `content`.
    pub fn load(&self, content: &mut Option<ModelFile>) -> Result<LoadedTruth, ConfigError> {
        let truth = match self {
            Self::CoulombViscous => Truth::panda_coulomb_viscous(),
            Self::Stribeck => Truth::panda_stribeck(),
            Self::Lugre => Truth::panda_lugre(),
            Self::Gaz => Truth::panda_gaz(),
            Self::Thermal => Truth::panda_thermal(),
            Self::Frictionless => Truth::panda_frictionless(),
            Self::File(path) => {
                let model = frozen_model(path, content, "truth_content")?;
                return Ok(LoadedTruth { truth: model.to_truth(), oracle: Believed::by_controller(&model) });
            }
        };
        *content = None;
        let oracle = Believed::of(truth.clone());
        Ok(LoadedTruth { truth, oracle })
    }
}

/// The model of a file. What `content` holds goes before what the disk holds: a campaign keeps the file it began with.
pub fn frozen_model(path: &Path, content: &mut Option<ModelFile>, field: &str) -> Result<Model<7>, ConfigError> {
    if let Some(file) = content {
        let within = |error: FieldError| FieldError { field: format!("{field}.{}", error.field), ..error };
        return Ok(file.validate().map_err(within)?);
    }
    let document = YamlDocument::read(path)?;
    let file: ModelFile = document.parse()?;
    let model = file.validate().map_err(|error| document.explain(error))?;
    *content = Some(file);
    Ok(model)
}

/// What the controller's model gets wrong, and how noisy the sensors are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ModelError {
    /// Mass at the flange that the controller does not know (kg).
    pub payload_kg: f64,
    /// Standard deviation of the relative error of every link's mass and inertia [-], drawn from the seed.
    pub link_mass_error: f64,
    /// Scale of every sensor noise [-].
    pub noise_factor: f64,
}

impl Default for ModelError {
    fn default() -> Self {
        Self { payload_kg: 0.0, link_mass_error: 0.0, noise_factor: 1.0 }
    }
}

impl ModelError {
    /// The truth that differs from the controller's model by this error; `seed` draws the link errors.
    pub fn apply(&self, mut truth: Truth<7>, seed: u64) -> Truth<7> {
        if self.link_mass_error > 0.0 {
            let mut rng = Pcg64::seed_from_u64(seed ^ 0x6c69_6e6b);
            // Uniform on ±1, as "±3 %" is meant.
            let errors = SVector::from_fn(|_, _| self.link_mass_error * rng.random_range(-1.0..1.0));
            truth.arm = truth.arm.with_link_scale_errors(&errors);
        }
        if self.payload_kg > 0.0 {
            let body = Payload { mass_kg: self.payload_kg, com_m: Vector3::zeros(), inertia_kg_m2: Matrix3::zeros() };
            truth.arm = truth.arm.with_payload(&body);
        }
        truth
    }

    /// The sensors with their noise scaled.
    pub fn sensors(&self) -> Sensors {
        Sensors::default().scaled_noise(self.noise_factor)
    }
}

/// Six phases of the reference (35), uniform on the circle, from a seed.
pub fn random_phases(seed: u64) -> [f64; 6] {
    let mut rng = Pcg64::seed_from_u64(seed ^ 0x7068_6173_6573);
    std::array::from_fn(|_| rng.random_range(0.0..2.0 * std::f64::consts::PI))
}
