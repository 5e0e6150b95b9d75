//! A measured log to look at.

use std::path::PathBuf;

use nalgebra::{SVector, Vector3};
use tribo_figure::{Signal, Signals};
use tribo_logs::{Quantity, ReadOptions, RobotLog, read};
use tribo_model::{AnyModel, ModelChoice};
use tribo_watch::skeleton;

/// A log, and how to read it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogSource {
    /// The log.
    pub path: PathBuf,
    /// How its columns are read.
    pub read: ReadOptions,
    /// The model it is held against.
    pub model: ModelChoice,
}

/// A log with its channels ready to be drawn.
#[derive(Debug)]
pub struct LogSnapshot {
    /// Where it comes from.
    pub source: LogSource,
    /// The log.
    pub log: RobotLog,
    /// The model.
    pub model: AnyModel,
    /// The model that a diagnosis holds it against: the same, but for the rotors of a bare robot where torques of both
    /// sides of the gears were logged.
    pub diagnosed: AnyModel,
    /// Its channels.
    pub signals: Signals,
}

impl LogSnapshot {
    /// Reads a log.
    ///
    /// # Errors
    /// What is wrong with log or model, as a sentence.
    pub fn read(source: &LogSource) -> Result<Self, String> {
        let given = source.model.given().map_err(|error| error.to_string())?;
        let (log, _) = read(&source.path, &source.read).map_err(|error| error.to_string())?;
        let (model, diagnosed) = match given {
            Some((_, model)) => (model.clone(), model),
            None => {
                let bare = |two_sided: &[RobotLog]| {
                    let bare = source.model.bare(&source.path, log.joints(), two_sided);
                    bare.map(|(_, model)| model).map_err(|error| error.to_string())
                };
                (bare(&[])?, bare(std::slice::from_ref(&log))?)
            }
        };
        if log.joints() != model.joints() {
            let path = source.path.display();
            return Err(format!("{path}: {} joints; the model has {}", log.joints(), model.joints()));
        }
        let signals = signals(&log);
        Ok(Self { source: source.clone(), log, model, diagnosed, signals })
    }

    /// The arm at a row of the log, as points (m) from base to flange.
    pub fn skeleton(&self, row: usize) -> Vec<Vector3<f64>> {
        let q = |j: usize| self.log.q_rad[j][row];
        match &self.model {
            AnyModel::Six(model) => skeleton(&model.arm, &SVector::from_fn(|j, _| q(j))),
            AnyModel::Seven(model) => skeleton(&model.arm, &SVector::from_fn(|j, _| q(j))),
        }
    }

    /// What the model is called.
    pub fn model_name(&self) -> String {
        self.source.model.name(self.model.robot())
    }
}

/// A sensor's 24 bits.
#[allow(clippy::cast_possible_truncation)]
pub(crate) fn single(values: impl Iterator<Item = f64>) -> Vec<f32> {
    values.map(|value| value as f32).collect()
}

/// The label of a quantity's plot.
pub(crate) fn label(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Time => "time [s]",
        Quantity::Position => "joint position [rad]",
        Quantity::Velocity => "joint velocity [rad/s]",
        Quantity::Torque => "measured joint torque [Nm]",
        Quantity::TorqueDesired => "commanded joint torque [Nm]",
        Quantity::FrictionCompensation => "friction compensation [Nm]",
        Quantity::LinkTorque => "link-side torque [Nm]",
        Quantity::MotorPosition => "motor position [rad]",
        Quantity::MotorVelocity => "motor velocity [rad/s]",
        Quantity::Temperature | Quantity::TemperatureAmbient => "temperature [degC]",
        Quantity::ExternalWrench => "reference wrench [N, Nm], base axes",
    }
}

fn signals(log: &RobotLog) -> Signals {
    let mut channels = Vec::new();
    for quantity in Quantity::ALL.into_iter().filter(|quantity| *quantity != Quantity::Time) {
        for (k, column) in log.quantity(quantity).into_iter().enumerate() {
            channels.push(Signal::new(quantity.column_name(k), label(quantity), single(column.iter().copied())));
        }
    }
    Signals::new(log.time_s.clone(), channels)
}
