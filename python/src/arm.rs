//! Kinematics and dynamics of an arm.

use std::path::PathBuf;

use nalgebra::SVector;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use tribo_model::AnyModel;
use tribo_robot::{
    Arm, Kinematics, bias_torque, forward_dynamics, gravity_torque, inverse_dynamics_regressor, mass_matrix, rnea,
};

use crate::failure::bad;
use crate::model::{PyModel, is_preset};
use crate::rows::{Rows, array, over_rows};

/// An arm with as many joints as it happens to have.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "both are large, and few exist")]
pub(crate) enum AnyArm {
    Six(Arm<6>),
    Seven(Arm<7>),
}

impl AnyArm {
    pub(crate) fn of(model: &AnyModel) -> Self {
        match model {
            AnyModel::Six(model) => Self::Six(model.arm.clone()),
            AnyModel::Seven(model) => Self::Seven(model.arm.clone()),
        }
    }
}

/// The same expression for either number of joints.
macro_rules! either {
    ($any:expr, $kind:ident, $arm:ident => $body:expr) => {
        match $any {
            $kind::Six($arm) => $body,
            $kind::Seven($arm) => $body,
        }
    };
}
pub(crate) use either;

type Numbers<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

/// A serial arm of six or seven revolute joints: kinematics and dynamics on arrays `(n, joints)`, or `(joints,)` of one sample.
///
/// `tau = M(q) qdd + C(q, qd) qd + g(q) + Ir qdd`, SI units, base axes; Ir is the rotor inertia, part of M.
#[pyclass(name = "Arm", module = "tribo", frozen)]
#[derive(Clone, Debug)]
pub(crate) struct PyArm {
    pub(crate) arm: AnyArm,
    pub(crate) model: PyModel,
}

impl PyArm {
    fn of_robot(path: PathBuf, base_link: Option<String>, tip_link: Option<String>) -> PyResult<Self> {
        let model = PyModel::bare_robot(&path.to_string_lossy(), "motor", base_link, tip_link, &[])?;
        Ok(Self { arm: AnyArm::of(&model.model), model })
    }

    fn rows<'py>(&self, value: &Bound<'py, PyAny>, name: &str, like: Option<&Rows<'py>>) -> PyResult<Rows<'py>> {
        Rows::of_arm(value, name, self.joints(), like)
    }

    /// q, qd and a third array of the same shape; those left out are zero.
    fn three<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        qd: Option<&Bound<'py, PyAny>>,
        third: (Option<&Bound<'py, PyAny>>, &str),
    ) -> PyResult<[Rows<'py>; 3]> {
        let q = self.rows(q, "q", None)?;
        let other = |value: Option<&Bound<'py, PyAny>>, name: &str| {
            value.map_or_else(|| Ok(q.zeros_like()), |value| self.rows(value, name, Some(&q)))
        };
        let (qd, third) = (other(qd, "qd")?, other(third.0, third.1)?);
        Ok([q, qd, third])
    }
}

#[pymethods]
impl PyModel {
    /// The arm with the model's payload, without its effects; without rotor inertia where torques are meant link-side.
    #[getter]
    fn arm(&self) -> PyArm {
        PyArm { arm: AnyArm::of(&self.model), model: self.clone() }
    }
}

#[pymethods]
impl PyArm {
    /// The arm of a name: one of `tribo.PRESETS`.
    #[staticmethod]
    fn preset(name: &str) -> PyResult<Self> {
        if !is_preset(name) {
            return Err(bad(format!("robot is {name}; allowed: {}", tribo_robot::presets::NAMES.join(", "))));
        }
        Self::of_robot(name.into(), None, None)
    }

    /// The arm of a URDF, from `base_link` (the root if left out) to `tip_link` (the only end if left out).
    #[staticmethod]
    #[pyo3(signature = (path, *, base_link = None, tip_link = None))]
    fn from_urdf(path: PathBuf, base_link: Option<String>, tip_link: Option<String>) -> PyResult<Self> {
        Self::of_robot(path, base_link, tip_link)
    }

