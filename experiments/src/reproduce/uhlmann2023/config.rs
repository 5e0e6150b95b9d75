//! Settings of the experiment.

use serde::{Deserialize, Serialize};
use tribo_residual::{DeflectionMean, DoubleEncoderSettings};

use tribo_model::FieldError;

/// Settings of the experiment, `schema: tribo.reproduce/1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Uhlmann2023 {
    /// `tribo.reproduce/1`.
    pub schema: String,
    /// Seeds 1 to this one.
    pub seeds: u64,
    /// Random poses that the processes are fitted to.
    pub training_poses: usize,
    /// Random poses on which they are tested.
    pub test_poses: usize,
    /// Longest last piece of the way to each of those poses (rad), in a random direction per joint: a calibration that only
    /// ends long ways never sees a joint that has just turned round.
    pub last_way_rad: f64,
    /// Poses at which known loads are applied.
    pub load_poses: usize,
    /// Largest known force (N), on the lever below.
    pub load_force_n: f64,
    /// Lever of the known loads about the flange (m), and of a moment in the relative error.
    pub lever_m: f64,
    /// Poses on the circle.
    pub circle_poses: usize,
    /// Radius of the circle (m), about the fixed end of the air spring.
    pub circle_radius_m: f64,
    /// Inclination of the tool along the circle (rad).
    pub inclination_rad: f64,
    /// Force of the air spring (N).
    pub spring_force_n: f64,
    /// Spread of every magnitude of every gear from seed to seed, relative.
    pub gear_spread: f64,
    /// Models.
    pub variants: Vec<Variant>,
}

/// What a model knows of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Variant {
    /// The paper: joint angles in, stiffness from zero load.
    Paper,
    /// And the direction of approach.
    Direction,
    /// And the branch of the hysteresis.
    Hysteresis,
    /// And a stiffness curve of the whole load: every extension the paper asks for but temperature.
    Extended,
    /// And gravity of a rigid-body model as the mean.
    GreyBox,
}

impl Variant {
    /// As in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Direction => "direction",
            Self::Hysteresis => "hysteresis",
            Self::Extended => "extended",
            Self::GreyBox => "grey_box",
        }
    }

    /// The model's settings.
    pub fn settings(self) -> DoubleEncoderSettings {
        DoubleEncoderSettings {
            direction_input: self != Self::Paper,
            loading_input: !matches!(self, Self::Paper | Self::Direction),
            preload: matches!(self, Self::Extended | Self::GreyBox),
            mean: if self == Self::GreyBox { DeflectionMean::RigidBody } else { DeflectionMean::Zero },
            encoder_sd_rad: 1e-6,
            ..DoubleEncoderSettings::paper()
        }
    }
}

impl Uhlmann2023 {
    /// Checks every field.
    ///
    /// # Errors
    /// [`FieldError`] names the first field outside its range.
    pub fn validate(&self) -> Result<(), FieldError> {
        if self.schema != "tribo.reproduce/1" {
            return Err(FieldError::new("schema", &self.schema, "tribo.reproduce/1"));
        }
        let checks = [
            ("seeds", self.seeds as f64, 1.0, 1000.0),
            ("training_poses", self.training_poses as f64, 40.0, 2000.0),
            ("test_poses", self.test_poses as f64, 1.0, 10_000.0),
            ("last_way_rad", self.last_way_rad, 0.0, 0.1),
            ("load_poses", self.load_poses as f64, 2.0, 1000.0),
            ("load_force_n", self.load_force_n, 1.0, 1000.0),
            ("lever_m", self.lever_m, 0.01, 10.0),
            ("circle_poses", self.circle_poses as f64, 4.0, 10_000.0),
            ("circle_radius_m", self.circle_radius_m, 0.01, 0.25),
            ("inclination_rad", self.inclination_rad, 0.0, 0.5),
            ("spring_force_n", self.spring_force_n, 1.0, 1000.0),
            ("gear_spread", self.gear_spread, 0.0, 0.5),
        ];
        for (field, value, least, most) in checks {
            FieldError::check(field, value, least, most)?;
        }
        if self.variants.is_empty() {
            return Err(FieldError::new("variants", "[]", "at least one"));
        }
        Ok(())
    }
}
