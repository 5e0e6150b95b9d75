#![doc = include_str!("../README.md")]
//!
//! ```text
//! J = Σ_i (max |h_i| + mean |h_i|) + Γ        h: the wrench estimated in free motion, i.e. friction not compensated
//! ```
//!
//! [`Trial`] is one run of the loop on the simulated arm; [`run_trial_on`] runs it on any `Plant`. The scenario, the estimator by
//! name and the measure of the cost are values with checked files behind them ([`scenario`], [`EstimatorName`], [`CostMeasure`]).
//! [`wrench_on_log`] puts the same estimators behind a recorded log. Which trial comes next is the matter of `tribo-campaign`.

mod calibration;
mod closed_loop_gain;
mod contact_prior;
mod cost;
mod estimator;
mod follow;
mod log_estimator;
mod log_recorder;
mod log_wrench;
mod monitor;
mod published_gaz;
pub mod scenario;
mod simulate;
mod transmission_friction;
mod trial;
mod trial_log;
mod trial_store;

pub use calibration::Calibration;
pub use closed_loop_gain::{ClosedLoopGain, closed_loop_gain};
pub use contact_prior::ContactPrior;
pub use cost::{Cost, CostAccumulator, CostMeasure, CostName};
pub use estimator::{AnyEstimator, EstimatorError, EstimatorName, VELOCITY_SD_RAD_S, band_of_model};
pub use follow::{Followed, follow, follow_on};
pub use log_estimator::{LogEstimate, LogEstimator};
pub use log_wrench::{LogWrench, ReferenceErrors, WrenchSummary, frame_at, wrench_on_log};
pub use monitor::{AbortReason, PenaltyLimits, TrialMonitor};
pub use published_gaz::published_gaz;
pub use simulate::{record_trial, simulate_log};
pub use transmission_friction::{TransmissionError, TransmissionFriction, TransmissionJoint};
pub use trial::{Trial, TrialOutcome, run_trial, run_trial_observed, run_trial_on};
pub use trial_log::TrialLog;
pub use trial_store::{read_own_trial_log, read_trial_log, trial_log_path, write_trial_log};