    /// The arm of a MuJoCo model, from body `base_link` to body or site `tip_link`.
    #[staticmethod]
    #[pyo3(signature = (path, *, base_link = None, tip_link = None))]
    fn from_mjcf(path: PathBuf, base_link: Option<String>, tip_link: Option<String>) -> PyResult<Self> {
        Self::of_robot(path, base_link, tip_link)
    }

    /// Name of the preset, or the one that its description gives it.
    #[getter]
    fn name(&self) -> String {
        either!(&self.arm, AnyArm, arm => arm.name.clone())
    }

    /// Number of joints.
    #[getter]
    fn joints(&self) -> usize {
        match self.arm {
            AnyArm::Six(_) => 6,
            AnyArm::Seven(_) => 7,
        }
    }

    /// Limits as arrays `(joints,)`: `q_min` and `q_max` (rad), `qd_max` (rad/s), `tau_max` (Nm), `tau_rate_max` (Nm/s).
    #[getter]
    fn limits<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<std::collections::BTreeMap<&'static str, Bound<'py, PyArrayDyn<f64>>>> {
        fn named<'py, const N: usize>(
            py: Python<'py>,
            arm: &Arm<N>,
        ) -> PyResult<std::collections::BTreeMap<&'static str, Bound<'py, PyArrayDyn<f64>>>> {
            let limits = &arm.limits;
            [
                ("q_min", &limits.q_min_rad),
                ("q_max", &limits.q_max_rad),
                ("qd_max", &limits.qd_max_rad_s),
                ("tau_max", &limits.tau_max_nm),
                ("tau_rate_max", &limits.tau_rate_max_nm_s),
            ]
            .into_iter()
            .map(|(name, values)| Ok((name, array(py, values.as_slice().to_vec(), &[N])?)))
            .collect()
        }
        either!(&self.arm, AnyArm, arm => named(py, arm))
    }

    /// Three configurations (rad), `(3, joints)`, away from singularities and limits; the first is the ready pose.
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> Numbers<'py> {
        either!(&self.model.model, AnyModel, model => {
            let numbers = model.robot.poses_rad.iter().flat_map(|pose| pose.iter().copied()).collect();
            array(py, numbers, &[model.robot.poses_rad.len(), self.joints()])
        })
    }

    /// Pose of the flange in the base, `(n, 4, 4)`: `[[R, p], [0, 1]]`.
    fn pose<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> Numbers<'py> {
        let q = self.rows(q, "q", None)?;
        either!(&self.arm, AnyArm, arm => over_rows(py, [&q], &[4, 4], |[q], out| {
            let pose = Kinematics::at(arm, &q).base_from_flange().to_homogeneous();
            out.copy_from_slice(pose.transpose().as_slice());
        }))
    }

    /// Jacobian of the flange origin in base axes, `(n, 6, joints)`: rows of the linear velocity, then of the angular, so that `J.T @ [force, moment]` is a torque.
    fn jacobian<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> Numbers<'py> {
        let (q, joints) = (self.rows(q, "q", None)?, self.joints());
        either!(&self.arm, AnyArm, arm => over_rows(py, [&q], &[6, joints], |[q], out| {
            let jacobian = Kinematics::at(arm, &q).jacobian();
            for (row, out) in out.chunks_exact_mut(joints).enumerate() {
                out.iter_mut().enumerate().for_each(|(j, value)| *value = jacobian[((row + 3) % 6, j)]);
            }
        }))
    }

    /// Mass matrix M(q) with rotor inertia (kg m²), `(n, joints, joints)`.
    fn mass_matrix<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> Numbers<'py> {
        let (q, joints) = (self.rows(q, "q", None)?, self.joints());
        either!(&self.arm, AnyArm, arm => over_rows(py, [&q], &[joints, joints], |[q], out| {
            out.copy_from_slice(mass_matrix(arm, &q).as_slice());
        }))
    }

    /// Gravity torque g(q) (Nm), `(n, joints)`.
    fn gravity<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> Numbers<'py> {
        let (q, joints) = (self.rows(q, "q", None)?, self.joints());
        either!(&self.arm, AnyArm, arm => over_rows(py, [&q], &[joints], |[q], out| {
            out.copy_from_slice(gravity_torque(arm, &q).as_slice());
        }))
    }

    /// Coriolis, centrifugal and gravity torque C(q, qd) qd + g(q) (Nm), `(n, joints)`.
    fn bias<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>, qd: &Bound<'py, PyAny>) -> Numbers<'py> {
        let ([q, qd, _], joints) = (self.three(q, Some(qd), (None, ""))?, self.joints());
        either!(&self.arm, AnyArm, arm => over_rows(py, [&q, &qd], &[joints], |[q, qd], out| {
            out.copy_from_slice(bias_torque(arm, &q, &qd).as_slice());
        }))
    }

    /// Joint torque of a motion (Nm), `(n, joints)`: recursive Newton–Euler; `qd` and `qdd` left out are zero.
    #[pyo3(signature = (q, qd = None, qdd = None))]
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        qd: Option<&Bound<'py, PyAny>>,
        qdd: Option<&Bound<'py, PyAny>>,
    ) -> Numbers<'py> {
        let ([q, qd, qdd], joints) = (self.three(q, qd, (qdd, "qdd"))?, self.joints());
        either!(&self.arm, AnyArm, arm => over_rows(py, [&q, &qd, &qdd], &[joints], |[q, qd, qdd], out| {
            out.copy_from_slice(rnea(arm, &q, &qd, &qdd).as_slice());
        }))
    }

    /// Joint acceleration under a torque (rad/s²), `(n, joints)`: articulated bodies.
    fn forward_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        qd: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
    ) -> Numbers<'py> {
        let ([q, qd, tau], joints) = (self.three(q, Some(qd), (Some(tau), "tau"))?, self.joints());
        either!(&self.arm, AnyArm, arm => over_rows(py, [&q, &qd, &tau], &[joints], |[q, qd, tau], out| {
            out.copy_from_slice(forward_dynamics(arm, &q, &qd, &tau).as_slice());
        }))
    }

    /// Regressor of the rigid-body torque, `(n, joints, 10 joints)`: ten columns per link `m, m c (xyz), I_o (xx xy xz yy yz zz)`; the rotors are not
    /// among them. `regressor @ parameters + rotor_inertia * qdd == inverse_dynamics`.
    #[pyo3(signature = (q, qd = None, qdd = None))]
    fn regressor<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        qd: Option<&Bound<'py, PyAny>>,
        qdd: Option<&Bound<'py, PyAny>>,
    ) -> Numbers<'py> {
        let ([q, qd, qdd], joints) = (self.three(q, qd, (qdd, "qdd"))?, self.joints());
        let columns = 10 * joints;
        either!(&self.arm, AnyArm, arm => over_rows(py, [&q, &qd, &qdd], &[joints, columns], |[q, qd, qdd], out| {
            for (link, block) in inverse_dynamics_regressor(arm, &q, &qd, &qdd).iter().enumerate() {
                for (row, column) in (0..joints).flat_map(|row| (0..10).map(move |column| (row, column))) {
                    out[row * columns + 10 * link + column] = block[(row, column)];
                }
            }
        }))
    }

    /// Inertial parameters of the links, `(10 joints,)`, in the order of the columns of [`Self::regressor`].
    #[getter]
    fn inertial_parameters<'py>(&self, py: Python<'py>) -> Numbers<'py> {
        either!(&self.arm, AnyArm, arm => {
            let numbers: Vec<f64> = arm.links.iter().flat_map(|link| link.parameters().as_slice().to_vec()).collect();
            let count = numbers.len();
            array(py, numbers, &[count])
        })
    }

    /// Rotor inertia reflected through the gears (kg m²), `(joints,)`.
    #[getter]
    fn rotor_inertia<'py>(&self, py: Python<'py>) -> Numbers<'py> {
        either!(&self.arm, AnyArm, arm => array(py, as_vec(&arm.rotor_inertia_kg_m2), &[self.joints()]))
    }

    fn __repr__(&self) -> String {
        format!("Arm({}, {} joints)", self.name(), self.joints())
    }
}

fn as_vec<const N: usize>(vector: &SVector<f64, N>) -> Vec<f64> {
    vector.as_slice().to_vec()
}
