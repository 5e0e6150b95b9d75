//! Truths and model errors a campaign can be run on.

use std::path::PathBuf;

use nalgebra::{Matrix3, SVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use tribo_friction::FrictionModel;
use tribo_robot::Payload;
use tribo_sim::{Sensors, Truth};

use crate::published_gaz::published_gaz;
pub use tribo_model::POSES;
use tribo_model::{ConfigError, ControllerModel, FieldError, ModelFile, Robot};

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
    /// The sigmoid of gaz2019.
    Gaz,
    /// Coulomb and viscous friction as a physics engine makes it: a joint creeps where it should stick.
    Soft,
    /// Coulomb and viscous friction that fades with operating time.
    Thermal,
    /// No friction.
    Frictionless,
    /// Nobody says: coulomb_viscous of a simulated arm, none of a robot elsewhere.
    Unknown,
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
            "soft" => Self::Soft,
            "thermal" => Self::Thermal,
            "frictionless" => Self::Frictionless,
            "" => Self::Unknown,
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
            TruthName::Soft => "soft".to_owned(),
            TruthName::Thermal => "thermal".to_owned(),
            TruthName::Frictionless => "frictionless".to_owned(),
            TruthName::Unknown => String::new(),
            TruthName::File(path) => path.display().to_string(),
        }
    }
}

/// A truth, and the model of it that leaves nothing to wish for.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedTruth<const N: usize> {
    /// What the plant obeys.
    pub truth: Truth<N>,
    /// What an oracle knows of it.
    pub oracle: ControllerModel<N>,
}

impl TruthName {
    /// What is meant where a file does not say.
    pub fn unknown() -> Self {
        Self::Unknown
    }

    /// Whether nobody says.
    pub fn is_unknown(&self) -> bool {
        *self == Self::Unknown
    }

    /// The path of a model file.
    pub fn path(&self) -> Option<&PathBuf> {
        match self {
            Self::File(path) => Some(path),
            _ => None,
        }
    }

    /// The truth of this name about a robot; `content` is that of the file, where the name is one.
    ///
    /// # Errors
    /// A friction that nobody knows of this robot, or a file about one with another number of joints.
    #[inline(never)]
    pub fn of<const N: usize>(
        &self,
        robot: &Robot<N>,
        content: Option<&ModelFile>,
    ) -> Result<LoadedTruth<N>, FieldError> {
        if let Some(file) = content {
            let model = file.validate().map_err(|error| error.within("truth_content"))?;
            let truth = model.to_plant();
            return Ok(LoadedTruth { oracle: ControllerModel::of(truth.clone()), truth });
        }
        let unknown = |allowed: &str| FieldError::new("truth", String::from(self.clone()), allowed);
        let friction = || {
            let why = "a model file or frictionless: the friction of this robot is not known";
            robot.friction.ok_or_else(|| unknown(why))
        };
        let arm = robot.arm.clone();
        let truth = match self {
            Self::CoulombViscous => Truth::new(arm, friction()?.coulomb_viscous()),
            Self::Stribeck => Truth::new(arm, friction()?.stribeck()),
            Self::Lugre => Truth::new(arm, friction()?.lugre()),
            Self::Gaz if arm.name == "panda" => Truth::new(arm, published_gaz().ok_or_else(|| unknown(GAZ))?),
            Self::Gaz => return Err(unknown(GAZ)),
            Self::Soft => Truth::new(arm, friction()?.coulomb_viscous()).creeping(),
            Self::Thermal => Truth::new(arm, friction()?.coulomb_viscous()).warming_up(),
            Self::Frictionless | Self::Unknown => Truth::new(arm, FrictionModel::none()),
            Self::File(_) => return Err(unknown("a model file that has been read")),
        };
        let oracle = ControllerModel::of(truth.clone());
        Ok(LoadedTruth { truth, oracle })
    }
}

/// What goes where the friction published by gaz2019 does not.
const GAZ: &str = "another truth: gaz is the friction of a Panda";

/// Reads a model file into `content`, unless that holds it already: a campaign keeps the file it began with. Its numbers
/// are checked where errors can still name file and line.
pub fn freeze(path: Option<&PathBuf>, content: &mut Option<ModelFile>) -> Result<(), ConfigError> {
    let Some(path) = path else {
        *content = None;
        return Ok(());
    };
    if content.is_none() {
        let (file, document) = ModelFile::read(path)?;
        file.validate_any().map_err(|error| document.explain(error))?;
        *content = Some(file);
    }
    Ok(())
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
    pub fn apply<const N: usize>(&self, mut truth: Truth<N>, seed: u64) -> Truth<N> {
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
