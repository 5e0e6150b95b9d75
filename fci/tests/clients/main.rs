//! Clients that Tribo did not write drive the server: `franka-rs` in both versions.

mod franka_rs;
mod mutations;
mod served;
