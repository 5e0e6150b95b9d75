//! Identification and differentiation against other programs and simulated heat.

#[path = "../../../tests/python_witness.rs"]
mod python_witness;
mod scipy_savitzky_golay;
mod thermal_identification;
