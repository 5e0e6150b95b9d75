//! The command as users meet it: every story runs the programme `tribo`.

mod ask_and_tell;
mod bad_input;
mod bench;
mod bounds;
#[cfg(unix)]
mod campaign_directories;
mod commands;
mod common;
mod control_characters;
mod convert;
mod diagnose_refusals;
mod diagnose_story;
mod exports;
mod extended_models;
mod foreign_columns;
mod help_texts;
#[cfg(unix)]
mod kill_and_resume;
mod listen;
mod live;
mod mujoco_arm;
mod old_processor;
mod optuna_reads_the_journal;
mod other_arms;
#[path = "../../../tests/python_witness.rs"]
#[allow(dead_code, clippy::expect_used, reason = "no answer is asked for here")]
mod python_witness;
mod real_kinova_log;
mod real_panda_log;
mod reproduce;
mod same_bits;
#[cfg(unix)]
mod slurm_array;
mod storage_faults;
mod streams_and_signals;
mod study;
mod taking_back;
mod trial_logs;
#[cfg(unix)]
mod tutorials;
mod two_encoders;
mod wrong_logs;
