//! Coulomb and viscous friction.

use super::{JointFriction, SetValued};

/// `tau_f = Fv qd + Fc sign(qd)` (roveda2022 eq. 27, with f1 = Fv and f2 = Fc).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoulombViscous {
    /// Coulomb friction Fc (Nm).
    pub coulomb_nm: f64,
    /// Viscous friction Fv [Nm s/rad].
    pub viscous_nm_s_per_rad: f64,
}

impl CoulombViscous {
    /// Torque (Nm) at qd [rad/s], given the (smoothed) sign of qd.
    #[inline]
    pub fn torque(&self, qd: f64, sign: f64) -> f64 {
        self.viscous_nm_s_per_rad * qd + self.coulomb_nm * sign
    }

    /// `tau_f ∈ Fv v + [−Fc, Fc]`.
    #[inline]
    pub fn set_valued(&self) -> SetValued {
        SetValued {
            viscous_nm_s_per_rad: self.viscous_nm_s_per_rad,
            offset_nm: 0.0,
            lower_nm: -self.coulomb_nm,
            upper_nm: self.coulomb_nm,
        }
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { coulomb_nm: factor * self.coulomb_nm, viscous_nm_s_per_rad: factor * self.viscous_nm_s_per_rad }
    }
}

impl From<CoulombViscous> for JointFriction {
    fn from(law: CoulombViscous) -> Self {
        Self::CoulombViscous(law)
    }
}
