//! Arms from URDF, from MJCF and by name.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

mod mjcf;
mod mjcf_random;
mod odd_chains;
mod presets;
mod public_models;
#[path = "../../../tests/python_witness.rs"]
#[allow(dead_code, reason = "what tests of other crates ask for too")]
mod python_witness;
mod urdf;
mod witness;
