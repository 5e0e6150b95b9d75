//! A wrench estimator in one's own loop.

use nalgebra::{SVector, Vector6};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use tribo_ekf::WrenchEkfSettings;
use tribo_model::{AnyModel, ControllerModel, Model};
use tribo_robot::{Arm, ControlTerms, EstimatorInput, SensorFrame, WrenchEstimate, WrenchEstimator};
use tribo_trial::{AnyEstimator, band_of_model};

use crate::estimate::estimator_named;
use crate::failure::{bad, raised};
use crate::meant::meant;
use crate::rows::{array, sample};

/// An estimator and the arm that it believes in.
struct Running<const N: usize> {
    arm: Arm<N>,
    estimator: AnyEstimator<N>,
    time_s: f64,
    started: bool,
    last: WrenchEstimate,
}

impl<const N: usize> Running<N> {
    fn new(model: &Model<N>, name: &str) -> PyResult<Self> {
        let ControllerModel { arm, friction, .. } = ControllerModel::on_log(model);
        let settings = WrenchEkfSettings::default();
        let band = band_of_model(&friction);
        let estimator = AnyEstimator::with_confidence(estimator_named(name)?, settings, &arm, &friction, &band, 1.0)
            .map_err(raised)?;
        Ok(Self { arm, estimator, time_s: 0.0, started: false, last: WrenchEstimate::none_yet() })
    }

    fn step(
        &mut self,
        q: &Bound<'_, PyAny>,
        dq: &Bound<'_, PyAny>,
        tau: &Bound<'_, PyAny>,
        tau_friction: Option<&Bound<'_, PyAny>>,
        dt_s: f64,
        theta: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let none = SVector::zeros();
        let tau = sample::<N>(tau, "tau")?;
        let friction = tau_friction.map_or(Ok(none), |value| sample::<N>(value, "tau_friction"))?;
        let theta = theta.map(|theta| sample::<N>(theta, "theta")).transpose()?;
        let frame =
            SensorFrame { time_s: self.time_s, q: sample::<N>(q, "q")?, qd: sample::<N>(dq, "dq")?, tau, theta };
        let terms = ControlTerms::at(&self.arm, &frame.q, &frame.qd);
        if self.started {
            self.last = self.estimator.step(&EstimatorInput {
                frame: &frame,
                terms: &terms,
                tau_motor: &tau,
                tau_friction: &friction,
                acceleration_command: &Vector6::zeros(),
                dt_s,
            });
        } else {
            self.estimator.reset(&frame, &terms);
            self.started = true;
        }
        self.time_s += dt_s;
        Ok(())
    }
}

enum AnyRunning {
    Six(Box<Running<6>>),
    Seven(Box<Running<7>>),
}

/// A wrench estimator that is given one sample after the other.
///
/// The first sample after the start or a `reset` only sets its state.
#[pyclass(name = "WrenchEstimator", module = "tribo")]
pub(crate) struct PyWrenchEstimator {
    running: AnyRunning,
    name: String,
}

#[pymethods]
impl PyWrenchEstimator {
    /// `model` as in `diagnose`; `residual` is ekf, momentum, qp, thermal or double_encoder.
    #[new]
    #[pyo3(signature = (model, residual = "ekf"))]
    fn new(model: &Bound<'_, PyAny>, residual: &str) -> PyResult<Self> {
        let model = meant(Some(model), &[])?;
        let running = match &model.model {
            AnyModel::Six(model) => AnyRunning::Six(Box::new(Running::new(model, residual)?)),
            AnyModel::Seven(model) => AnyRunning::Seven(Box::new(Running::new(model, residual)?)),
        };
        Ok(Self { running, name: residual.to_owned() })
    }

    /// Forgets everything but its settings.
    fn reset(&mut self) {
        match &mut self.running {
            AnyRunning::Six(running) => (running.started, running.last) = (false, WrenchEstimate::none_yet()),
            AnyRunning::Seven(running) => (running.started, running.last) = (false, WrenchEstimate::none_yet()),
        }
    }

    /// Takes one sample and gives the wrench `(6,)`, force (N) then moment (Nm), by the robot on the environment, base axes.
    ///
    /// `tau` is the motor torque that acted over the last period, `tau_friction` what of it was added against friction; `dt` its length (s); `theta`
    /// the motor positions that double_encoder needs.
    #[pyo3(signature = (q, dq, tau, tau_friction = None, dt = 1e-3, theta = None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
        tau_friction: Option<&Bound<'py, PyAny>>,
        dt: f64,
        theta: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        match &mut self.running {
            AnyRunning::Six(running) => running.step(q, dq, tau, tau_friction, dt, theta)?,
            AnyRunning::Seven(running) => running.step(q, dq, tau, tau_friction, dt, theta)?,
        }
        if let Some(fault) = self.last().fault {
            return Err(bad(fault.to_string()));
        }
        array(py, self.last().wrench_base.to_force_moment().to_vec(), &[6])
    }

    /// Covariance `(6, 6)` of the last estimate, force then moment.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let covariance = self.last().covariance;
        let swapped = (0..36).map(|k| covariance[((k / 6 + 3) % 6, (k % 6 + 3) % 6)]).collect();
        array(py, swapped, &[6, 6])
    }

    /// 95 % limits `(2, 6)` of the last estimate: lower and upper, force then moment.
    #[getter]
    fn limits95<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let interval = self.last().interval95();
        let numbers = [interval.lower, interval.upper].iter().flat_map(|end| end.to_force_moment()).collect();
        array(py, numbers, &[2, 6])
    }

    fn __repr__(&self) -> String {
        format!("WrenchEstimator({})", self.name)
    }
}

impl PyWrenchEstimator {
    fn last(&self) -> &WrenchEstimate {
        match &self.running {
            AnyRunning::Six(running) => &running.last,
            AnyRunning::Seven(running) => &running.last,
        }
    }
}
