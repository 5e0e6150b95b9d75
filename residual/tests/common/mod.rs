//! Arithmetic and random numbers shared by the tests of this crate.

pub mod double_double;
pub mod reference_stream;
