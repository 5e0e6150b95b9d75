//! What the estimator believes: model, robot and compensator, from files that may change while it runs.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use tribo_friction::VelocitySource;
use tribo_model::{
    AnyModel, ConfigError, FieldError, FileError, Model, ModelFile, NotCancelled, SIGN_SMOOTHING_RAD_S, TunedFile,
    YamlDocument,
};
use tribo_runtime::MeasuredWrench;
use tribo_trial::{AnyEstimator, EstimatorError, EstimatorName, LogEstimator};

use crate::arguments::Listen;
use crate::failure::BadInput;

/// What the files say.
pub struct Parameters {
    /// The model file, or what stands for it.
    pub file: ModelFile,
    /// The model with the compensator's law as its friction.
    pub model: AnyModel,
}

impl Parameters {
    /// Reads the files.
    pub fn read(arguments: &Listen) -> anyhow::Result<Self> {
        let tuned = arguments.compensator.as_deref().map(tuned).transpose()?;
        let choice = arguments.of.choice()?;
        let (file, model) = match (choice.given()?, &tuned) {
            (Some(given), _) => given,
            (None, Some((_, tuned))) if arguments.of.robot.is_none() => {
                let bare = || ModelFile::bare(&tuned.robot, choice.torque_side, &[]);
                let file = tuned.model.clone().unwrap_or_else(bare);
                let model = file.validate_any().map_err(ConfigError::from)?;
                (file, model)
            }
            // The number of joints decides nothing where the robot has a name.
            (None, _) => choice.bare(Path::new(""), 7, &[])?,
        };
        let model = match (model, &tuned) {
            (model, None) => model,
            (AnyModel::Six(model), Some(tuned)) => AnyModel::Six(compensated(model, arguments, tuned)?),
            (AnyModel::Seven(model), Some(tuned)) => AnyModel::Seven(compensated(model, arguments, tuned)?),
        };
        Ok(Self { file, model })
    }

    /// The model of an arm with six joints.
    pub fn six(&self) -> Option<&Model<6>> {
        match &self.model {
            AnyModel::Six(model) => Some(model),
            AnyModel::Seven(_) => None,
        }
    }

    /// The model of an arm with seven joints.
    pub fn seven(&self) -> Option<&Model<7>> {
        match &self.model {
            AnyModel::Seven(model) => Some(model),
            AnyModel::Six(_) => None,
        }
    }

    /// Names of the joints: those given, else those of the URDF; of a preset none.
    pub fn joint_names<const N: usize>(&self, given: &[String]) -> Result<Option<[String; N]>, BadInput> {
        if given.is_empty() {
            return Ok(self.file.joint_names());
        }
        let twice = (1..given.len()).find(|&k| given[..k].contains(&given[k]));
        if let Some(k) = twice {
            return Err(BadInput(format!("--joints names {} twice", given[k])));
        }
        let names = given.to_vec().try_into();
        names.map(Some).map_err(|_| BadInput(format!("--joints has {} names; the arm has {N} joints", given.len())))
    }
}

fn tuned(path: &Path) -> Result<(YamlDocument, TunedFile), FileError> {
    let document = YamlDocument::read(path)?;
    let tuned = TunedFile::parse(&document)?;
    Ok((document, tuned))
}

/// The model with the law of the compensator as its friction.
fn compensated<const N: usize>(
    model: Model<N>,
    arguments: &Listen,
    (document, tuned): &(YamlDocument, TunedFile),
) -> anyhow::Result<Model<N>> {
    if tuned.joints() != N {
        let path = arguments.compensator.as_deref().unwrap_or(Path::new(""));
        let message = format!("{}: a compensator of {} joints; the model has {N}", path.display(), tuned.joints());
        return Err(BadInput(message).into());
    }
    let compensator = tuned.compensator::<N>().map_err(|error: FieldError| document.explain(error))?;
    // The sign of a measured velocity is smoothed over its noise, whatever the controller believed.
    let smoothing_rad_s = match compensator.source {
        VelocitySource::Measured => compensator.smoothing_rad_s,
        VelocitySource::Reference | VelocitySource::Hybrid => compensator.smoothing_rad_s.max(SIGN_SMOOTHING_RAD_S),
    };
    Ok(Model { friction: compensator.friction, smoothing_rad_s, ..model })
}

/// The estimator of a name behind the sensors of the arm, and what of the model it cannot use.
pub fn measured<const N: usize>(
    model: &Model<N>,
    name: EstimatorName,
) -> Result<(MeasuredWrench<N, AnyEstimator<N>>, Vec<NotCancelled>), EstimatorError> {
    let estimator = LogEstimator::new(model);
    Ok((estimator.measured(name)?, estimator.controller_model().not_cancelled.clone()))
}

/// Files that may change.
pub struct FileWatch {
    files: Vec<Watched>,
}

struct Watched {
    path: PathBuf,
    /// When it was changed and its length, as they were used.
    used: Option<Stamp>,
    /// The same at the last look: a file that is still being written is let alone.
    seen: Option<Stamp>,
}

type Stamp = (SystemTime, u64);

impl FileWatch {
    /// Watches files from now on.
    pub fn of<'p>(paths: impl Iterator<Item = &'p Path>) -> Self {
        let watched = |path: &Path| Watched { path: path.to_owned(), used: stamp(path), seen: stamp(path) };
        Self { files: paths.map(watched).collect() }
    }

    /// The name of a file that has changed and is the same since the last look, if there is one.
    pub fn changed(&mut self) -> Option<String> {
        let mut changed = None;
        for file in &mut self.files {
            let now = stamp(&file.path);
            let quiet = now == file.seen;
            file.seen = now;
            // One that is gone for a moment is being replaced.
            if quiet && now.is_some() && now != file.used {
                file.used = now;
                changed = Some(file.path.display().to_string());
            }
        }
        changed
    }
}

fn stamp(path: &Path) -> Option<Stamp> {
    let metadata = std::fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}
