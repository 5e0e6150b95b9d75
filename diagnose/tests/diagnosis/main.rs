//! Residuals, filters and answers of a diagnosis against closed forms, other programs and logs.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

mod both_sides;
mod closed_form;
mod creeping_arm;
mod loaded_arm;
mod next_experiment;
mod noisy_arm;
mod panda_gaz2019;
mod plain_fits;
#[path = "../../../tests/python_witness.rs"]
mod python_witness;
mod scipy_filters;
mod sticking_arm;
