#![doc = include_str!("../README.md")]
//!
//! ```text
//! campaign.yaml + journal.log → CampaignWatch → CampaignSnapshot → campaign_figures ┐
//! trials/NNNN.parquet         → TrialSnapshot → trial_figures, arm_figures          ├→ campaign_page, window
//! trials                      → Surrogate     → surrogate_figures                   ┘
//! ```
//!
//! Watching reads and never locks or writes: a campaign that is watched leaves the same bits. Everything that is not on
//! the disk (the run without compensation, and of older campaigns the reference costs) follows from the settings and is
//! computed anew.

mod any_tune;
pub mod arm_figures;
pub mod campaign_figures;
mod campaign_page;
mod campaign_snapshot;
mod loop_time;
mod surrogate;
pub mod surrogate_figures;
mod trial_columns;
pub mod trial_figures;
mod trial_snapshot;
mod watched_trial;
mod watcher;

pub(crate) use any_tune::read_trial;
pub use any_tune::{any_loop_times, uncompensated};
pub use campaign_page::{campaign_page, expected, headline, refresh_report, write_report};
pub use campaign_snapshot::CampaignSnapshot;
pub use loop_time::{LoopTimes, loop_times, quantile};
pub use surrogate::Surrogate;
pub use trial_columns::{TrialColumns, skeleton};
pub use trial_snapshot::TrialSnapshot;
pub use watched_trial::WatchedTrial;
pub use watcher::CampaignWatch;
