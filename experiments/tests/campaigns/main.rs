//! Campaigns, their batches, ends, exports and what is shown of them: one programme, so that it is built once.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod batch_of_trials;
mod batches;
mod clock_jumps;
mod common;
mod early_stop;
mod export_bounds;
mod export_descriptions;
mod export_parameters;
mod export_sources;
mod standing_joints;
mod watch;
mod written_model;
