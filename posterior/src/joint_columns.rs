//! The columns of one joint in the regression of all families.

use nalgebra::DMatrix;

use crate::joint_term::JointTerm;

/// First column of the tilt, of the delay, of the links, in the matrix of a joint.
pub(crate) const TILT: usize = JointTerm::ALL.len();
pub(crate) const DELAY: usize = TILT + 2;
pub(crate) const LINKS: usize = DELAY + 1;

/// The columns of one joint, samples × columns: own terms, tilt, delay, ten of each link from this one outwards, then
/// the torque τ0 of the nominal model and the measured torque y.
#[derive(Clone, Debug)]
pub struct JointColumns {
    pub matrix: DMatrix<f64>,
    /// Number of links with columns.
    pub links: usize,
    /// First of them.
    pub first_link: usize,
}

impl JointColumns {
    /// Column of τ0.
    pub fn nominal(&self) -> usize {
        LINKS + 10 * self.links
    }

    /// Column of y.
    pub fn measured(&self) -> usize {
        self.nominal() + 1
    }
}
