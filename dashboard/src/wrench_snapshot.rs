//! The wrench along a log, as one estimator sees it.

use tribo_ekf::WrenchEkfSettings;
use tribo_figure::{Signal, Signals};
use tribo_logs::RobotLog;
use tribo_model::{AnyModel, ControllerModel, Model};
use tribo_trial::{AnyEstimator, EstimatorName, LogWrench, WrenchSummary, band_of_model, wrench_on_log};

use crate::log_snapshot::{LogSnapshot, single};

/// What `tribo estimate --residual NAME` says about a log, ready to be drawn.
#[derive(Debug)]
pub struct WrenchSnapshot {
    /// The estimator.
    pub estimator: EstimatorName,
    /// Six components [N, Nm] by the robot on the environment, base axes, each followed by the lower and the upper end of
    /// its 95 % interval.
    pub signals: Signals,
    /// Figures over the settled samples.
    pub summary: WrenchSummary,
}

/// Components of a wrench in file order.
const COMPONENTS: [&str; 6] = ["force x", "force y", "force z", "moment x", "moment y", "moment z"];

/// The components with the labels of their plots.
pub(crate) fn components() -> impl Iterator<Item = (&'static str, String)> {
    let unit = |k: usize| if k < 3 { "N" } else { "Nm" };
    COMPONENTS.into_iter().enumerate().map(move |(k, name)| (name, format!("{name} [{}], base axes", unit(k))))
}

impl WrenchSnapshot {
    /// Runs an estimator along a log.
    ///
    /// # Errors
    /// Why this estimator cannot work on this log, as a sentence.
    pub fn of(log: &LogSnapshot, estimator: EstimatorName) -> Result<Self, String> {
        if let Some(why) = lacks(log, estimator) {
            return Err(why.to_owned());
        }
        let wrench = match &log.model {
            AnyModel::Six(model) => along(&log.log, model, estimator),
            AnyModel::Seven(model) => along(&log.log, model, estimator),
        }?;
        Ok(Self { estimator, signals: signals(&wrench), summary: wrench.summary() })
    }

    /// The wrench at a row of the log, force then moment [N, Nm]; none while the estimator settles.
    pub fn at(&self, row: usize) -> Option<[f64; 6]> {
        let component = |k: usize| self.signals.channels().get(3 * k)?.samples().get(row).map(|h| f64::from(*h));
        let wrench: [f64; 6] = std::array::from_fn(|k| component(k).unwrap_or(f64::NAN));
        wrench.iter().all(|h| h.is_finite()).then_some(wrench)
    }
}

fn along<const N: usize>(log: &RobotLog, model: &Model<N>, estimator: EstimatorName) -> Result<LogWrench, String> {
    let believed = ControllerModel::on_log(model);
    let (friction, settings) = (believed.friction, WrenchEkfSettings::default());
    let band = band_of_model(&friction);
    let mut running = AnyEstimator::with_confidence(estimator, settings, &believed.arm, &friction, &band, 1.0)
        .and_then(|running| running.on_gears(&believed.arm, believed.joint_stiffness_nm_per_rad(), 1.0))
        .map_err(|error| error.to_string())?;
    Ok(wrench_on_log(log, &believed, model.smoothing_rad_s, &mut running))
}

/// What an estimator needs and a log has not, as a sentence.
pub fn lacks(log: &LogSnapshot, estimator: EstimatorName) -> Option<&'static str> {
    (estimator == EstimatorName::DoubleEncoder && log.log.theta_rad.is_none())
        .then_some("double_encoder compares motor and link angles; this log has no motor positions (theta)")
}

fn signals(wrench: &LogWrench) -> Signals {
    let mut channels = Vec::new();
    for (k, (name, label)) in components().enumerate() {
        let estimate = single(wrench.wrench.iter().map(|h| h[k]));
        channels.push(Signal::new(format!("estimate {name}"), label.clone(), estimate));
        for (end, what) in ["low", "high"].into_iter().enumerate() {
            let limit = single(wrench.limits95.iter().map(|limits| limits[end][k]));
            channels.push(Signal::new(format!("{what} {name}"), label.clone(), limit));
        }
    }
    Signals::new(wrench.time_s.clone(), channels)
}
