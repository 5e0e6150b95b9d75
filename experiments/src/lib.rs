//! The numbered experiments: papers reproduced ([`reproduce`]), and logs with something hidden in them, on which the diagnosis is judged
//! ([`hidden_effects`]).
//!
//! Each experiment's settings, expected figures and reading are in the folder of its number beside this source.

pub mod hidden_effects;
pub mod reproduce;
