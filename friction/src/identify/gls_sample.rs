//! What a fit to estimated wrenches is told of one moment.

use nalgebra::{SMatrix, SVector, Vector6};

/// One sample of a free-motion trial (100 Hz is plenty), angular part first, base axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlsSample<const N: usize> {
    /// Estimated wrench [Nm; N].
    pub wrench: Vector6<f64>,
    /// W = J̄ᵀ = Λ J B⁻¹, the map from a joint torque to the wrench it looks like, at the time of the wrench.
    pub wrench_from_torque: SMatrix<f64, 6, N>,
    /// Zero-phase joint velocity [rad/s], taken earlier by the delay of the estimator.
    pub qd: SVector<f64, N>,
    /// Whether the joint slides, and does so for as long before and after as its velocity is averaged. Beside a rest the averaged velocity
    /// is not the one that friction goes by: it gives dry friction away to viscous friction.
    pub slides: [bool; N],
    /// Friction compensation torque (Nm), taken earlier by the same delay.
    pub tau_compensation: SVector<f64, N>,
}
