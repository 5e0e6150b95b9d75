//! Campaigns, their batches, ends and what is shown of them: one programme, so that it is built once.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod batch_of_trials;
mod batches;
mod clock_jumps;
mod early_stop;
mod good_trials;
mod path_scale;
mod standing_joints;
mod watch;
