//! Every format that logs come in: whole, damaged, converted and back.

mod bad_csv;
mod bad_parquet;
mod common;
mod convert;
mod foreign;
mod golden;
mod kinova_gen3;
mod libfranka;
mod mcap;
mod panda_gaz;
#[path = "../../../tests/python_witness.rs"]
mod python_witness;
mod round_trip;
mod scipy_resampling;
