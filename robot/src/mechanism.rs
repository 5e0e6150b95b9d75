//! What an arm is made of: where its joints sit, what its links weigh.

use nalgebra::{Matrix3, Vector3};

use crate::{JointPlacement, LinkInertia};

/// Joints, links and flange of a serial arm, as data sheets and files give them.
#[derive(Clone, Debug, PartialEq)]
pub struct Mechanism<const N: usize> {
    /// Placement of each joint on its parent link.
    pub placements: [JointPlacement; N],
    /// Inertia of each link in its own frame, payload included in the last.
    pub links: [LinkInertia; N],
    /// Rotation of the flange in the last link frame.
    pub link_from_flange_rotation: Matrix3<f64>,
    /// Origin of the flange (m) in the last link frame.
    pub link_from_flange_translation: Vector3<f64>,
}
