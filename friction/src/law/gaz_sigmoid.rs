//! The sigmoid friction of the published Panda identification.

use super::{JointFriction, SetValued};

/// `tau_f = φ1/(1 + exp(−φ2 (qd + φ3))) − φ1/(1 + exp(−φ2 φ3))` (gaz2019).
///
/// Smooth and zero at rest; the two branches differ by direction through φ3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazSigmoid {
    /// Height of the sigmoid φ1 (Nm).
    pub phi1_nm: f64,
    /// Steepness φ2 [s/rad].
    pub phi2_s_per_rad: f64,
    /// Shift φ3 [rad/s].
    pub phi3_rad_s: f64,
}

impl GazSigmoid {
    /// Torque (Nm) at qd [rad/s].
    #[inline]
    pub fn torque(&self, qd: f64) -> f64 {
        self.phi1_nm * (self.logistic(qd) - self.logistic(0.0))
    }

    /// Tangent at qd [rad/s]: no dry friction, slope φ1 φ2 σ(1 − σ).
    #[inline]
    pub fn set_valued(&self, qd: f64) -> SetValued {
        let sigma = self.logistic(qd);
        let slope = self.phi1_nm * self.phi2_s_per_rad * sigma * (1.0 - sigma);
        SetValued { viscous_nm_s_per_rad: slope, offset_nm: self.torque(qd) - slope * qd, lower_nm: 0.0, upper_nm: 0.0 }
    }

    #[inline]
    fn logistic(&self, qd: f64) -> f64 {
        1.0 / (1.0 + (-self.phi2_s_per_rad * (qd + self.phi3_rad_s)).exp())
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { phi1_nm: factor * self.phi1_nm, ..*self }
    }
}

impl From<GazSigmoid> for JointFriction {
    fn from(law: GazSigmoid) -> Self {
        Self::GazSigmoid(law)
    }
}
