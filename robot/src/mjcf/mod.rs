//! Serial arms from models of MuJoCo (MJCF).
//!
//! ```text
//! T(parent, body)(q) = Trans(pos) Rot(quat|euler|…) Trans(anchor) Rot(axis, q − ref) Trans(−anchor)
//! ```
//!
//! A chain of 6 or 7 hinges from a base to a tip, each named by its body, the tip by a site too. Without names, the arm
//! goes from the body that carries the first joint to where, after 6 or 7 hinges, the tree branches (a gripper) or ends,
//! and the flange is the site `attachment_site` or `flange` there, else the frame of the last body. Bodies without joints
//! are welded to the one above; joints beside or beyond the chain are held where the file draws them.
//!
//! | MJCF | here |
//! |---|---|
//! | `<inertial>`, else geoms (primitives, density 1000 kg/m³) | [`crate::LinkInertia`] |
//! | `armature` of the joint, `gear² armature` of its actuators | rotor inertia |
//! | `frictionloss`; `damping` of the joint, `gear² damping` of its actuators | Coulomb (Nm), viscous friction [Nm s/rad] |
//! | `range` | position limits; five turns either way without |
//! | `forcerange` and `ctrlrange` times `gear`, `actuatorfrcrange` | torque limits ([`crate::SerialChain::arm`] says what is assumed without) |
//! | `<option gravity>` | gravity, in the axes of the base |
//!
//! Classes of `<default>`, `<frame>` and what `<compiler>` says of angles, limits and inertia are followed; dynamics equal
//! MuJoCo's to 1e-9. Leaves out: several joints in one body, slides and balls inside the chain, inertia of meshes (a body
//! with a mesh needs an `<inertial>`), `attach`, `replicate`, `settotalmass`, springs, tendons, equalities, contacts.

mod actuators;
mod bodies;
mod compiler;
mod element;
mod error;
mod geom;
mod include;
mod inertial;
mod joint;
mod limit;
mod model;
mod pose;

use roxmltree::Document;

pub use error::MjcfError;
pub use include::with_includes;

use crate::SerialChain;
use crate::chain::xml::within_bounds;

/// Whether a text is meant to be MJCF: the first element is `mujoco` or `mujocoinclude`.
pub fn is_mjcf(text: &str) -> bool {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    // Declarations and comments, which may hold anything, come before.
    let before = [("<!--", "-->"), ("<?", "?>"), ("<!", ">")];
    while let Some((_, end)) = before.iter().find(|(begin, _)| rest.starts_with(begin)) {
        rest = rest.find(end).map_or("", |at| rest[at + end.len()..].trim_start());
    }
    rest.starts_with("<mujoco")
}

/// The arm in the text of a model, which includes nothing any more ([`with_includes`]). `base` names a body, `tip` a body
/// or a site.
///
/// # Errors
/// What cannot be read or is not supported, with the element to blame.
pub fn parse(text: &str, base: Option<&str>, tip: Option<&str>) -> Result<SerialChain, MjcfError> {
    within_bounds(text).map_err(MjcfError::Syntax)?;
    let document = Document::parse(text).map_err(|error| MjcfError::Syntax(error.to_string()))?;
    let root = document.root_element();
    if !(root.has_tag_name("mujoco") || root.has_tag_name("mujocoinclude")) {
        let name = root.tag_name().name().escape_debug();
        return Err(MjcfError::Syntax(format!("the first element is <{name}>, not <mujoco>")));
    }
    if let Some(include) = document.descendants().find(|node| node.has_tag_name("include")) {
        let file = include.attribute("file").unwrap_or("").escape_debug().to_string();
        return Err(MjcfError::Include { file, message: "was not read".to_owned() });
    }
    model::Model::of(root)?.chain(base, tip)
}
