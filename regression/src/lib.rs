#![doc = include_str!("../README.md")]
//!
//! ```text
//! residual_j = F (tau_measured,j − model_j(q, qd, qdd)),      residual_j ≈ F (Fc tanh(qd/ε) + Fv qd + offset)
//! ```
//!
//! F is one zero-phase low-pass, the same for the measured torque, the model and every regressor, so that filtered is
//! never compared with raw. [`TorqueResidual`] is the signal chain from a log to that equation, burst by burst;
//! [`Blocks`] cuts its samples into contiguous blocks with a dead margin between training and test;
//! [`FrictionReport`] says per joint what remains without friction, with a given law, and with a fitted one on samples
//! that the fit has not seen.
//! [`RegressionData`] adds the regressors of every cause, [`System`] whitens them.
//!
//! ```
//! use tribo_regression::{FrictionReport, FrictionSettings, ResidualSettings, TorqueResidual};
//! use tribo_logs::LogColumns;
//! use tribo_robot::presets;
//! let time_s: Vec<f64> = (0..12_000).map(|k| f64::from(k) * 1e-3).collect();
//! let of_time = |f: fn(f64) -> f64| vec![time_s.iter().map(|&t| f(t)).collect::<Vec<f64>>(); 7];
//! let (q_rad, dq_rad_s, tau_j_nm) = (of_time(|t| -0.5 - 0.4 * (2.0 * t).sin()), of_time(|_| 0.0), of_time(|_| 0.0));
//! let log = LogColumns { time_s, q_rad, dq_rad_s, tau_j_nm, ..LogColumns::default() }.validate()?;
//! let residual = TorqueResidual::of_log(&log, &presets::panda().link_side(), &ResidualSettings::default())?;
//! let report = FrictionReport::of(&residual, None, &FrictionSettings::default());
//! assert_eq!(report.joints.len(), 7); // measured torque zero: the residual of joint 2 is the weight of the arm
//! assert!(report.joints[1].rms_rigid_nm > 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Positions are the only motion signal used: qd and qdd are derivatives of smoothed q, which beats the logged dq.

mod blocks;
pub mod cause;
mod column;
pub mod contact_window;
pub mod deflection;
mod error;
pub mod evidence;
pub mod filter;
mod friction_report;
mod golden_section;
mod label;
pub mod least_squares;
mod logged_motion;
mod model_residual;
mod noise_level;
mod nominal;
mod push_window;
mod regression_data;
mod regression_effects;
mod repeats;
mod residual_error;
pub mod ripple;
mod short_rests;
mod signal_chain;
mod system;
mod torque_residual;
mod whitening;

pub use blocks::{BlockSettings, Blocks, BlocksError, Split};
pub use column::{Column, FineColumn, add_scaled, subtracted};
pub use error::DiagnoseError;
pub use friction_report::{FrictionReport, FrictionSettings, HeldOut, HeldOutError, JointFitError, JointReport};
pub use golden_section::golden_section;
pub use label::{CauseLabel, Location};
pub use logged_motion::LoggedMotion;
pub use model_residual::ModelResidual;
pub use noise_level::{rms, robust_sd};
pub use nominal::{Nominal, SIGN_SMOOTHING_RAD_S};
pub use push_window::PushWindow;
pub use regression_data::{RegressionData, Sample};
pub use repeats::without_repeats;
pub use residual_error::ResidualError;
pub use short_rests::bridge;
pub use signal_chain::{ResidualSettings, SignalChain};
pub use system::{EvaluatedColumns, System};
pub use torque_residual::{MotionSample, TorqueResidual, motion_of, smoothed};
