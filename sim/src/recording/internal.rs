//! What is inside the joints at one time.

use nalgebra::SVector;

use crate::hidden::JointBristles;

/// Internal state at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Internal<const N: usize> {
    /// Bristle ratios z [-].
    pub bristles: [JointBristles; N],
    /// Motor less link angle through the spring (rad), and its derivatives.
    pub deflection: SVector<f64, N>,
    pub deflection_rate: SVector<f64, N>,
    pub deflection_acceleration: SVector<f64, N>,
    /// Motor less link angle through the gap (rad).
    pub gap: SVector<f64, N>,
}

impl<const N: usize> Internal<N> {
    /// Nothing bent, nothing open.
    pub fn none() -> Self {
        let zero = SVector::zeros();
        let bristles = [JointBristles::default(); N];
        Self { bristles, deflection: zero, deflection_rate: zero, deflection_acceleration: zero, gap: zero }
    }
}
