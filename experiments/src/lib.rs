//! Trials, cost, strategies, campaigns.
mod cost;
mod monitor;
mod trial;
mod trial_log;

pub use cost::{Cost, CostAccumulator};
pub use monitor::{AbortReason, PenaltyLimits, TrialMonitor};
pub use trial::{Trial, TrialOutcome, run_trial, run_trial_observed};
pub use trial_log::TrialLog;
