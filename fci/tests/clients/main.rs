//! Clients that Tribo did not write drive the server: `franka-rs` in both versions, and programs
//! in Python.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod franka_rs;
mod mutations;
mod own_client;
mod python;
#[path = "../../../tests/python_witness.rs"]
mod python_witness;
mod served;
