//! Models.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use tribo_files::write_atomic;
use tribo_logs::RobotLog;
use tribo_model::{
    AnyModel, FrictionSection, JointParameters, LawName, ModelChoice, ModelFile, PayloadSection, to_yaml,
};
use tribo_robot::presets;

use crate::failure::{bad, raised};
use crate::remarks::warn;

/// What is believed of a robot: the arm, its friction, further effects, and the side of the gears on which torques are meant.
///
/// `tau = M qdd + C qd + g + Ir qdd + friction(qd) + effects`
#[pyclass(name = "Model", module = "tribo", frozen)]
#[derive(Clone, Debug)]
pub(crate) struct PyModel {
    pub(crate) file: ModelFile,
    pub(crate) model: AnyModel,
    /// What reports call it.
    pub(crate) name: String,
}

impl PyModel {
    /// A model that a file describes, validated.
    pub(crate) fn of(file: ModelFile, name: String) -> PyResult<Self> {
        let model = file.validate_any().map_err(raised)?;
        Ok(Self { file, model, name })
    }

    /// The bare robot without friction.
    pub(crate) fn bare_robot(
        robot: &str,
        torque_side: &str,
        base_link: Option<String>,
        tip_link: Option<String>,
        logs: &[RobotLog],
    ) -> PyResult<Self> {
        let side = serde_json::from_value(torque_side.into())
            .map_err(|_| bad(format!("torque_side is {torque_side}; allowed: motor, link")))?;
        let mut file = ModelFile { base_link, tip_link, ..ModelFile::bare(robot, side, logs) };
        file.resolve(Path::new("")).map_err(raised)?;
        let model = file.validate_any().map_err(raised)?;
        for remark in file.remarks() {
            Python::attach(|py| warn(py, &format!("{robot}: {remark}")))?;
        }
        let robot = match &model {
            AnyModel::Six(model) => &model.robot.arm.name,
            AnyModel::Seven(model) => &model.robot.arm.name,
        };
        let name = ModelChoice::default().name(robot);
        Ok(Self { file, model, name })
    }
}

#[pymethods]
impl PyModel {
    /// Reads a model file (YAML, schema tribo.model/1).
    #[staticmethod]
    pub(crate) fn read(path: PathBuf) -> PyResult<Self> {
        let (file, document) = ModelFile::read(&path).map_err(raised)?;
        let model = file.validate_any().map_err(|error| raised(document.explain(error)))?;
        Ok(Self { file, model, name: path.display().to_string() })
    }

    /// The bare robot without friction: a preset, or the path of a URDF or MJCF.
    #[staticmethod]
    #[pyo3(signature = (robot, *, torque_side = "motor", base_link = None, tip_link = None))]
    fn bare(robot: PathBuf, torque_side: &str, base_link: Option<String>, tip_link: Option<String>) -> PyResult<Self> {
        Self::bare_robot(&robot.to_string_lossy(), torque_side, base_link, tip_link, &[])
    }

    /// Parses the text of a model file.
    #[staticmethod]
    fn from_yaml(text: &str) -> PyResult<Self> {
        let document = tribo_model::YamlDocument::embedded("model", text);
        let mut file: ModelFile = document.parse().map_err(raised)?;
        file.resolve(Path::new("")).map_err(raised)?;
        let model = file.validate_any().map_err(|error| raised(document.explain(error)))?;
        Ok(Self { file, model, name: "model".to_owned() })
    }

    /// The same with this Coulomb (Nm) and viscous (Nm s/rad) friction, one number per joint, in place of its own.
    fn with_friction(&self, coulomb: Vec<f64>, viscous: Vec<f64>) -> PyResult<Self> {
        let joints = self.joints();
        if [coulomb.len(), viscous.len()] != [joints; 2] {
            return Err(bad(format!(
                "coulomb has {}, viscous {} numbers; the arm has {joints} joints",
                coulomb.len(),
                viscous.len()
            )));
        }
        let joints = coulomb.into_iter().zip(viscous).map(|(coulomb, viscous)| JointParameters {
            coulomb_nm: Some(coulomb),
            viscous_nm_s_per_rad: Some(viscous),
            ..JointParameters::default()
        });
        let law = LawName::CoulombViscous;
        let sticks = self.file.friction.as_ref().is_some_and(|friction| friction.sticks);
        let smoothing_rad_s = self.model.smoothing_rad_s();
        let friction = FrictionSection { law, smoothing_rad_s, sticks, joints: joints.collect() };
        Self::of(ModelFile { friction: Some(friction), ..self.file.clone() }, self.name.clone())
    }

    /// The same with a body at its flange in place of its own payload: mass (kg), centre of mass (m) and inertia about it (kg m²: xx xy xz yy yz zz), flange axes.
    #[pyo3(signature = (mass, com = [0.0; 3], inertia = [0.0; 6]))]
    fn with_payload(&self, mass: f64, com: [f64; 3], inertia: [f64; 6]) -> PyResult<Self> {
        let payload = PayloadSection { mass_kg: mass, com_m: com, inertia_kg_m2: inertia };
        Self::of(ModelFile { payload: Some(payload), ..self.file.clone() }, self.name.clone())
    }

    /// The text of its model file.
    fn to_yaml(&self) -> PyResult<String> {
        to_yaml(&self.file).map_err(raised)
    }

    /// Writes the model file, whole or not at all.
    pub(crate) fn save(&self, path: PathBuf) -> PyResult<()> {
        let text = self.to_yaml()?;
        write_atomic(&path, |file| file.write_all(text.as_bytes())).map_err(raised)
    }

    /// Number of joints.
    #[getter]
    fn joints(&self) -> usize {
        self.model.joints()
    }

    /// Names of the joints from the base: those of its robot description, or `joint_0` … of a preset.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        let described = self.file.names_of_joints();
        match described.is_empty() {
            true => (0..self.model.joints()).map(|joint| format!("joint_{joint}")).collect(),
            false => described,
        }
    }

    /// Side of the gears on which torques are meant: `motor` or `link`.
    #[getter]
    fn torque_side(&self) -> String {
        serde_json::to_value(self.file.torque_side)
            .ok()
            .and_then(|side| side.as_str().map(str::to_owned))
            .unwrap_or_default()
    }

    fn __repr__(&self) -> String {
        format!("Model({}, {} joints, {} effects)", self.model.robot(), self.model.joints(), self.file.effects.len())
    }
}

/// Names of the robots that need no description.
pub(crate) fn is_preset(name: &str) -> bool {
    presets::NAMES.contains(&name)
}
