//! A friction compensator in one's own loop.

use std::path::PathBuf;

use nalgebra::SVector;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use tribo_export::{Format, export};
use tribo_files::write_atomic;
use tribo_friction::{Bristles, Compensator, CompensatorInput};
use tribo_model::{ControllerModel, TunedFile, YamlDocument, to_yaml};

use crate::failure::{bad, raised};
use crate::rows::{array, sample};

/// A compensator and its only memory.
struct Running<const N: usize> {
    compensator: Compensator<N>,
    bristles: Bristles<N>,
}

impl<const N: usize> Running<N> {
    fn new(file: &TunedFile) -> PyResult<Self> {
        let mut compensator = file.compensator::<N>().map_err(raised)?;
        if let Some(model) = file.controller_model::<N>().map_err(raised)? {
            compensator = compensator.with_effects(ControllerModel::by_controller(&model).effects);
        }
        Ok(Self { compensator, bristles: Bristles::default() })
    }

    fn step(
        &mut self,
        dq: &Bound<'_, PyAny>,
        dq_reference: Option<&Bound<'_, PyAny>>,
        q: Option<&Bound<'_, PyAny>>,
        load: Option<&Bound<'_, PyAny>>,
        dt_s: f64,
    ) -> PyResult<Vec<f64>> {
        let zero = SVector::zeros();
        let qd_measured = sample::<N>(dq, "dq")?;
        let input = CompensatorInput {
            q: q.map_or(Ok(zero), |q| sample::<N>(q, "q"))?,
            qd_measured,
            qd_reference: dq_reference.map_or(Ok(qd_measured), |value| sample::<N>(value, "dq_reference"))?,
            load_nm: load.map_or(Ok(zero), |load| sample::<N>(load, "load"))?,
            dt_s,
        };
        Ok(self.compensator.tick(&mut self.bristles, &input).total().as_slice().to_vec())
    }
}

enum AnyRunning {
    Six(Box<Running<6>>),
    Seven(Box<Running<7>>),
}

/// What a campaign tuned: the torque that cancels friction, tick by tick.
#[pyclass(name = "Compensator", module = "tribo")]
pub(crate) struct PyCompensator {
    running: AnyRunning,
    file: TunedFile,
}

impl PyCompensator {
    pub(crate) fn of(file: TunedFile) -> PyResult<Self> {
        let running = match file.joints() {
            6 => AnyRunning::Six(Box::new(Running::new(&file)?)),
            _ => AnyRunning::Seven(Box::new(Running::new(&file)?)),
        };
        Ok(Self { running, file })
    }
}

#[pymethods]
impl PyCompensator {
    /// Reads `tuned.yaml` of a campaign, or the file of a trial.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        Self::of(TunedFile::read(&path).map_err(raised)?)
    }

    /// Parses the text of such a file.
    #[staticmethod]
    fn from_yaml(text: &str) -> PyResult<Self> {
        Self::of(TunedFile::parse(&YamlDocument::embedded("compensator", text)).map_err(raised)?)
    }

    /// The text of its file.
    fn to_yaml(&self) -> PyResult<String> {
        to_yaml(&self.file).map_err(raised)
    }

    /// Writes its file, whole or not at all.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        let text = self.to_yaml()?;
        write_atomic(&path, |file| file.write_all(text.as_bytes())).map_err(raised)
    }

    /// The compensator in a format of another stack: c, rust, ros2, crisp, urdf, mjcf, yaml or json; gives the text, and what it does not say. `name` is what the target
    /// shall call it: the node (ros2, crisp), the prefix of identifiers (c), the model (urdf, mjcf).
    #[pyo3(signature = (format, name = None))]
    fn export(&self, format: &str, name: Option<&str>) -> PyResult<(String, Vec<String>)> {
        let format: Format = serde_json::from_value(format.into())
            .map_err(|_| bad(format!("format is {format}; allowed: c, rust, ros2, crisp, urdf, mjcf, yaml, json")))?;
        let exported = export(&self.file, format, name).map_err(raised)?;
        Ok((exported.text, exported.losses.iter().map(ToString::to_string).collect()))
    }

    /// Torque to add (Nm), `(joints,)`, at the measured velocity `dq` (rad/s).
    ///
    /// `dq_reference` is the velocity that the motion is meant to have (the desired velocity of its trajectory, 0 at rest), which decides the sign near rest where the compensator was tuned
    /// with `hybrid` or `reference` velocity; left out, the measured one stands in for it, whose noise turns the sign at rest. `q` (rad) and `load` (Nm through the gears) count only for effects that
    /// depend on them.
    #[pyo3(signature = (dq, dq_reference = None, q = None, load = None, dt = 1e-3))]
    fn torque<'py>(
        &mut self,
        py: Python<'py>,
        dq: &Bound<'py, PyAny>,
        dq_reference: Option<&Bound<'py, PyAny>>,
        q: Option<&Bound<'py, PyAny>>,
        load: Option<&Bound<'py, PyAny>>,
        dt: f64,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let torque = match &mut self.running {
            AnyRunning::Six(running) => running.step(dq, dq_reference, q, load, dt)?,
            AnyRunning::Seven(running) => running.step(dq, dq_reference, q, load, dt)?,
        };
        let joints = torque.len();
        array(py, torque, &[joints])
    }

    /// Its friction parameters: one dictionary per joint.
    #[getter]
    fn parameters(&self) -> Vec<std::collections::BTreeMap<&'static str, f64>> {
        self.file.friction.joints.iter().map(|joint| joint.given().into_iter().collect()).collect()
    }

    /// Velocity that it believes near zero: `measured`, `reference` or `hybrid`.
    #[getter]
    fn velocity(&self) -> String {
        serde_json::to_value(self.file.velocity).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
    }

    /// Number of joints.
    #[getter]
    fn joints(&self) -> usize {
        self.file.friction.joints.len()
    }

    fn __repr__(&self) -> String {
        format!("Compensator({}, {} joints, {})", self.file.robot, self.joints(), self.velocity())
    }
}
