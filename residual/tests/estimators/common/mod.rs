//! Arithmetic, random numbers and a prescribed arm, shared by the tests of this crate.

#![allow(dead_code, reason = "each test binary uses its part")]

pub mod double_double;
pub mod prescribed;
pub mod published_instances;
pub mod reference_stream;
