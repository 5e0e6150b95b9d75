//! Why settings cannot be used.

use crate::{FieldError, FileError};

/// Why settings cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// A field is out of range.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// A file that the settings name cannot be used.
    #[error(transparent)]
    File(#[from] FileError),
}
