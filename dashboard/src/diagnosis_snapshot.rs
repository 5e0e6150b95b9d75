//! What the model gets wrong about a log, and how far the search for it is.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use tribo_diagnose::report::{ReportContext, html};
use tribo_diagnose::{DiagnoseSettings, Diagnosis, diagnose};
use tribo_files::write_atomic;
use tribo_model::AnyModel;

use crate::log_snapshot::LogSnapshot;

/// How far a diagnosis is.
#[derive(Debug, Default)]
pub struct Progress {
    stage: Mutex<String>,
    permille: AtomicU64,
    cancelled: AtomicBool,
}

impl Progress {
    /// Stage and part, 0 to 1.
    pub fn now(&self) -> (String, f32) {
        let stage = self.stage.lock().unwrap_or_else(PoisonError::into_inner).clone();
        (stage, self.permille.load(Ordering::Relaxed) as f32 / 1000.0)
    }

    /// Asks for an end.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Takes note of stage and part; false once an end has been asked for.
    fn report(&self, stage: &str, part: f64) -> bool {
        stage.clone_into(&mut self.stage.lock().unwrap_or_else(PoisonError::into_inner));
        self.permille.store((1000.0 * part.clamp(0.0, 1.0)) as u64, Ordering::Relaxed);
        !self.cancelled.load(Ordering::Relaxed)
    }
}

/// A diagnosis with the names of its log and its model.
#[derive(Clone, Debug)]
pub struct DiagnosisSnapshot {
    /// The log.
    pub log: PathBuf,
    /// The model.
    pub model: String,
    /// What was found.
    pub diagnosis: Diagnosis,
}

impl DiagnosisSnapshot {
    /// Holds a log against its model.
    ///
    /// # Errors
    /// Why there is no diagnosis, as a sentence.
    pub fn of(log: &LogSnapshot, progress: &Progress) -> Result<Self, String> {
        let settings = DiagnoseSettings { seed: 0, band_hz: None };
        let report = |stage: &str, part: f64| progress.report(stage, part);
        let logs = std::slice::from_ref(&log.log);
        let diagnosis = match &log.diagnosed {
            AnyModel::Six(model) => diagnose(logs, &model.to_nominal(), &[], &settings, &report),
            AnyModel::Seven(model) => diagnose(logs, &model.to_nominal(), &[], &settings, &report),
        };
        let diagnosis = diagnosis.map_err(|error| format!("{}: {error}", log.source.path.display()))?;
        Ok(Self { log: log.source.path.clone(), model: log.model_name(), diagnosis })
    }

    /// Writes the page of `tribo diagnose --report` under the name of the log.
    ///
    /// # Errors
    /// What could not be written, as a sentence.
    pub fn write_report(&self, directory: &Path) -> Result<PathBuf, String> {
        let stem = self.log.file_stem().map_or("log".into(), |stem| stem.to_string_lossy().into_owned());
        let path = directory.join(format!("{stem}-diagnosis.html"));
        let page = html(
            &self.diagnosis,
            &ReportContext {
                logs: vec![self.log.display().to_string()],
                model: self.model.clone(),
                program: format!("tribo {}", env!("CARGO_PKG_VERSION")),
                closed_loop: None,
            },
        );
        std::fs::create_dir_all(directory).map_err(|error| format!("{}: {error}", directory.display()))?;
        write_atomic(&path, |file| file.write_all(page.as_bytes())).map_err(|error| error.to_string())?;
        Ok(path)
    }
}
