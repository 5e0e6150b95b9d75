//! What is asked of every reader, whatever the bytes: one function per format, for the fuzzer and for the gate.
//!
//! ```text
//! bytes  --reader-->  an error that names the input  |  a value that holds its own law and, written and read again, is the same
//! ```
//!
//! Never a panic, an abort, an endless loop or memory out of proportion to the input. `fuzz/` drives these functions with
//! libFuzzer, `tests/fuzz_inputs/main.rs` with the seeds, with what was found before, and with small damages to both.
//! Readers that want files get them in memory where the library offers that, else in a directory without a disk.

#![allow(clippy::panic, reason = "a broken promise is a panic: that is what the fuzzer looks for")]

mod document;
#[path = "../../logs/tests/formats/common/ros2.rs"]
#[allow(
    missing_docs,
    dead_code,
    clippy::unwrap_used,
    clippy::new_without_default,
    reason = "the recorder of the tests of `logs`"
)]
pub mod recorder;
mod robot_log;
mod scratch;

pub mod arguments;
pub mod campaign_journal;
pub mod column_map;
pub mod early_stop_yaml;
pub mod expected_json;
pub mod experiment_yaml;
pub mod joint_state;
pub mod journal;
pub mod mcap_message;
pub mod mjcf;
pub mod model_yaml;
pub mod panda_gaz_log;
pub mod references_yaml;
pub mod study_cell_json;
pub mod study_yaml;
pub mod told_trial;
pub mod trajectory_yaml;
pub mod tune_yaml;
pub mod tuned_yaml;
pub mod urdf;

pub use robot_log::{bag_log, csv_log, foreign_log, mcap_log, parquet_log};

/// A format under its name: the folder of its seeds and of its regressions, and the fuzz target.
pub type Target = (&'static str, fn(&[u8]));

/// Every target.
pub const TARGETS: [Target; 27] = [
    ("arguments", arguments::check),
    ("bag_log", bag_log),
    ("campaign_journal", campaign_journal::check),
    ("column_map", column_map::check),
    ("csv_log", csv_log),
    ("early_stop_yaml", early_stop_yaml::check),
    ("expected_json", expected_json::check),
    ("experiment_yaml", experiment_yaml::check),
    ("foreign_log", foreign_log),
    ("joint_state", joint_state::check),
    ("journal", journal::check),
    ("kinova_gen3_log", csv_log),
    ("libfranka_log", csv_log),
    ("mcap_log", mcap_log),
    ("mcap_message", mcap_message::check),
    ("mjcf", mjcf::check),
    ("model_yaml", model_yaml::check),
    ("panda_gaz_log", panda_gaz_log::check),
    ("parquet_log", parquet_log),
    ("references_yaml", references_yaml::check),
    ("study_cell_json", study_cell_json::check),
    ("study_yaml", study_yaml::check),
    ("told_trial", told_trial::check),
    ("trajectory_yaml", trajectory_yaml::check),
    ("tune_yaml", tune_yaml::check),
    ("tuned_yaml", tuned_yaml::check),
    ("urdf", urdf::check),
];
