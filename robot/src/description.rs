//! Arms from files, whatever format they are in.

use crate::SerialChain;
use crate::mjcf::{self, MjcfError};
use crate::urdf::{self, UrdfError};

/// Why a robot description is no serial arm.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DescriptionError {
    /// A URDF.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
    /// A model of MuJoCo.
    #[error(transparent)]
    Mjcf(#[from] MjcfError),
}

/// The arm in the text of a model of MuJoCo ([`mjcf::parse`]), or of what else is taken for a URDF ([`urdf::parse`]).
///
/// # Errors
/// What cannot be read or is not supported, with the element to blame.
pub fn parse_description(text: &str, base: Option<&str>, tip: Option<&str>) -> Result<SerialChain, DescriptionError> {
    match mjcf::is_mjcf(text) {
        true => Ok(mjcf::parse(text, base, tip)?),
        false => Ok(urdf::parse(text, base, tip)?),
    }
}
