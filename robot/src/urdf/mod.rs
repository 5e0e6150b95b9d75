//! Serial arms from URDF, and back.
//!
//! ```text
//! T(parent, child)(q) = Trans(xyz) RotZ(yaw) RotY(pitch) RotX(roll) Rot(axis, q)
//! ```
//!
//! A chain of 6 or 7 revolute or continuous joints from a base link to a tip link. Links joined by fixed joints are
//! welded into one body, every axis is turned onto z, and the frame of the tip becomes the flange. `<dynamics>` is read as
//! `damping` (viscous [Nm s/rad]) and `friction` (Coulomb (Nm)). Where nobody names the tip, the arm ends where the tree
//! branches after 6 or 7 joints (a gripper), or at the last link, or at `tool0` where frames branch. Joints beside or
//! beyond the chain, whatever their kind, are held where the file draws them, at 0. Effort or velocity of 0 is a limit that
//! nobody knows ([`crate::SerialChain::arm`] says what is assumed).
//!
//! Leaves out: prismatic, floating, planar, spherical and mimic joints inside the chain, geometry. URDF knows neither
//! rotor inertia (zero here) nor torque rates (1000 Nm/s here); gravity is 9.81 m/s² along −z of the root link.

mod body;
mod error;
mod joint;
mod origin;
mod tree;
mod write;

use nalgebra::Vector3;

pub use error::UrdfError;
pub use write::to_urdf;

use crate::SerialChain;
use crate::chain::frame::same;
use crate::chain::{Source, welded_chain};

/// Standard gravity of the presets [m/s²].
const GRAVITY_M_S2: f64 = 9.81;

/// The arm in the text of a URDF. `base` and `tip` name links; without, the arm goes from the root to the only end.
///
/// # Errors
/// What cannot be read or is not supported, with the joint or link to blame.
pub fn parse(text: &str, base: Option<&str>, tip: Option<&str>) -> Result<SerialChain, UrdfError> {
    let tree = tree::Tree::parse(text)?;
    let skeleton = tree.skeleton();
    let base = base.map(|name| skeleton.find("base_link", name)).transpose()?;
    let tip = tip.map(|name| skeleton.find("tip_link", name)).transpose()?;
    let path = skeleton.path(tree.root(base.or(tip))?, base, tip).map_err(|error| match tree.xacro {
        true => UrdfError::Xacro,
        false => error.into(),
    })?;
    welded_chain(&tree, tree.robot.name.clone(), &path, &Vector3::new(0.0, 0.0, -GRAVITY_M_S2), &same())
}
