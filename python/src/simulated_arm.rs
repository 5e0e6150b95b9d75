//! An arm with friction, to be driven.

use nalgebra::SVector;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tribo_campaign::{AnyTune, TuneConfig, ValidTune};
use tribo_robot::{Plant, SensorFrame, Wrench};
use tribo_sim::{BoxFrictionPlant, Pulse, WrenchPulses};
use tribo_trial::scenario::TruthName;

use crate::failure::{bad, raised};
use crate::rows::{array, column, sample};

/// The plant, what its sensors said last, and how it began.
struct Running<const N: usize> {
    tune: ValidTune<N>,
    noise: f64,
    seed: u64,
    plant: BoxFrictionPlant<N>,
    frame: SensorFrame<N>,
}

/// A pulse that lasts: the time before and after the present period, and its ramps (s).
const PULSE_S: [f64; 2] = [10.0, 0.1];

impl<const N: usize> Running<N> {
    fn new(tune: ValidTune<N>, noise: f64, seed: u64) -> Self {
        let (plant, frame) = Self::begun(&tune, tune.trial.start, noise, seed);
        Self { tune, noise, seed, plant, frame }
    }

    fn begun(tune: &ValidTune<N>, q: SVector<f64, N>, noise: f64, seed: u64) -> (BoxFrictionPlant<N>, SensorFrame<N>) {
        let sensors = tune.trial.sensors.scaled_noise(noise);
        let mut plant = BoxFrictionPlant::new(tune.trial.truth.clone(), sensors, q, seed).with_period(tune.trial.dt_s);
        let frame = plant.sample();
        (plant, frame)
    }

    fn reset(&mut self, q: Option<&Bound<'_, PyAny>>, seed: Option<u64>) -> PyResult<()> {
        let q = q.map_or(Ok(self.tune.trial.start), |q| sample::<N>(q, "q"))?;
        self.seed = seed.unwrap_or(self.seed);
        (self.plant, self.frame) = Self::begun(&self.tune, q, self.noise, self.seed);
        Ok(())
    }

    fn step(&mut self, tau: &Bound<'_, PyAny>, wrench: Option<[f64; 6]>) -> PyResult<()> {
        let tau = sample::<N>(tau, "tau")?;
        if let Some(joint) = tau.iter().position(|value| !value.is_finite()) {
            return Err(bad(format!("tau[{joint}] is {}; allowed: finite numbers", tau[joint])));
        }
        let now_s = self.plant.time_s();
        self.plant.set_pulses(WrenchPulses {
            pulses: wrench
                .map(|wrench| Pulse {
                    wrench_base: Wrench::from_force_moment(&wrench),
                    start_s: now_s - PULSE_S[0],
                    end_s: now_s + PULSE_S[0],
                    ramp_s: PULSE_S[1],
                })
                .into_iter()
                .collect(),
        });
        self.plant.actuate(&tau);
        self.frame = self.plant.sample();
        Ok(())
    }

    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let state = PyDict::new(py);
        state.set_item("time", self.frame.time_s)?;
        for (name, values) in [("q", self.frame.q), ("dq", self.frame.qd), ("tau", self.frame.tau)] {
            state.set_item(name, numbers(py, &values)?)?;
        }
        Ok(state)
    }

    fn hidden<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let hidden = PyDict::new(py);
        for (name, values) in
            [("q", self.plant.q()), ("dq", self.plant.qd()), ("friction", self.plant.friction_torque())]
        {
            hidden.set_item(name, numbers(py, values)?)?;
        }
        hidden.set_item("wrench", array(py, self.plant.wrench().to_force_moment().to_vec(), &[6])?)?;
        Ok(hidden)
    }
}

fn numbers<'py, const N: usize>(py: Python<'py>, values: &SVector<f64, N>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    array(py, values.as_slice().to_vec(), &[N])
}

enum AnyRunning {
    Six(Box<Running<6>>),
    Seven(Box<Running<7>>),
}

