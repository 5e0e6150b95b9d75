//! A value outside its range.

/// A value outside its range, before the file and line are known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("field `{field}` is {value}; allowed: {allowed}")]
pub struct FieldError {
    /// Dotted path of the field.
    pub field: String,
    /// The value given.
    pub value: String,
    /// The allowed range.
    pub allowed: String,
}

impl FieldError {
    /// An error about `field`.
    pub fn new(field: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// The same error about a field of the file that `field` holds: `mass_kg` becomes `robot_content.mass_kg`.
    #[must_use]
    pub fn within(self, field: &str) -> Self {
        Self { field: format!("{field}.{}", self.field), ..self }
    }

    /// `Ok` if `value` lies in [low, high]; NaN never does.
    pub fn check(field: &str, value: f64, low: f64, high: f64) -> Result<(), Self> {
        if value >= low && value <= high { Ok(()) } else { Err(Self::new(field, value, format!("{low} to {high}"))) }
    }
}
