//! Tuning campaigns on the simulated arm.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use pyo3::prelude::*;
use serde_json::Value;
use tribo_campaign::{
    Campaign, CampaignError, CampaignObserver, CampaignResult, InMemory, TuneConfig, ValidTune, finished_compensator,
    references, run_in_memory,
};
use tribo_cli::now;
use tribo_model::TunedFile;
use tribo_watch::write_report;

use crate::arm::either;
use crate::compensator::PyCompensator;
use crate::failure::{bad, raised};
use crate::interrupt::interruptible;

/// Puts settings (JSON) over others; whether they say how many trials there are to be.
///
/// # Errors
/// A field that there is not, or a value that it cannot have.
pub(crate) fn settings(config: &mut TuneConfig, given: &str) -> PyResult<bool> {
    let given: Value = serde_json::from_str(given).map_err(raised)?;
    let mut all = serde_json::to_value(&*config).map_err(raised)?;
    let (Some(fields), Some(all_fields)) = (given.as_object(), all.as_object_mut()) else {
        return Err(bad("settings are no dictionary"));
    };
    for (name, value) in fields {
        all_fields.insert(name.clone(), value.clone());
    }
    *config = serde_json::from_value(all).map_err(|error| bad(format!("settings: {error}")))?;
    Ok(fields.contains_key("trials"))
}

/// Stops where somebody pressed Ctrl-C.
struct Observer<'a> {
    stop: &'a AtomicBool,
}

impl CampaignObserver for Observer<'_> {
    fn stop_requested(&mut self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Tunes the compensator of a simulated arm: in memory, or in a directory as `tribo tune` does. Gives the document of `tribo tune --json`
/// and the best compensator.
#[pyfunction]
#[pyo3(signature = (given, out, threads))]
pub(crate) fn tune(
    py: Python<'_>,
    given: &str,
    out: Option<PathBuf>,
    threads: usize,
) -> PyResult<(String, Option<PyCompensator>)> {
    let mut config = TuneConfig::default();
    settings(&mut config, given)?;
    let valid = config.validate_any().map_err(raised)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(raised)?;
    let (document, tuned) = interruptible(py, |stop| {
        pool.install(|| {
            use tribo_campaign::AnyTune;
            either!(valid, AnyTune, tune => tuned(tune, out.as_ref(), stop))
        })
    })?
    .map_err(raised)?;
    Ok((document, tuned.map(PyCompensator::of).transpose()?))
}

fn tuned<const N: usize>(
    tune: ValidTune<N>,
    out: Option<&PathBuf>,
    stop: &AtomicBool,
) -> Result<(String, Option<TunedFile>), CampaignError> {
    let started = Instant::now();
    let mut at_end = tune.clone();
    let result = match out {
        Some(directory) => {
            let result = Campaign::create(directory, tune, now)?.run(&mut Observer { stop })?;
            write_report(directory, None, false)?;
            result
        }
        None => {
            let references = references(&tune)?;
            let (config, truth) = (tune.config.clone(), tune.true_parameters());
            let InMemory { trials, conclusion, space, law_change, early_stop } = run_in_memory(&tune)?;
            CampaignResult { config, space, truth, trials, conclusion, references, law_change, early_stop }
        }
    };
    at_end.space = result.space.clone();
    let best = result.conclusion.best.as_ref();
    let compensator = best.map(|best| {
        finished_compensator(&at_end, &result.trials[best.trial].theta, best, Some(result.references.uncompensated))
    });
    Ok((result.to_json(None, started.elapsed().as_secs_f64()).to_string(), compensator))
}