macro_rules! running {
    ($any:expr, $running:ident => $body:expr) => {
        match $any {
            AnyRunning::Six($running) => $body,
            AnyRunning::Seven($running) => $body,
        }
    };
}

/// A simulated arm with true friction and hidden effects, driven by motor torque at 1 kHz.
///
/// Dry friction is set-valued: the arm truly sticks. Sensors have the noise of a Panda, times `noise`.
#[pyclass(name = "SimulatedArm", module = "tribo")]
pub(crate) struct PySimulatedArm {
    running: AnyRunning,
}

#[pymethods]
impl PySimulatedArm {
    /// `robot` is a preset or the path of a robot description; `friction` is coulomb_viscous, stribeck, lugre, gaz, soft, thermal, frictionless or the path of a model file;
    /// `pose` is the number of the pose at which it begins (0, 1, 2).
    #[new]
    #[pyo3(signature = (robot = None, friction = "coulomb_viscous", *, pose = 0, seed = 1, noise = 1.0))]
    fn new(robot: Option<String>, friction: &str, pose: usize, seed: u64, noise: f64) -> PyResult<Self> {
        if !(noise >= 0.0 && noise.is_finite()) {
            return Err(bad(format!("noise is {noise}; allowed: 0 or more")));
        }
        let truth = TruthName::from(friction.to_owned());
        let config = TuneConfig { robot, truth, pose, seed, ..TuneConfig::default() };
        let running = match config.validate_any().map_err(raised)? {
            AnyTune::Six(tune) => AnyRunning::Six(Box::new(Running::new(tune, noise, seed))),
            AnyTune::Seven(tune) => AnyRunning::Seven(Box::new(Running::new(tune, noise, seed))),
        };
        Ok(Self { running })
    }

    /// Puts the arm at rest at `q` (rad), or where it began; gives its state. The same seed gives the same noise.
    #[pyo3(signature = (q = None, *, seed = None))]
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        q: Option<&Bound<'py, PyAny>>,
        seed: Option<u64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        running!(&mut self.running, running => { running.reset(q, seed)?; running.state(py) })
    }

    /// Applies the motor torque `tau` (Nm), `(joints,)`, for one period of 1 ms, while the tool exerts `wrench` (N, Nm), `(6,)`, on its environment; gives the state:
    /// `time` (s), measured `q` (rad), `dq` (rad/s), `tau` (Nm).
    #[pyo3(signature = (tau, wrench = None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        tau: &Bound<'py, PyAny>,
        wrench: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let wrench: Option<[f64; 6]> = wrench
            .map(|wrench| {
                let six: Result<[f64; 6], _> = column(wrench, "wrench")?.try_into();
                six.map_err(|_| bad("wrench has not six numbers: force (N), then moment (Nm)"))
            })
            .transpose()?;
        running!(&mut self.running, running => { running.step(tau, wrench)?; running.state(py) })
    }

    /// The last state.
    #[getter]
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        running!(&self.running, running => running.state(py))
    }

    /// What no controller sees: true `q`, `dq`, `friction` torque (Nm, mean of the last period), `wrench` `(6,)`.
    #[getter]
    fn hidden<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        running!(&self.running, running => running.hidden(py))
    }

    /// Control period (s).
    #[getter]
    fn dt(&self) -> f64 {
        running!(&self.running, running => running.tune.trial.dt_s)
    }

    /// Number of joints.
    #[getter]
    fn joints(&self) -> usize {
        match self.running {
            AnyRunning::Six(_) => 6,
            AnyRunning::Seven(_) => 7,
        }
    }

    fn __repr__(&self) -> String {
        let truth = running!(&self.running, running => String::from(running.tune.config.truth.clone()));
        let robot = running!(&self.running, running => running.tune.trial.truth.arm.name.clone());
        format!("SimulatedArm({robot}, friction={truth})")
    }
}
