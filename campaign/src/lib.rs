#![doc = include_str!("../README.md")]
//!
//! ```text
//! J = Σ_i (max |h_i| + mean |h_i|) + Γ        h: the wrench estimated in free motion, i.e. friction not compensated
//! ```
//!
//! [`Trial`] is one run of the loop on the simulated arm, [`Campaign`] a series of them with a journal from which a killed
//! run goes on. A [`strategy::Strategy`] is a pure function of the trials before, so results do not depend on threads,
//! kills or the clock.
//!
//! ```
//! use tribo_campaign::{TuneConfig, run_numbered};
//!
//! let tune = TuneConfig::default().validate::<7>()?;
//! let outcome = run_numbered(&tune, 0, &tune.space.zero())?;
//! assert!(outcome.aborted.is_none());
//! assert!((outcome.cost.total() - 24.2).abs() < 0.5); // the cost of not compensating friction
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod against_ekf;
mod any_tune;
mod ask_tell;
mod batches;
mod calibration;
mod campaign;
mod campaign_directory;
mod campaign_error;
mod chooser;
mod closed_loop_gain;
mod conclusion;
mod config;
mod contact_prior;
mod cost;
mod early_stop;
mod estimator;
mod follow;
mod friction_limit;
mod in_memory;
pub mod journal;
mod leftovers;
mod log_estimator;
mod log_recorder;
mod log_wrench;
mod monitor;
mod numbered_trial;
mod parameters;
mod published_gaz;
mod recorded_settings;
mod reference_costs;
mod references_file;
mod report;
pub mod scenario;
mod simulate;
mod stop_below;
mod stored_logs;
pub mod strategy;
mod strategy_name;
pub mod study;
mod switched_off;
mod transmission_friction;
mod trial;
mod trial_log;
mod trial_store;
mod tuned;

pub use against_ekf::{AgainstEkf, against_ekf};
pub use ask_tell::{
    Asked, JudgeError, JudgedLog, Learnt, RecognisedTrial, SentTorque, Told, UserCampaign, UserTrials, judge_log,
    recognise_trial,
};
pub use batches::Batches;
pub use calibration::Calibration;
pub use campaign::{Campaign, CampaignObserver, CampaignResult};
pub use campaign_directory::{Changes, explained, read_settings};
pub use campaign_error::CampaignError;
pub use closed_loop_gain::{ClosedLoopGain, closed_loop_gain};
pub use conclusion::Conclusion;
pub use config::{AnyTune, Phases, TuneConfig, ValidTune};
pub use contact_prior::ContactPrior;
pub use cost::{Cost, CostAccumulator, CostMeasure, CostName};
pub use early_stop::EarlyStop;
pub use estimator::{AnyEstimator, EstimatorError, EstimatorName, VELOCITY_SD_RAD_S, band_of_model};
pub use follow::{Followed, follow, follow_on};
pub use friction_limit::{Allowance, FrictionLimit};
pub use in_memory::{InMemory, run_in_memory};
pub use log_estimator::{LogEstimate, LogEstimator};
pub use log_wrench::{LogWrench, ReferenceErrors, WrenchSummary, wrench_on_log};
pub use monitor::{AbortReason, PenaltyLimits, TrialMonitor};
pub use numbered_trial::{noise_seed, run_numbered};
pub use parameters::{Bounds, ParameterSpace, TunedLaw};
pub use recorded_settings::{check_unchanged, first_difference};
pub use reference_costs::{References, references, uncompensated_trial};
pub use simulate::{record_trial, simulate_log};
pub use stop_below::StopBelow;
pub use switched_off::switched_off_without;
pub use transmission_friction::{TransmissionError, TransmissionFriction, TransmissionJoint};
pub use trial::{Trial, TrialOutcome, run_trial, run_trial_observed, run_trial_on};
pub use trial_log::TrialLog;
pub use trial_store::{read_own_trial_log, read_trial_log, trial_log_path, write_trial_log};
pub use tribo_runtime::SETTLE_S;
pub use tuned::{finished_compensator, refresh_tuned, trial_compensator};
