//! A number outside its range.

use thiserror::Error;

/// A number of a thermal friction model lies outside its range.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("thermal friction: {field} is {value}; allowed: {allowed}")]
pub struct ThermalError {
    /// Name of the field.
    pub field: &'static str,
    /// Its value.
    pub value: f64,
    /// Its range.
    pub allowed: &'static str,
}

impl ThermalError {
    /// `value` must be finite and satisfy `ok`.
    pub(super) fn check(field: &'static str, value: f64, ok: bool, allowed: &'static str) -> Result<(), Self> {
        if ok && value.is_finite() { Ok(()) } else { Err(Self { field, value, allowed }) }
    }
}
