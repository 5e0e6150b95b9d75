//! What a campaign tuned, as a file.

use std::path::Path;

use tribo_files::write_atomic;
use tribo_friction::Compensator;
use tribo_model::{FileError, TunedFile, read_text, to_yaml};

use crate::ValidTune;
use crate::strategy::{BestTrial, FinishedTrial};

/// The compensator of a trial, with parameters θ; nothing is said of its cost.
pub fn trial_compensator<const N: usize>(tune: &ValidTune<N>, trial: usize, theta: &[f64]) -> TunedFile {
    let compensator: Compensator<N> = Compensator::new(tune.space.friction(theta), tune.config.velocity);
    let model = tune.config.model_content.as_ref().or(tune.config.robot_content.as_ref()).cloned();
    TunedFile::of_trial(&tune.trial.model.name, (tune.config.seed, trial), &compensator, model)
}

/// The compensator of the best trial, which has parameters θ, with its cost and that of not compensating, where it is known.
pub fn finished_compensator<const N: usize>(
    tune: &ValidTune<N>,
    theta: &[f64],
    best: &BestTrial,
    uncompensated_cost: Option<f64>,
) -> TunedFile {
    let BestTrial { trial, cost, sd, .. } = *best;
    TunedFile { cost: Some(cost), cost_sd: sd, uncompensated_cost, ..trial_compensator(tune, trial, theta) }
}

/// Makes `tuned.yaml` what follows from the trials: the compensator of the best one; no file if there is none.
#[inline(never)]
pub(crate) fn write_tuned<const N: usize>(
    directory: &Path,
    tune: &ValidTune<N>,
    trials: &[FinishedTrial],
    best: Option<&BestTrial>,
    uncompensated_cost: Option<f64>,
) -> Result<(), FileError> {
    let best = best.and_then(|best| Some((best, trials.iter().find(|trial| trial.number == best.trial)?)));
    let tuned = best.map(|(best, trial)| finished_compensator(tune, &trial.theta, best, uncompensated_cost));
    refresh_tuned(directory, tuned.as_ref())
}

/// Makes `tuned.yaml` of a campaign this compensator, or removes it where there is none. A file that is right is left alone.
///
/// # Errors
/// A directory that cannot be written.
pub fn refresh_tuned(directory: &Path, tuned: Option<&TunedFile>) -> Result<(), FileError> {
    let path = directory.join("tuned.yaml");
    let Some(tuned) = tuned else {
        return match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(FileError::io(&path)(error)),
            _ => Ok(()),
        };
    };
    let text = to_yaml(tuned).map_err(FileError::io(&path))?;
    if read_text(&path).is_ok_and(|there| there == text) {
        return Ok(());
    }
    Ok(write_atomic(&path, |file| file.write_all(text.as_bytes()))?)
}
