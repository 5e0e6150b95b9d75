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
//! that the fit has not seen. [`diagnose()`] asks all causes of [`CauseLabel`] what they explain of that residual, and answers with a
//! [`Diagnosis`]: verdict, findings with intervals and rivals, the next experiment (steps and files: `STEPS.md` of this crate).
//!
//! ```
//! use tribo_diagnose::{FrictionReport, FrictionSettings, ResidualSettings, TorqueResidual};
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
//! Leaves out: arms with other than six or seven revolute joints; causes that are not in [`CauseLabel`], which it calls unknown.

mod arm_scale;
mod band;
mod baseline;
mod blocks;
mod body;
mod cause;
mod cause_by_cause;
mod column;
mod columns;
mod conclusion;
mod confusable;
mod contact_window;
mod deflection;
mod diagnosable;
mod diagnosis;
mod distance;
mod engine;
mod error;
mod evaluated;
mod evidence;
mod extremes;
mod families;
pub mod filter;
mod finding;
mod fit;
mod found_arm;
mod friction_report;
mod golden_section;
mod held_out;
mod joint_columns;
mod joint_term;
mod judged;
mod label;
mod least_squares;
mod logged_motion;
mod model_residual;
mod motion;
mod next_experiment;
mod noise_level;
mod nominal;
mod parameters;
mod plots;
mod posture;
mod prior;
mod problem;
mod pruning;
mod push_window;
pub mod recognise;
mod regression_data;
mod regression_effects;
mod remarks;
mod repeats;
pub mod report;
mod residual_error;
mod ripple;
mod rivals;
mod search;
mod selection;
mod settings;
mod short_rests;
mod sign_width;
mod signal_chain;
mod significance;
mod simulated;
mod spd;
mod split;
mod stamps;
mod standstill;
mod sticking;
mod system;
mod tempering;
mod torque_residual;
mod unseen;
mod validation;
mod whitening;
mod written;

pub use blocks::{BlockSettings, Blocks, BlocksError, Split};
pub use diagnosable::{Diagnosable, diagnose, diagnose_with_reference};
pub use diagnosis::{
    Alternative, CrossJointPattern, Diagnosis, Finding, JointMisfit, Parameter, Plot, Rejected, Series, Unseen,
    Validation, Verdict,
};
pub use error::DiagnoseError;
pub use friction_report::{FrictionReport, FrictionSettings, HeldOut, HeldOutError, JointFitError, JointReport};
pub use label::{CauseLabel, Location};
pub use model_residual::ModelResidual;
pub use next_experiment::NextExperiment;
pub use noise_level::white_noise_sd;
pub use nominal::{Nominal, SIGN_SMOOTHING_RAD_S};
pub use residual_error::ResidualError;
pub use settings::DiagnoseSettings;
pub use signal_chain::{ResidualSettings, SignalChain};
pub use torque_residual::{MotionSample, TorqueResidual};
