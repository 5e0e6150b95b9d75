//! A robot model on disk.

use nalgebra::{Matrix3, SVector, Vector3};
use serde::{Deserialize, Serialize};
use tribo_robot::Payload;
use tribo_sim::{Effect, TorqueSide};

use super::effects_section::validate_effects;
use super::{FieldError, FrictionSection, Model};

/// Schema name of model files.
const SCHEMA: &str = "tribo.model/1";

/// Model YAML, `schema: tribo.model/1`: the arm, the side of its torque sensors, friction, payload and further causes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// `tribo.model/1`.
    pub schema: String,
    /// Name of a preset: `panda`.
    pub robot: String,
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
    /// Friction; none if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionSection>,
    /// Body bolted to the flange.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub payload: Option<PayloadSection>,
    /// Causes on top of all that, as a diagnosis finds them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
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
    /// Checks every field and builds the model.
    pub fn validate(&self) -> Result<Model<7>, FieldError> {
        if self.schema != SCHEMA {
            return Err(FieldError::new("schema", &self.schema, SCHEMA));
        }
        if self.robot != "panda" {
            return Err(FieldError::new("robot", &self.robot, "panda"));
        }
        if self.joints.is_some_and(|joints| joints != 7) {
            return Err(FieldError::new("joints", self.joints.unwrap_or_default(), "7"));
        }
        let mut model = Model::panda(self.torque_side);
        if let Some(gravity) = self.gravity_m_s2 {
            for value in gravity {
                FieldError::check("gravity_m_s2", value, -100.0, 100.0)?;
            }
            model.arm.gravity_m_s2 = Vector3::from(gravity);
        }
        if let Some(inertia) = &self.rotor_inertia_kg_m2 {
            if inertia.len() != 7 {
                return Err(FieldError::new("rotor_inertia_kg_m2", format!("{} entries", inertia.len()), "7 entries"));
            }
            for &value in inertia {
                FieldError::check("rotor_inertia_kg_m2", value, 0.0, 1e3)?;
            }
            if self.torque_side == TorqueSide::Motor {
                model.arm.rotor_inertia_kg_m2 = SVector::from_column_slice(inertia);
            }
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
