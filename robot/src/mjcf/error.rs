//! What in a model of MuJoCo cannot be used.

use crate::ChainError;

/// Why a model of MuJoCo is no serial arm; names the element to be mended.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MjcfError {
    /// Not XML, or not MJCF.
    #[error("not MJCF: {0}")]
    Syntax(String),
    /// A file that an `<include>` names.
    #[error("<include file=\"{file}\"/>: {message}")]
    Include {
        /// The file.
        file: String,
        /// What is wrong with it.
        message: String,
    },
    /// An attribute that is missing or out of range.
    #[error("{element}: {attribute} is {value}; allowed: {allowed}")]
    Attribute {
        /// The element, and whose it is.
        element: String,
        /// The attribute.
        attribute: &'static str,
        /// Its value.
        value: String,
        /// The allowed range.
        allowed: &'static str,
    },
    /// Something that is not read, where it matters.
    #[error("{what} is not supported: {why}")]
    NotSupported {
        /// What.
        what: String,
        /// Why, or what to do.
        why: &'static str,
    },
    /// A body whose inertia is that of a mesh.
    #[error(
        "the inertia of body `{body}` would come from the mesh of {geom}, which is not read: give the body an <inertial> \
         (MuJoCo writes it with <compiler saveinertial=\"true\"/> and mj_saveLastXML)"
    )]
    Mesh {
        /// The geom.
        geom: String,
        /// The body.
        body: String,
    },
    /// A name that is given twice.
    #[error("{kind} `{name}` is there twice")]
    Twice {
        /// `body` or `joint`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// A name that would do something to a terminal.
    #[error("the {kind} name `{name}` has a control character")]
    ControlCharacter {
        /// Whose name.
        kind: &'static str,
        /// The name, with the character written out.
        name: String,
    },
    /// No way from a base to a tip.
    #[error(transparent)]
    Chain(#[from] ChainError),
}
