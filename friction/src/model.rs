//! The friction of a whole arm.

use nalgebra::SVector;

use crate::law::{CoulombViscous, JointFriction};

/// One friction law per joint: `tau_f,j = law_j(qd_j)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionModel<const N: usize> {
    /// The law of each joint.
    pub joints: [JointFriction; N],
}

impl<const N: usize> FrictionModel<N> {
    /// The same law on every joint.
    pub fn uniform(joint: JointFriction) -> Self {
        Self { joints: [joint; N] }
    }

    /// No friction at all.
    pub fn none() -> Self {
        Self::uniform(CoulombViscous::default().into())
    }

    /// Steady-sliding friction torque (Nm) at qd [rad/s], sign smoothed over `smoothing_rad_s`.
    #[inline]
    pub fn torque(&self, qd: &SVector<f64, N>, smoothing_rad_s: f64) -> SVector<f64, N> {
        SVector::from_fn(|j, _| self.joints[j].torque(qd[j], smoothing_rad_s))
    }

    /// The same model with every torque scaled by `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { joints: self.joints.map(|joint| joint.scaled(factor)) }
    }
}
