//! What a caller means by a model.

use std::path::PathBuf;

use pyo3::prelude::*;
use tribo_logs::RobotLog;

use crate::arm::PyArm;
use crate::failure::bad;
use crate::model::PyModel;

/// The model that somebody means by a `Model`, an `Arm`, the path of a model file, a preset or a robot description; of none, a
/// Panda where there are seven joints.
pub(crate) fn meant(given: Option<&Bound<'_, PyAny>>, logs: &[RobotLog]) -> PyResult<PyModel> {
    let Some(given) = given else {
        return match logs.first().map(|log| log.joints()) {
            Some(7) => PyModel::bare_robot("panda", "motor", None, None, logs),
            joints => Err(bad(format!("no model is given, and {} joints are no Panda's", joints.unwrap_or(0)))),
        };
    };
    if let Ok(model) = given.cast::<PyModel>() {
        return Ok(model.get().clone());
    }
    if let Ok(arm) = given.cast::<PyArm>() {
        return Ok(arm.get().model.clone());
    }
    let path: PathBuf =
        given.extract().map_err(|_| bad("model is none of Model, Arm, path of a model file, name of a robot"))?;
    let is_model = path.extension().is_some_and(|ending| ending == "yaml" || ending == "yml");
    if is_model { PyModel::read(path) } else { PyModel::bare_robot(&path.to_string_lossy(), "motor", None, None, logs) }
}
