#![doc = include_str!("../README.md")]
//!
//! ```text
//! ṗ = τ + Cᵀ q̇ − g − (Jᵀ h + tau_f),   p = M q̇             [`MomentumObserver`] sees Jᵀ h + tau_f, 1/K late
//! Jᵀ h + tau_f − tau_f_hat = r         weighted least squares on r:             [`MomentumEstimator`]
//! Jᵀ h + tau_f + e = r                 tau_f in a band, prior on h, exactly:    [`QpEstimator`]
//! Jᵀ h + tau_f(q̇, T) = r              T from heat and free motion:             [`ThermalEstimator`]
//! Jᵀ h = T(Δθ) − T(Δθ₁)                Δθ motor less link angle, Δθ₁ learnt:     [`DoubleEncoderEstimator`]
//! ```
//!
//! All implement [`tribo_robot::WrenchEstimator`] and return the wrench with a confidence that follows from stated
//! noise: a covariance, and from the second 95 % limits as well, which widen where a joint sticks. What friction a joint
//! may have is a [`tribo_friction::FrictionBand`]; [`identify_band`] finds it in a log of contact-free strokes.
//!
//! h is the wrench by the robot on the environment, flange, base axes, moment then force; SI units.
//!
//! ```
//! use tribo_friction::{FrictionBand, JointBand};
//! use tribo_residual::{QpEstimator, QpSettings, diagonal_prior};
//! use tribo_robot::{ControlTerms, EstimatorInput, SensorFrame, WrenchEstimator, presets};
//!
//! let (arm, q) = (presets::panda(), presets::panda_ready_pose());
//! let frame = SensorFrame { time_s: 0.0, q, qd: q * 0.0, tau: q * 0.0, theta: None };
//! let terms = ControlTerms::at(&arm, &frame.q, &frame.qd);
//! let band = FrictionBand::new([JointBand::coulomb_viscous(0.6, 1.0, 3e-3, 0.1); 7])?;
//! let mut qp = QpEstimator::new(QpSettings { prior: diagonal_prior(15.0, 1.5), ..QpSettings::new(band) });
//! qp.reset(&frame, &terms);
//! let (none, command) = (q * 0.0, nalgebra::Vector6::zeros());
//! let estimate = qp.step(&EstimatorInput {
//!     frame: &frame,
//!     terms: &terms,
//!     tau_motor: &terms.gravity_nm,
//!     tau_friction: &none,
//!     acceleration_command: &command,
//!     dt_s: 1e-3,
//! });
//! // A standing arm that just carries itself: no wrench, and limits as wide as its friction allows.
//! assert!(estimate.wrench_base.force_n.norm() < 1e-9);
//! assert!(estimate.interval95().upper.force_n.z > 1.0);
//! # Ok::<(), tribo_friction::BandError>(())
//! ```
//!
//! Leaves out: friction that depends on load or position.

mod band;
mod damped_wrench;
mod double_encoder;
mod friction_left;
mod momentum;
mod qp;
mod thermal;

pub use band::{BandFitError, BandOf, JointBandFit, band_coverage, identify_band};
pub use double_encoder::{
    Approach, CalibrationError, DeflectionGp, DeflectionMean, DoubleEncoderEstimator, DoubleEncoderModel,
    DoubleEncoderSettings, LoadSample, LoadedRest, Rest, RestWrench, Rests, StiffnessCurve, ValidDoubleEncoder,
    calibrate,
};
pub use friction_left::FrictionLeft;
pub use momentum::{MomentumEstimator, MomentumObserver, MomentumSettings, OBSERVER_GAIN_RAD_S};
pub use qp::{
    BandObserver, BoxOutcome, BoxQp, BoxSolution, ForceEstimate, ForceLimit, ForcePrior, ForceProblem, ForceSolver,
    QpEstimator, QpSettings, Side, diagonal_prior, stack_opposed,
};
pub use thermal::{
    ContactGate, ContactSettings, FrictionSample, Innovation, ObserverGain, ObserverSettings, TemperatureObserver,
    ThermalEstimator, ThermalSettings, ThermalSettingsError,
};
