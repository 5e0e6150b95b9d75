//! What in a URDF cannot be used.

use crate::ChainError;

/// Why a URDF is no serial arm; names the joint or link to be mended.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UrdfError {
    /// Not XML, or not a URDF.
    #[error("not a URDF: {0}")]
    Syntax(String),
    /// A name that is given twice.
    #[error("{kind} `{name}` is there twice")]
    Twice {
        /// `link` or `joint`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// A joint whose parent or child is not among the links.
    #[error("joint `{joint}` refers to link `{link}`, which is not there")]
    NoSuchLink {
        /// The joint.
        joint: String,
        /// The link.
        link: String,
    },
    /// A name that would do something to a terminal.
    #[error("the name of {kind} `{name}` has a control character")]
    ControlCharacter {
        /// `robot`, `link` or `joint`.
        kind: &'static str,
        /// Its name, with the character written out.
        name: String,
    },
    /// A joint that joins a link to itself.
    #[error("joint `{joint}` has link `{link}` as parent and as child")]
    OwnParent {
        /// The joint.
        joint: String,
        /// The link.
        link: String,
    },
    /// A link that hangs on two joints: a closed loop.
    #[error("link `{link}` is the child of joints `{first}` and `{second}`; closed loops are not supported")]
    TwoParents {
        /// The link.
        link: String,
        /// One joint.
        first: String,
        /// The other.
        second: String,
    },
    /// No root, or more than one: a root is a link that is the child of no joint.
    #[error("{}", no_root(links))]
    NoRoot {
        /// The roots.
        links: Vec<String>,
    },
    /// A number of a joint that is missing or out of range.
    #[error("joint `{joint}`: {field} is {value}; allowed: {allowed}")]
    Joint {
        /// The joint.
        joint: String,
        /// The attribute.
        field: &'static str,
        /// Its value.
        value: String,
        /// The allowed range.
        allowed: &'static str,
    },
    /// A number of a link that is out of range.
    #[error("link `{link}`: {field} is {value}; allowed: {allowed}")]
    Link {
        /// The link.
        link: String,
        /// The attribute.
        field: &'static str,
        /// Its value.
        value: String,
        /// The allowed range.
        allowed: &'static str,
    },
    /// Xacro, the macro language that URDFs are written in.
    #[error("this is xacro, which has to be expanded first: xacro arm.urdf.xacro > arm.urdf")]
    Xacro,
    /// No way from a base to a tip.
    #[error(transparent)]
    Chain(#[from] ChainError),
}

/// Says what is wrong with the roots, and what to do.
fn no_root(roots: &[String]) -> String {
    if roots.is_empty() {
        "the URDF has no root link (one that is the child of no joint)".to_owned()
    } else {
        let (count, names) = (roots.len(), roots.join(", "));
        format!(
            "the URDF has {count} root links ({names}), each the child of no joint; name the arm's base as base_link (--base-link)"
        )
    }
}
