//! Coulomb and viscous friction that differ by direction.

use super::{JointFriction, SetValued};

/// `tau_f = Fv± qd + Fc± sign(qd)`, the values chosen by the direction of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymmetric {
    /// Coulomb friction moving forwards (Nm).
    pub coulomb_positive_nm: f64,
    /// Coulomb friction moving backwards (Nm), a positive number.
    pub coulomb_negative_nm: f64,
    /// Viscous friction moving forwards [Nm s/rad].
    pub viscous_positive_nm_s_per_rad: f64,
    /// Viscous friction moving backwards [Nm s/rad].
    pub viscous_negative_nm_s_per_rad: f64,
}

impl Asymmetric {
    /// Torque (Nm) at qd [rad/s], given the (smoothed) sign of qd.
    ///
    /// With a smooth sign s the Coulomb part is `(Fc+ + Fc−)/2 s + (Fc+ − Fc−)/2 |s|`, continuous through zero.
    #[inline]
    pub fn torque(&self, qd: f64, sign: f64) -> f64 {
        let mean = 0.5 * (self.coulomb_positive_nm + self.coulomb_negative_nm);
        let half_difference = 0.5 * (self.coulomb_positive_nm - self.coulomb_negative_nm);
        self.viscous(qd) * qd + mean * sign + half_difference * sign.abs()
    }

    /// `tau_f ∈ Fv± v + [−Fc−, Fc+]`, the slope chosen by the given qd [rad/s].
    #[inline]
    pub fn set_valued(&self, qd: f64) -> SetValued {
        SetValued {
            viscous_nm_s_per_rad: self.viscous(qd),
            offset_nm: 0.0,
            lower_nm: -self.coulomb_negative_nm,
            upper_nm: self.coulomb_positive_nm,
        }
    }

    #[inline]
    fn viscous(&self, qd: f64) -> f64 {
        if qd >= 0.0 { self.viscous_positive_nm_s_per_rad } else { self.viscous_negative_nm_s_per_rad }
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            coulomb_positive_nm: factor * self.coulomb_positive_nm,
            coulomb_negative_nm: factor * self.coulomb_negative_nm,
            viscous_positive_nm_s_per_rad: factor * self.viscous_positive_nm_s_per_rad,
            viscous_negative_nm_s_per_rad: factor * self.viscous_negative_nm_s_per_rad,
        }
    }
}

impl From<Asymmetric> for JointFriction {
    fn from(law: Asymmetric) -> Self {
        Self::Asymmetric(law)
    }
}
