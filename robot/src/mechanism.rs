//! What an arm is made of: where its joints sit, what its links weigh.

use std::ops::Deref;

use nalgebra::{Matrix3, Vector3};

use crate::canonical::Canonical;
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

/// A [`Mechanism`] and what the algorithms make of it once, so that no call has to: it can be read, and replaced, not changed.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedMechanism<const N: usize> {
    described: Mechanism<N>,
    canonical: Canonical<N>,
}

impl<const N: usize> PreparedMechanism<N> {
    #[inline]
    pub(crate) fn canonical(&self) -> &Canonical<N> {
        &self.canonical
    }
}

impl<const N: usize> From<Mechanism<N>> for PreparedMechanism<N> {
    fn from(described: Mechanism<N>) -> Self {
        Self { canonical: Canonical::of(&described), described }
    }
}

impl<const N: usize> Deref for PreparedMechanism<N> {
    type Target = Mechanism<N>;

    #[inline]
    fn deref(&self) -> &Mechanism<N> {
        &self.described
    }
}
