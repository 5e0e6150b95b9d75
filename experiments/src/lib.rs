#![doc = include_str!("../README.md")]
//!
//! Each experiment's settings, expected figures and reading are in the folder of its number beside this source.

pub mod grey_box_ends;
pub mod hidden_effects;
pub mod reproduce;
