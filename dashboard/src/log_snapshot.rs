//! A measured log to look at.

use std::path::{Path, PathBuf};

use tribo_experiments::files::{Model, ModelFile, YamlDocument};
use tribo_figure::{Signal, Signals};
use tribo_logs::{Quantity, RobotLog, read_log};

/// A log, and how to read it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LogSource {
    /// The log.
    pub path: PathBuf,
    /// The model it is held against; none is the bare Panda without friction.
    pub model: Option<PathBuf>,
    /// Whether the torque of the bare Panda is measured on the link side of the gears.
    pub link_side: bool,
}

impl LogSource {
    /// The model, by the name of its file.
    pub fn model_name(&self) -> String {
        self.model.as_ref().map_or("the bare Panda without friction".to_owned(), |path| path.display().to_string())
    }
}

/// A log with its channels ready to be drawn.
#[derive(Debug)]
pub struct LogSnapshot {
    /// Where it comes from.
    pub source: LogSource,
    /// The log.
    pub log: RobotLog,
    /// The model.
    pub model: Model<7>,
    /// Its channels.
    pub signals: Signals,
}

impl LogSnapshot {
    /// Reads a log.
    ///
    /// # Errors
    /// What is wrong with log or model, as a sentence.
    pub fn read(source: &LogSource) -> Result<Self, String> {
        let told = |error: &dyn std::fmt::Display| error.to_string();
        let model = model(source.model.as_deref(), source.link_side)?;
        let (log, _) = read_log(&source.path).map_err(|error| told(&error))?;
        if log.joints() != 7 {
            return Err(format!("{}: {} joints; the model has 7", source.path.display(), log.joints()));
        }
        let signals = signals(&log);
        Ok(Self { source: source.clone(), log, model, signals })
    }
}

/// The model file, or the bare Panda.
fn model(path: Option<&Path>, link_side: bool) -> Result<Model<7>, String> {
    let document = match path {
        Some(path) => YamlDocument::read(path).map_err(|error| error.to_string())?,
        None => {
            let side = if link_side { "link" } else { "motor" };
            let text = format!("schema: tribo.model/1\nrobot: panda\ntorque_side: {side}\n");
            YamlDocument::embedded("the bare Panda", &text)
        }
    };
    let file: ModelFile = document.parse().map_err(|error| error.to_string())?;
    file.validate().map_err(|error| document.explain(error).to_string())
}

/// A sensor's 24 bits.
#[allow(clippy::cast_possible_truncation)]
pub(crate) fn single(values: impl Iterator<Item = f64>) -> Vec<f32> {
    values.map(|value| value as f32).collect()
}

fn signals(log: &RobotLog) -> Signals {
    let mut channels = Vec::new();
    for quantity in Quantity::ALL {
        let label = match quantity {
            Quantity::Time => continue,
            Quantity::Position => "joint position [rad]",
            Quantity::Velocity => "joint velocity [rad/s]",
            Quantity::Torque => "measured joint torque [Nm]",
            Quantity::TorqueDesired => "commanded joint torque [Nm]",
            Quantity::LinkTorque => "link-side torque [Nm]",
            Quantity::MotorPosition => "motor position [rad]",
            Quantity::MotorVelocity => "motor velocity [rad/s]",
            Quantity::Temperature | Quantity::TemperatureAmbient => "temperature [degC]",
            Quantity::ExternalWrench => "reference wrench [N, Nm], base axes",
        };
        for (k, column) in log.quantity(quantity).into_iter().enumerate() {
            channels.push(Signal::new(quantity.column_name(k), label, single(column.iter().copied())));
        }
    }
    Signals::new(log.time_s.clone(), channels)
}
