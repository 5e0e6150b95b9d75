//! A measured log to look at.

use std::path::{Path, PathBuf};

use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_experiments::files::{Model, ModelFile, YamlDocument};
use tribo_experiments::{Believed, LogWrench, WrenchSummary, wrench_on_log};
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

/// A log with its channels ready to be drawn and the wrench estimated along it.
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
    /// Wrench along the log: six components, each with its lower and upper 95 % limit.
    pub wrench: Signals,
    /// Figures of the wrench.
    pub summary: WrenchSummary,
}

/// Components of a wrench in file order.
const COMPONENTS: [&str; 6] = ["force x", "force y", "force z", "moment x", "moment y", "moment z"];
/// 97.5 % quantile of the standard normal.
const Z95: f64 = 1.96;

impl LogSnapshot {
    /// Reads a log and estimates the wrench along it.
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
        let believed = Believed::on_log(&model);
        let mut estimator = WrenchEkf::new(WrenchEkfSettings::default());
        let wrench = wrench_on_log(&log, &believed, model.smoothing_rad_s, &mut estimator);
        let (signals, summary) = (signals(&log), wrench.summary());
        Ok(Self { source: source.clone(), log, model, signals, wrench: wrench_signals(&wrench), summary })
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
fn single(values: impl Iterator<Item = f64>) -> Vec<f32> {
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

fn wrench_signals(wrench: &LogWrench) -> Signals {
    let mut channels = Vec::new();
    for (k, name) in COMPONENTS.into_iter().enumerate() {
        let unit = if k < 3 { "N" } else { "Nm" };
        let label = format!("{name} [{unit}], base axes");
        for (what, sign) in [("estimate", 0.0), ("low", -Z95), ("high", Z95)] {
            let values = wrench.wrench.iter().zip(&wrench.sd).map(|(h, sd)| h[k] + sign * sd[k]);
            channels.push(Signal::new(format!("{what} {name}"), label.clone(), single(values)));
        }
    }
    Signals::new(wrench.time_s.clone(), channels)
}
