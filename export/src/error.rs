//! Why a compensator cannot be exported.

use tribo_model::FieldError;

/// What stands in the way of an export; each variant says what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// A field of the tuned parameters that is out of range.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The arm of the tuned parameters is not in the file.
    #[error(
        "robot `{robot}` is no preset and the file has no `model`: its arm is not known. Formats yaml, json, ros2, c and rust \
         need none; else tune with this version"
    )]
    UnknownArm {
        /// Name of the arm.
        robot: String,
    },
    /// A robot without a campaign, in a format that is about a compensator.
    #[error(
        "{format} is about a tuned compensator, and a robot has none: export a campaign or a tuned.yaml, or as urdf or mjcf"
    )]
    NothingTuned {
        /// Name of the format.
        format: &'static str,
    },
    /// A name that the target would not take.
    #[error("--name is `{name}`; allowed: {allowed}")]
    Name {
        /// The name.
        name: String,
        /// What the target takes.
        allowed: &'static str,
    },
    /// A value that the format's writer refused.
    #[error("serialising the parameters: {0}")]
    Serialise(String),
    /// Something that the target has no words for, and without which the export would mislead.
    #[error("joint {joint}: {what}, which {format} cannot represent: {why}")]
    Joint {
        /// Joint, from 0.
        joint: usize,
        /// What it is, with its value.
        what: String,
        /// Name of the format.
        format: &'static str,
        /// The format's range.
        why: &'static str,
    },
}
