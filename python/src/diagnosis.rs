//! What a model lacks.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use pyo3::prelude::*;
use pyo3::types::PyAny;
use tribo_diagnose::report::{Extras, ReportContext, document, finding_sentence, html, verdict_sentence};
use tribo_diagnose::{DiagnoseSettings, Diagnosis, diagnose_with_reference, recognise::recognise as with_model};
use tribo_files::write_atomic;
use tribo_logs::RobotLog;
use tribo_logs::recognise::{Use, recognise};
use tribo_model::{AnyModel, not_cancelled_of};
use tribo_regression::{DiagnoseError, Nominal};

use crate::arm::either;
use crate::failure::{bad, raised};
use crate::interrupt::interruptible;
use crate::log::PyLog;
use crate::meant::meant;
use crate::model::PyModel;
use crate::remarks::accept;

/// A diagnosis, with the model that it extends.
#[pyclass(name = "RawDiagnosis", module = "tribo._tribo", frozen)]
pub(crate) struct RawDiagnosis {
    diagnosis: Diagnosis,
    extended: PyModel,
    document: String,
    context: ReportContext,
}

#[pymethods]
impl RawDiagnosis {
    /// The document of `tribo diagnose --json`.
    fn document(&self) -> &str {
        &self.document
    }

    /// The verdict in a sentence.
    fn verdict_sentence(&self) -> String {
        verdict_sentence(&self.diagnosis)
    }

    /// A sentence for each finding.
    fn finding_sentences(&self) -> Vec<String> {
        let names = &self.diagnosis.joint_names;
        self.diagnosis.findings.iter().map(|finding| finding_sentence(finding, names)).collect()
    }

    /// Each joint as people read it: `panda_joint4 (3)`, or `joint 3` where nobody knows a name.
    fn joints(&self) -> Vec<String> {
        (0..self.diagnosis.joints.len()).map(|joint| self.diagnosis.joint_names.of(joint).to_string()).collect()
    }

    /// The model with all that was found.
    fn extended(&self) -> PyModel {
        self.extended.clone()
    }

    /// Writes the report, one HTML file.
    fn write_report(&self, path: PathBuf) -> PyResult<()> {
        let text = html(&self.diagnosis, &self.context);
        write_atomic(&path, |file| file.write_all(text.as_bytes())).map_err(raised)
    }
}

/// Logs, each accepted or refused.
fn accepted(
    py: Python<'_>,
    logs: &[Bound<'_, PyLog>],
    model: &PyModel,
    anyway: bool,
) -> PyResult<Vec<(String, RobotLog)>> {
    let mut taken = Vec::new();
    for log in logs {
        let PyLog { log, name, .. } = log.get();
        accept(py, name, &recognise(log), Use::Diagnosis, anyway)?;
        if log.joints() != model.model.joints() {
            let message = format!("{name}: {} joints; the model has {}", log.joints(), model.model.joints());
            return Err(bad(message));
        }
        let remarks = either!(&model.model, AnyModel, model => with_model(log, &model.to_nominal()));
        accept(py, name, &remarks, Use::Diagnosis, anyway)?;
        taken.push((name.clone(), log.clone()));
    }
    Ok(taken)
}

/// Finds what the model lacks to explain the logs.
#[pyfunction]
#[pyo3(signature = (logs, model, reference, validate, seed, band_hz, anyway, threads, progress))]
pub(crate) fn diagnose(
    py: Python<'_>,
    logs: Vec<Bound<'_, PyLog>>,
    model: Option<Bound<'_, PyAny>>,
    reference: Vec<Bound<'_, PyLog>>,
    validate: Vec<Bound<'_, PyLog>>,
    seed: u64,
    band_hz: Option<f64>,
    anyway: bool,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<RawDiagnosis> {
    if logs.is_empty() {
        return Err(bad("no log is given"));
    }
    if let Some(band_hz) = band_hz.filter(|band_hz| !(*band_hz > 0.0 && band_hz.is_finite())) {
        return Err(bad(format!("band_hz is {band_hz}; allowed: greater than 0")));
    }
    let given: Vec<&Bound<'_, PyLog>> = logs.iter().chain(&validate).chain(&reference).collect();
    let raw: Vec<RobotLog> = logs.iter().map(|log| log.get().log.clone()).collect();
    let model = meant(model.as_ref(), &raw)?;
    let (names, session): (Vec<String>, Vec<RobotLog>) = accepted(py, &logs, &model, anyway)?.into_iter().unzip();
    let unseen = accepted(py, &validate, &model, anyway)?;
    let unloaded: Vec<RobotLog> = accepted(py, &reference, &model, anyway)?.into_iter().map(|(_, log)| log).collect();
    let settings = DiagnoseSettings { seed, band_hz };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(raised)?;
    let result = interruptible(py, |stop| {
        let heard = |stage: &str, part: f64| {
            if let Some(progress) = &progress {
                // Whoever listens does not break the work.
                Python::attach(|py| {
                    progress.call1(py, (stage, part)).map(drop).unwrap_or_else(|error| error.print(py))
                });
            }
            !stop.load(Ordering::Relaxed)
        };
        pool.install(|| {
            either!(&model.model, AnyModel, model => {
                let nominal: Nominal<_> = model.to_nominal();
                diagnose_with_reference(&session, &unloaded, &nominal, &unseen, &settings, &heard)
            })
        })
    })?;
    let diagnosis = result.map_err(|error| match error {
        DiagnoseError::Cancelled => bad("stopped"),
        other => bad(format!("{}: {other}", names.join(", "))),
    })?;
    let extended = PyModel::of(model.file.diagnosed(&diagnosis), "extended model".to_owned())?;
    let not_cancelled = match (&model.model, &extended.model) {
        (AnyModel::Six(before), AnyModel::Six(after)) => not_cancelled_of(&diagnosis, before, after),
        (AnyModel::Seven(before), AnyModel::Seven(after)) => not_cancelled_of(&diagnosis, before, after),
        _ => Vec::new(),
    };
    let read_as = given.iter().map(|log| log.get().read_as()).collect();
    let document = document(&diagnosis, &Extras { not_cancelled, read_as, ..Extras::default() }).to_string();
    let context = ReportContext {
        logs: names,
        model: model.name,
        program: format!("tribo {}", env!("CARGO_PKG_VERSION")),
        closed_loop: None,
    };
    Ok(RawDiagnosis { diagnosis, extended, document, context })
}
