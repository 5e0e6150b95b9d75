//! The optimiser against other programs, benchmark functions and itself.

mod common;
#[path = "common/deformation.rs"]
mod deformation;
mod failures;
mod functions;
mod likelihood_reference;
mod noise;
mod properties;
#[path = "../../../tests/python_witness.rs"]
mod python_witness;
mod regret;
mod scikit_learn;
mod study;

use common::random_source;
