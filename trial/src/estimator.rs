//! Which wrench estimator, and with which settings.

use std::sync::Arc;

use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};
use tribo_ekf::{FrictionAwareEkf, WrenchEkf, WrenchEkfSettings, wrench_from_torque};
use tribo_friction::law::CoulombViscous;
use tribo_friction::thermal::ThermalError;
use tribo_friction::{FrictionBand, FrictionModel};
use tribo_residual::{
    BandOf, CalibrationError, DoubleEncoderEstimator, DoubleEncoderModel, DoubleEncoderSettings, FrictionLeft,
    MomentumEstimator, MomentumSettings, QpEstimator, QpSettings, ThermalEstimator, ThermalSettings,
    ThermalSettingsError, diagonal_prior,
};
use tribo_robot::presets::joint_stiffness_nm_per_rad;
use tribo_robot::{Arm, ControlTerms, EstimatorInput, SensorFrame, WrenchEstimate, WrenchEstimator};

use crate::Trial;

/// Name of a wrench estimator; whose wrench is the tuning cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EstimatorName {
    /// The augmented-state EKF.
    #[default]
    Ekf,
    /// The generalised-momentum observer.
    Momentum,
    /// The friction-band programme.
    Qp,
    /// The thermal virtual force sensor.
    Thermal,
    /// Two encoders per joint.
    DoubleEncoder,
}

impl EstimatorName {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 5] = [Self::Ekf, Self::Momentum, Self::Qp, Self::Thermal, Self::DoubleEncoder];

    /// The name in files and on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Ekf => "ekf",
            Self::Momentum => "momentum",
            Self::Qp => "qp",
            Self::Thermal => "thermal",
            Self::DoubleEncoder => "double_encoder",
        }
    }
}

/// Noise of a differentiated encoder (rad/s), where nobody says better.
pub const VELOCITY_SD_RAD_S: f64 = 2.9e-3;
/// Torque (Nm) that no law of friction holds, at rest.
const NOISE_SD_NM: f64 = 0.1;
/// Its growth with speed (s/rad).
const NOISE_GROWTH_S_PER_RAD: f64 = 5.0;
/// Dry friction (Nm) of a joint of which nothing is known, as the least squares on wrenches take it.
const UNKNOWN_COULOMB_NM: f64 = 0.6;
/// Prior of the wrench: force (N), moment (Nm).
const PRIOR: [f64; 2] = [8.0, 1.0];

/// The band of a believed friction model, with the noise of a Panda: 0.1 Nm at rest, five times that per rad/s more.
pub fn band_of_model<const N: usize>(friction: &FrictionModel<N>) -> FrictionBand<N> {
    FrictionBand::of_model(friction, VELOCITY_SD_RAD_S, NOISE_SD_NM, NOISE_GROWTH_S_PER_RAD)
}

/// An estimator of one of the names, in the tick of a trial or on a log.
#[derive(Clone, Debug)]
pub enum AnyEstimator<const N: usize> {
    /// The filter alone; its covariance knows nothing of friction.
    Ekf(Box<WrenchEkf>),
    /// The filter with a friction band in its covariance.
    FrictionAwareEkf(Box<FrictionAwareEkf<N>>),
    /// The momentum observer.
    Momentum(Box<MomentumEstimator<N>>),
    /// The friction-band programme.
    Qp(Box<QpEstimator<N>>),
    /// The thermal virtual force sensor.
    Thermal(Box<ThermalEstimator<N>>),
    /// Two encoders per joint.
    DoubleEncoder(Box<DoubleEncoderEstimator<N>>),
    /// What the motors say less what the gears say.
    FrictionLeft(Box<FrictionLeft<N>>),
}

