//! The tool wrench along a log, with its confidence: what `tribo estimate` and the Python package tell.

use tribo_ekf::WrenchEkfSettings;
use tribo_friction::law::CoulombViscous;
use tribo_friction::{FrictionBand, FrictionModel, JointBand};
use tribo_logs::RobotLog;
use tribo_model::{ControllerModel, Model};
use tribo_residual::{BandFitError, OBSERVER_GAIN_RAD_S, identify_band};
use tribo_runtime::MeasuredWrench;

use crate::log_wrench::measured_wrench;
use crate::{
    AnyEstimator, Calibration, ContactPrior, EstimatorError, EstimatorName, LogWrench, WrenchSummary, band_of_model,
    wrench_on_log,
};

/// Runs wrench estimators over logs of an arm that is believed to be as `model` says.
///
/// ```text
/// band, tare, noise factor = of a log in free motion, if there is one      (else the band of the model's friction, no tare, 1)
/// h, sd, 95 % limits        = estimator(log; model, band) − tare, then the prior of contact
/// ```
#[derive(Clone, Debug)]
pub struct LogEstimator<const N: usize> {
    controller_model: ControllerModel<N>,
    smoothing_rad_s: f64,
    free: Option<FreeLog<N>>,
    contact: Option<ContactPrior>,
}

/// A log of strokes that nobody touches, and the friction band that it shows.
#[derive(Clone, Debug)]
struct FreeLog<const N: usize> {
    log: RobotLog,
    band: FrictionBand<N>,
}

/// What one estimator made of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct LogEstimate {
    /// The estimator.
    pub name: EstimatorName,
    /// What the log in free motion said of it, if there was one.
    pub calibration: Option<Calibration>,
    /// The wrench, one row per sample.
    pub wrench: LogWrench,
    /// Its figures.
    pub summary: WrenchSummary,
}

impl<const N: usize> LogEstimator<N> {
    /// Estimators that believe in `model` ([`ControllerModel::on_log`]) and have seen no log in free motion.
    pub fn new(model: &Model<N>) -> Self {
        Self {
            controller_model: ControllerModel::on_log(model),
            smoothing_rad_s: model.smoothing_rad_s,
            free: None,
            contact: None,
        }
    }

    /// What of the model estimators believe, and what they cannot use.
    pub fn controller_model(&self) -> &ControllerModel<N> {
        &self.controller_model
    }

    /// The same, with friction band, noise and tare from a log of strokes that nobody touches.
    ///
    /// # Errors
    /// A log without strokes that show the friction of each joint.
    pub fn calibrated_on(self, log: RobotLog) -> Result<Self, BandFitError> {
        let fits = identify_band(&log, &self.controller_model.arm, OBSERVER_GAIN_RAD_S)?;
        let band = FrictionBand::new(fits.map(|fit| fit.band))?;
        Ok(Self { free: Some(FreeLog { log, band }), ..self })
    }

    /// The same for an arm of which it is known how often somebody touches it.
    #[must_use]
    pub fn with_contact_prior(self, prior: ContactPrior) -> Self {
        Self { contact: Some(prior), ..self }
    }

    /// Runs one estimator over a log; `double_encoder` needs `theta` in the log.
    ///
    /// # Errors
    /// A model that the estimator cannot work with.
    pub fn estimate(&self, name: EstimatorName, log: &RobotLog) -> Result<LogEstimate, EstimatorError> {
        let calibration = self
            .free
            .as_ref()
            .map(|free| Calibration::of_free_stretch(|factor| self.raw(name, factor, &free.log)))
            .transpose()?;
        let used = calibration.unwrap_or_default();
        let mut wrench = self.raw(name, used.noise_factor, log)?;
        used.apply(&mut wrench);
        if let Some(prior) = &self.contact {
            prior.apply(&mut wrench);
        }
        Ok(LogEstimate { name, calibration, summary: wrench.summary(), wrench })
    }

    /// The estimator behind the sensors of a live arm, with what [`Self::estimate`] gives it, tare and prior of contact aside.
    ///
    /// # Errors
    /// A model that the estimator cannot work with.
    pub fn measured(&self, name: EstimatorName) -> Result<MeasuredWrench<N, AnyEstimator<N>>, EstimatorError> {
        Ok(measured_wrench(&self.controller_model, self.smoothing_rad_s, self.any(name, 1.0)?))
    }

    /// The wrench before tare and prior.
    #[inline(never)]
    fn raw(&self, name: EstimatorName, noise_factor: f64, log: &RobotLog) -> Result<LogWrench, EstimatorError> {
        let mut estimator = self.any(name, noise_factor)?;
        Ok(wrench_on_log(log, &self.controller_model, self.smoothing_rad_s, &mut estimator))
    }

    /// The estimator of a name.
    fn any(&self, name: EstimatorName, noise_factor: f64) -> Result<AnyEstimator<N>, EstimatorError> {
        let ControllerModel { arm, friction, .. } = &self.controller_model;
        let band = self.free.as_ref().map_or_else(|| band_of_model(friction), |free| free.band);
        // What the joints have today, at the temperature of today; the others take no more than its band.
        let friction = match &self.free {
            Some(free) if name == EstimatorName::Thermal => free.friction(),
            _ => *friction,
        };
        let ekf = WrenchEkfSettings::default();
        let stiffness = self.controller_model.joint_stiffness_nm_per_rad();
        AnyEstimator::with_confidence(name, ekf, arm, &friction, &band, noise_factor)?.on_gears(
            arm,
            stiffness,
            noise_factor,
        )
    }
}

impl<const N: usize> FreeLog<N> {
    /// Coulomb and viscous friction in the middle of the band, the same both ways.
    fn friction(&self) -> FrictionModel<N> {
        let law = |band: &JointBand| CoulombViscous {
            coulomb_nm: 0.5 * (band.coulomb_max_nm - band.coulomb_min_nm),
            viscous_nm_s_per_rad: band.viscous_nm_s_per_rad,
        };
        FrictionModel { joints: std::array::from_fn(|j| law(&self.band.joints()[j]).into()) }
    }
}
