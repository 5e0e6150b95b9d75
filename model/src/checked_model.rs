//! A model file, read and checked: from its sections to a model.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use tribo_robot::Payload;

use crate::effects_section::validate_effects;
use crate::model_file::SCHEMA;
use crate::{AnyModel, ConfigError, FieldError, FileError, Model, ModelFile, YamlDocument};

impl ModelFile {
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
            model.sticks = friction.sticks;
        }
        validate_effects(&self.effects, &model)?;
        model.effects.clone_from(&self.effects);
        Ok(model)
    }
}
