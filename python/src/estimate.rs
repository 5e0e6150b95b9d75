//! The tool wrench along a log.

use numpy::PyArrayDyn;
use pyo3::prelude::*;
use tribo_diagnose::{Diagnosable, recognise::recognise as with_model};
use tribo_logs::RobotLog;
use tribo_logs::recognise::{Use, recognise};
use tribo_model::{AnyModel, Model};
use tribo_regression::Nominal;
use tribo_trial::{ContactPrior, EstimatorName, LogEstimate, LogEstimator};

use crate::arm::either;
use crate::failure::{bad, raised};
use crate::interrupt::interruptible;
use crate::log::PyLog;
use crate::meant::meant;
use crate::remarks::{accept, warn};
use crate::rows::array;

type Numbers<'py> = Bound<'py, PyArrayDyn<f64>>;

/// Time, wrench, standard deviation, lower and upper limits, and the summary as JSON.
type Series<'py> = (Numbers<'py>, Numbers<'py>, Numbers<'py>, Numbers<'py>, Numbers<'py>, String);

/// The estimator of a name.
pub(crate) fn estimator_named(name: &str) -> PyResult<EstimatorName> {
    EstimatorName::ALL.into_iter().find(|known| known.as_str() == name).ok_or_else(|| {
        bad(format!("residual is {name}; allowed: {}", EstimatorName::ALL.map(EstimatorName::as_str).join(", ")))
    })
}

/// Estimates the wrench by the robot on the environment along a log.
#[pyfunction]
#[pyo3(signature = (log, model, residual, free, touched, anyway))]
pub(crate) fn estimate<'py>(
    py: Python<'py>,
    log: &Bound<'py, PyLog>,
    model: Option<Bound<'py, PyAny>>,
    residual: &str,
    free: Option<Bound<'py, PyLog>>,
    touched: Option<f64>,
    anyway: bool,
) -> PyResult<Series<'py>> {
    let name = estimator_named(residual)?;
    let model = meant(model.as_ref(), std::slice::from_ref(&log.get().log))?;
    let found = either!(&model.model, AnyModel, model => {
        run(py, model, name, log.get(), free.as_ref().map(|free| free.get()), touched, anyway)
    })?;
    let wrench = &found.wrench;
    let rows = wrench.time_s.len();
    let six = |values: &[[f64; 6]]| array(py, values.iter().flatten().copied().collect(), &[rows, 6]);
    let end = |k: usize| array(py, wrench.limits95.iter().flat_map(|limits| limits[k]).collect(), &[rows, 6]);
    Ok((
        array(py, wrench.time_s.clone(), &[rows])?,
        six(&wrench.wrench)?,
        six(&wrench.sd)?,
        end(0)?,
        end(1)?,
        found.summary.to_json().to_string(),
    ))
}

fn run<const N: usize>(
    py: Python<'_>,
    model: &Model<N>,
    name: EstimatorName,
    log: &PyLog,
    free: Option<&PyLog>,
    touched: Option<f64>,
    anyway: bool,
) -> PyResult<LogEstimate>
where
    Nominal<N>: Diagnosable,
{
    let accepted = |log: &PyLog, anyway: bool| -> PyResult<()> {
        if log.log.joints() != N {
            return Err(bad(format!("{}: {} joints; the model has {N}", log.name, log.log.joints())));
        }
        if name == EstimatorName::DoubleEncoder && log.log.theta_rad.is_none() {
            return Err(bad(format!("{}: no theta, which double_encoder needs", log.name)));
        }
        accept(py, &log.name, &recognise(&log.log), Use::Wrench, anyway)?;
        accept(py, &log.name, &with_model(&log.log, &model.to_nominal()), Use::Wrench, anyway)
    };
    accepted(log, anyway)?;
    free.map(|free| accepted(free, false)).transpose()?;
    let mut estimator = LogEstimator::new(model);
    let controller_model = estimator.controller_model();
    for left in &controller_model.not_cancelled {
        warn(py, &left.sentence(&controller_model.arm.joint_names))?;
    }
    if let Some(touched) = touched {
        estimator = estimator.with_contact_prior(ContactPrior::rarely(touched).map_err(raised)?);
    }
    let free: Option<RobotLog> = free.map(|free| free.log.clone());
    interruptible(py, |_| {
        let estimator = match free {
            Some(free) => estimator.calibrated_on(free).map_err(raised)?,
            None => estimator,
        };
        estimator.estimate(name, &log.log).map_err(raised)
    })?
}
