//! Stribeck friction.

use super::{JointFriction, SetValued};

/// `tau_f = Fv qd + (Fc + dF exp(−|qd/vs|^shape)) sign(qd)` (roveda2022 eq. 28: f1 = Fv, f2 = Fc, f3 = dF, f4 = 1/vs,
/// f5 = shape).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stribeck {
    /// Coulomb friction Fc (Nm), what is left at high speed.
    pub coulomb_nm: f64,
    /// Viscous friction Fv [Nm s/rad].
    pub viscous_nm_s_per_rad: f64,
    /// Breakaway torque less Coulomb friction, dF (Nm).
    pub breakaway_minus_coulomb_nm: f64,
    /// Inverse of the Stribeck velocity, 1/vs [s/rad].
    pub inverse_stribeck_velocity_s_per_rad: f64,
    /// Shape exponent [-].
    pub shape: f64,
}

impl Stribeck {
    /// Dry-friction limit `Fc + dF exp(−|qd/vs|^shape)` (Nm).
    #[inline]
    pub fn dry_limit(&self, qd: f64) -> f64 {
        let x = (self.inverse_stribeck_velocity_s_per_rad * qd).abs();
        self.coulomb_nm + self.breakaway_minus_coulomb_nm * (-x.powf(self.shape)).exp()
    }

    /// Torque (Nm) at qd [rad/s], given the (smoothed) sign of qd.
    #[inline]
    pub fn torque(&self, qd: f64, sign: f64) -> f64 {
        self.viscous_nm_s_per_rad * qd + self.dry_limit(qd) * sign
    }

    /// `tau_f ∈ Fv v + [−F(|qd|), F(|qd|)]` with the limit taken at the given qd [rad/s].
    #[inline]
    pub fn set_valued(&self, qd: f64) -> SetValued {
        let limit = self.dry_limit(qd);
        SetValued { viscous_nm_s_per_rad: self.viscous_nm_s_per_rad, offset_nm: 0.0, lower_nm: -limit, upper_nm: limit }
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            coulomb_nm: factor * self.coulomb_nm,
            viscous_nm_s_per_rad: factor * self.viscous_nm_s_per_rad,
            breakaway_minus_coulomb_nm: factor * self.breakaway_minus_coulomb_nm,
            ..*self
        }
    }
}

impl From<Stribeck> for JointFriction {
    fn from(law: Stribeck) -> Self {
        Self::Stribeck(law)
    }
}