/// Why there is no estimator.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EstimatorError {
    /// A friction law that a thermal joint cannot have.
    #[error(transparent)]
    Friction(#[from] ThermalError),
    /// A setting of the thermal estimator.
    #[error(transparent)]
    Thermal(#[from] ThermalSettingsError),
    /// A setting of the double-encoder estimator.
    #[error(transparent)]
    DoubleEncoder(#[from] CalibrationError),
}

impl<const N: usize> AnyEstimator<N> {
    /// The estimator whose wrench in free motion judges a compensator.
    ///
    /// Where a joint may stick, `momentum` and `qp` expect anything up to 0.6 Nm; at speed their bands are closed: what the
    /// compensator misses there is to be seen. `thermal` takes `friction`, what the compensator believes, as that of its joints
    /// at any temperature; `double_encoder` is [`FrictionLeft`] with the springs that the controller of the trial believes in, known to 2 %.
    ///
    /// # Errors
    /// A friction that the thermal estimator cannot have.
    #[inline(never)]
    pub fn for_tuning(
        name: EstimatorName,
        ekf: WrenchEkfSettings,
        trial: &Trial<N>,
        friction: &FrictionModel<N>,
    ) -> Result<Self, EstimatorError> {
        let unknown = CoulombViscous { coulomb_nm: UNKNOWN_COULOMB_NM, viscous_nm_s_per_rad: 0.0 };
        let band = band_of_model(&FrictionModel::uniform(unknown.into()));
        Ok(match name {
            EstimatorName::Ekf => Self::Ekf(Box::new(WrenchEkf::new(ekf))),
            EstimatorName::Momentum => Self::Momentum(Box::new(momentum(band, BandOf::Remainder))),
            EstimatorName::Qp => {
                let settings = QpSettings { band_of: BandOf::Remainder, limits: false, ..QpSettings::new(band) };
                Self::Qp(Box::new(QpEstimator::new(QpSettings {
                    prior: diagonal_prior(PRIOR[0], PRIOR[1]),
                    ..settings
                })))
            }
            EstimatorName::Thermal => Self::thermal(friction, 1.0)?,
            EstimatorName::DoubleEncoder => {
                let motors = momentum(band, BandOf::Remainder);
                Self::FrictionLeft(Box::new(FrictionLeft::new(
                    motors,
                    double_encoder(&trial.model, trial.gears_nm_per_rad, 1.0)?,
                )))
            }
        })
    }

    /// The estimator with its confidence, for joints whose friction is believed to be `friction` and lies in `band`;
    /// `noise_factor` multiplies the noise of the band, of the filter its own deviation, of the two encoders all there is: 1
    /// where no [`crate::Calibration`] says better.
    ///
    /// # Errors
    /// A friction that the thermal estimator cannot have.
    pub fn with_confidence(
        name: EstimatorName,
        ekf: WrenchEkfSettings,
        arm: &Arm<N>,
        friction: &FrictionModel<N>,
        band: &FrictionBand<N>,
        noise_factor: f64,
    ) -> Result<Self, EstimatorError> {
        let band = band.with_noise_times(noise_factor);
        Ok(match name {
            EstimatorName::Ekf => Self::FrictionAwareEkf(Box::new(FrictionAwareEkf::new(ekf, band, noise_factor))),
            EstimatorName::Momentum => Self::Momentum(Box::new(momentum(band, BandOf::Friction))),
            EstimatorName::Qp => {
                let prior = diagonal_prior(PRIOR[0], PRIOR[1]);
                Self::Qp(Box::new(QpEstimator::new(QpSettings { prior, ..QpSettings::new(band) })))
            }
            EstimatorName::Thermal => Self::thermal(friction, noise_factor)?,
            EstimatorName::DoubleEncoder => {
                Self::DoubleEncoder(Box::new(double_encoder(arm, joint_stiffness_nm_per_rad(arm), noise_factor)?))
            }
        })
    }

    /// The same on gears of this stiffness (Nm/rad), which two encoders read as torque; all but `double_encoder` know none.
    ///
    /// # Errors
    /// Springs that cannot be.
    pub fn on_gears(
        self,
        arm: &Arm<N>,
        stiffness_nm_per_rad: [f64; N],
        noise_factor: f64,
    ) -> Result<Self, EstimatorError> {
        Ok(match self {
            Self::DoubleEncoder(_) => {
                Self::DoubleEncoder(Box::new(double_encoder(arm, stiffness_nm_per_rad, noise_factor)?))
            }
            other => other,
        })
    }

    /// The same for an arm whose controller tells what it adds for friction (`tau_friction` of the input is that, not merely
    /// believed): `qp` then narrows the band of joints that came to rest without friction in hand. The others take it for
    /// granted.
    #[must_use]
    pub fn told_the_compensation(self) -> Self {
        match self {
            Self::Qp(qp) => Self::Qp(Box::new(QpEstimator::new(QpSettings { remembers_rest: true, ..*qp.settings() }))),
            other => other,
        }
    }

    #[inline(never)]
    fn thermal(friction: &FrictionModel<N>, noise_factor: f64) -> Result<Self, EstimatorError> {
        let mut settings = ThermalSettings::without_temperature(friction)?;
        settings.torque_sd_nm *= noise_factor;
        settings.velocity_sd_rad_s = SVector::repeat(VELOCITY_SD_RAD_S);
        settings.observer.friction_sd_nm *= noise_factor;
        settings.observer.model_error *= noise_factor;
        Ok(Self::Thermal(Box::new(ThermalEstimator::new(settings)?)))
    }

    /// How a torque (Nm) that nobody believes shows in the wrench `[moment; force]`, at low frequency, while the joints are
    /// at qd (rad/s) and `belief` (Nm) is compensated.
    pub fn wrench_from_torque(
        &self,
        terms: &ControlTerms<N>,
        qd: &SVector<f64, N>,
        belief: &SVector<f64, N>,
    ) -> Option<SMatrix<f64, 6, N>> {
        match self {
            Self::Ekf(_) | Self::FrictionAwareEkf(_) => wrench_from_torque(terms),
            Self::Momentum(momentum) => momentum.wrench_from_torque(terms, qd, belief, PERIOD_S),
            Self::Qp(qp) => qp.wrench_from_torque(terms, qd, PERIOD_S),
            Self::Thermal(thermal) => thermal.wrench_from_torque(terms, qd, belief, PERIOD_S),
            Self::FrictionLeft(left) => left.motors().wrench_from_torque(terms, qd, belief, PERIOD_S),
            // Friction is on the other side of the gears.
            Self::DoubleEncoder(_) => Some(SMatrix::zeros()),
        }
    }
}

fn momentum<const N: usize>(band: FrictionBand<N>, band_of: BandOf) -> MomentumEstimator<N> {
    let settings = MomentumSettings { band_of, ..MomentumSettings::new(band) };
    let velocity_sd_rad_s = SVector::repeat(VELOCITY_SD_RAD_S);
    MomentumEstimator::new(MomentumSettings { velocity_sd_rad_s, ..settings })
}

/// Two encoders on springs that nobody has calibrated: the assumed stiffness, to 2 %; all noise multiplied.
#[inline(never)]
fn double_encoder<const N: usize>(
    arm: &Arm<N>,
    stiffness_nm_per_rad: [f64; N],
    noise_factor: f64,
) -> Result<DoubleEncoderEstimator<N>, CalibrationError> {
    let mut settings = DoubleEncoderSettings::default();
    settings.encoder_sd_rad *= noise_factor;
    settings.velocity_sd_rad_s *= noise_factor;
    let stiffness_part = STIFFNESS_PART * noise_factor;
    let model = DoubleEncoderModel::nominal(arm, stiffness_nm_per_rad, stiffness_part, settings.validate()?);
    Ok(DoubleEncoderEstimator::new(Arc::new(model)))
}

/// Relative deviation of an assumed stiffness.
const STIFFNESS_PART: f64 = 0.02;
/// Period of the control loop (s).
const PERIOD_S: f64 = 1e-3;

impl<const N: usize> WrenchEstimator<N> for AnyEstimator<N> {
    fn reset(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        match self {
            Self::Ekf(ekf) => ekf.reset(frame, terms),
            Self::FrictionAwareEkf(ekf) => ekf.reset(frame, terms),
            Self::Momentum(momentum) => momentum.reset(frame, terms),
            Self::Qp(qp) => qp.reset(frame, terms),
            Self::Thermal(thermal) => thermal.reset(frame, terms),
            Self::DoubleEncoder(encoders) => encoders.reset(frame, terms),
            Self::FrictionLeft(left) => left.reset(frame, terms),
        }
    }

    #[inline(never)]
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate {
        match self {
            Self::Ekf(ekf) => ekf.step(input),
            Self::FrictionAwareEkf(ekf) => ekf.step(input),
            Self::Momentum(momentum) => momentum.step(input),
            Self::Qp(qp) => qp.step(input),
            Self::Thermal(thermal) => thermal.step(input),
            Self::DoubleEncoder(encoders) => encoders.step(input),
            Self::FrictionLeft(left) => left.step(input),
        }
    }

    fn delay_s(&self) -> f64 {
        match self {
            Self::Ekf(ekf) => WrenchEstimator::<N>::delay_s(ekf.as_ref()),
            Self::FrictionAwareEkf(ekf) => ekf.delay_s(),
            Self::Momentum(momentum) => momentum.delay_s(),
            Self::Qp(qp) => qp.delay_s(),
            Self::Thermal(thermal) => thermal.delay_s(),
            Self::DoubleEncoder(encoders) => encoders.delay_s(),
            Self::FrictionLeft(left) => left.delay_s(),
        }
    }
}
