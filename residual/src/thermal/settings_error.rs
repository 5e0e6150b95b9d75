//! A setting of the thermal virtual sensor that cannot be.

use thiserror::Error;

/// A setting lies outside its range.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("thermal estimator: {field} is {value}; allowed: {allowed}")]
pub struct ThermalSettingsError {
    /// Name of the setting.
    pub field: &'static str,
    /// Its value.
    pub value: f64,
    /// Its range.
    pub allowed: &'static str,
}

impl ThermalSettingsError {
    pub(super) fn check(field: &'static str, value: f64, ok: bool, allowed: &'static str) -> Result<(), Self> {
        if ok && value.is_finite() { Ok(()) } else { Err(Self { field, value, allowed }) }
    }
}
