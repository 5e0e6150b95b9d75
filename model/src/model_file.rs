//! A robot model on disk.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use tribo_logs::RobotLog;
use tribo_robot::Payload;
use tribo_sim::{Effect, TorqueSide};

use crate::ConfigError;
use crate::effects_section::validate_effects;
use crate::{AnyModel, FieldError, FileError, FrictionSection, LimitsSection, Model, YamlDocument};

/// Schema name of model files.
const SCHEMA: &str = "tribo.model/1";

/// Model YAML, `schema: tribo.model/1`: the arm, the side of its torque sensors, friction, payload and further causes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// `tribo.model/1`.
    pub schema: String,
    /// Name of a preset (see [`tribo_robot::presets`]), or the path of a URDF or MJCF, relative to this file.
    pub robot: String,
    /// Content of that URDF, as it was when the file was written by Tribo; goes before what the disk holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub urdf: Option<String>,
    /// Content of that MJCF, with everything that it includes; likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mjcf: Option<String>,
    /// Link of the URDF or body of the MJCF at which the arm begins; the root, or the body that carries the first joint, if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_link: Option<String>,
    /// Link of the URDF, body or site of the MJCF whose frame is the flange; the only end if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tip_link: Option<String>,
    /// Number of joints, for the reader; must match the robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<usize>,
    /// Side of the gears on which torques are meant.
    #[serde(default)]
    pub torque_side: TorqueSide,
    /// Gravity in base axes [m/s²].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gravity_m_s2: Option<[f64; 3]>,
    /// Reflected rotor inertia [kg m²], one per joint; the preset's if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotor_inertia_kg_m2: Option<Vec<f64>>,
    /// Limits in place of the robot's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<LimitsSection>,
    /// Configurations (rad) about which trials move, up to three; the robot's if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub poses_rad: Option<Vec<Vec<f64>>>,
    /// Friction; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionSection>,
    /// Body bolted to the flange.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub payload: Option<PayloadSection>,
    /// Causes on top of all that, as a diagnosis finds them.
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "crate::effect_entries::read")]
    pub effects: Vec<Effect>,
}

/// `payload: {mass_kg, com_m, inertia_kg_m2}`, flange frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PayloadSection {
    /// Mass (kg).
    pub mass_kg: f64,
    /// Centre of mass (m).
    #[serde(default)]
    pub com_m: [f64; 3],
    /// Inertia about the centre of mass [kg m²]: xx xy xz yy yz zz.
    #[serde(default)]
    pub inertia_kg_m2: [f64; 6],
}

impl ModelFile {
    /// The bare robot of a name without friction: what logs without a model file are held against. Where every one of
    /// `logs` has torque on both sides of the gears, there is only the transmission between: rotors that weigh nothing.
    pub fn bare(robot: &str, torque_side: TorqueSide, logs: &[RobotLog]) -> Self {
        let between_gears = !logs.is_empty() && logs.iter().all(|log| log.tau_link_nm.is_some());
        let joints = logs.first().map_or(0, |log| log.joints());
        Self {
            schema: SCHEMA.to_owned(),
            robot: robot.to_owned(),
            urdf: None,
            mjcf: None,
            base_link: None,
            tip_link: None,
            joints: None,
            torque_side,
            gravity_m_s2: None,
            rotor_inertia_kg_m2: between_gears.then(|| vec![0.0; joints]),
            limits: None,
            poses_rad: None,
            friction: None,
            payload: None,
            effects: Vec::new(),
        }
    }

    /// The same arm as torque sensors behind its gears see it: rigid bodies alone, without rotors, friction and whatever else is the gears'.
    pub fn behind_gears(mut self) -> Self {
        self.torque_side = TorqueSide::Link;
        (self.rotor_inertia_kg_m2, self.friction) = (None, None);
        let of_bodies = |effect: &Effect| {
            matches!(effect, Effect::Payload { .. } | Effect::LinkInertial { .. } | Effect::BaseTilt { .. })
        };
        self.effects.retain(of_bodies);
        self
    }

    /// Reads a file, and the URDF or MJCF that it names.
    pub fn read(path: &Path) -> Result<(Self, YamlDocument), FileError> {
        let document = YamlDocument::read(path)?;
        let mut file: Self = document.parse()?;
        file.resolve(path.parent().unwrap_or(Path::new(""))).map_err(|error| match error {
            ConfigError::Field(error) => document.explain(error),
            ConfigError::File(error) => error,
        })?;
        Ok((file, document))
    }

    /// Checks every field and builds the model of an arm with as many joints as it has.
    pub fn validate_any(&self) -> Result<AnyModel, FieldError> {
        Ok(match self.arm_joints()? {
            6 => AnyModel::Six(self.validate()?),
            _ => AnyModel::Seven(self.validate()?),
        })
    }

    /// Checks every field and builds the model; the robot must have N joints.
    #[inline(never)]
    pub fn validate<const N: usize>(&self) -> Result<Model<N>, FieldError> {
        if self.schema != SCHEMA {
            return Err(FieldError::new("schema", &self.schema, SCHEMA));
        }
        let mut model = Model::bare(self.to_robot()?, self.torque_side);
        if let Some(gravity) = self.gravity_m_s2 {
            for value in gravity {
                FieldError::check("gravity_m_s2", value, -100.0, 100.0)?;
            }
            model.arm.gravity_m_s2 = Vector3::from(gravity);
        }
        if self.rotor_inertia_kg_m2.as_ref().is_some_and(|inertia| inertia.iter().all(|value| *value == 0.0)) {
            model.arm = model.arm.link_side();
        }
        if let Some(payload) = &self.payload {
            FieldError::check("payload.mass_kg", payload.mass_kg, 0.0, 100.0)?;
            for value in payload.com_m {
                FieldError::check("payload.com_m", value, -2.0, 2.0)?;
            }
            let [xx, xy, xz, yy, yz, zz] = payload.inertia_kg_m2;
            let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            if !inertia.symmetric_eigenvalues().iter().all(|value| *value >= -1e-12) {
                let allowed = "xx xy xz yy yz zz of a positive semi-definite matrix";
                return Err(FieldError::new("payload.inertia_kg_m2", format!("{:?}", payload.inertia_kg_m2), allowed));
            }
            model.arm = model.arm.with_payload(&Payload {
                mass_kg: payload.mass_kg,
                com_m: Vector3::from(payload.com_m),
                inertia_kg_m2: inertia,
            });
        }
        if let Some(friction) = &self.friction {
            model.friction = friction.to_model("friction")?;
            model.smoothing_rad_s = friction.smoothing_rad_s;
        }
        validate_effects(&self.effects, &model)?;
        model.effects.clone_from(&self.effects);
        Ok(model)
    }
}
