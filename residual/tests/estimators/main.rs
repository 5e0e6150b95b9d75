//! Every estimator of the wrench against closed forms, other programs and its own intervals.

mod band_on_logs;
mod box_qp;
mod common;
mod conformance;
mod coverage;
mod double_encoder;
mod force_reference;
mod momentum;
#[path = "../../../tests/python_witness.rs"]
mod python_witness;
mod quadratic_programmes;
mod thermal;
