//! Serial arms from URDF, and back.
//!
//! ```text
//! T(parent, child)(q) = Trans(xyz) RotZ(yaw) RotY(pitch) RotX(roll) Rot(axis, q)
//! ```
//!
//! A chain of 6 or 7 revolute or continuous joints from a base link to a tip link. Links joined by fixed joints are
//! welded into one body, every axis is turned onto z, and the frame of the tip becomes the flange. `<dynamics>` is read as
//! `damping` (viscous [Nm s/rad]) and `friction` (Coulomb (Nm)).
//!
//! Leaves out: prismatic, floating, planar, spherical and mimic joints, branches that move, geometry. URDF knows neither
//! rotor inertia (zero here) nor torque rates (1000 Nm/s here); gravity is 9.81 m/s² along −z of the base link.

mod body;
mod chain;
mod error;
mod frame;
mod joint;
mod tree;
mod write;

pub use chain::{UrdfArm, UrdfChain};
pub use error::UrdfError;
pub use write::to_urdf;
