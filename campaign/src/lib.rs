#![doc = include_str!("../README.md")]
//!
//! [`Campaign`] is a series of trials ([`tribo_trial::Trial`]) with a journal from which a killed
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
mod campaign;
mod campaign_directory;
mod campaign_error;
mod chooser;
mod conclusion;
mod config;
mod early_stop;
mod friction_limit;
mod in_memory;
pub mod journal;
mod leftovers;
mod numbered_trial;
mod parameters;
mod recorded_settings;
mod reference_costs;
mod references_file;
mod report;
mod stop_below;
mod stored_logs;
pub mod strategy;
mod strategy_name;
pub mod study;
mod switched_off;
mod tuned;

pub use against_ekf::{AgainstEkf, against_ekf};
pub use ask_tell::{
    Asked, JudgeError, JudgedLog, Learnt, RecognisedTrial, SentTorque, Told, UserCampaign, UserTrials, judge_log,
    recognise_trial,
};
pub use batches::Batches;
pub use campaign::{Campaign, CampaignObserver, CampaignResult};
pub use campaign_directory::{Changes, explained, read_settings};
pub use campaign_error::CampaignError;
pub use conclusion::Conclusion;
pub use config::{AnyTune, Phases, TuneConfig, ValidTune};
pub use early_stop::EarlyStop;
pub use friction_limit::{Allowance, FrictionLimit};
pub use in_memory::{InMemory, run_in_memory};
pub use numbered_trial::{noise_seed, run_numbered};
pub use parameters::{Bounds, ParameterSpace, TunedLaw};
pub use recorded_settings::{check_unchanged, first_difference};
pub use reference_costs::{References, references, uncompensated_trial};
pub use stop_below::StopBelow;
pub use switched_off::switched_off_without;
pub use tribo_runtime::SETTLE_S;
pub use tuned::{finished_compensator, refresh_tuned, trial_compensator};
