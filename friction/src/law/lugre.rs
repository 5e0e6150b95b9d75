//! Bristle friction.

use super::{JointFriction, SetValued};

/// LuGre friction (canudas1995) with a constant sliding limit:
///
/// ```text
/// ż = qd − σ0 |qd| z / Fc,   tau_f = σ0 z + σ1 ż + Fv qd,   σ0 = Fc / dz
/// σ1 = 0.8 √(σ0 B) / (1 + (qd/0.05)²)
/// ```
///
/// dz is the presliding distance; σ1 damps the bristle against the joint inertia B and fades when sliding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lugre {
    /// Coulomb friction Fc (Nm).
    pub coulomb_nm: f64,
    /// Viscous friction Fv [Nm s/rad].
    pub viscous_nm_s_per_rad: f64,
    /// Presliding distance dz = Fc/σ0 (rad).
    pub presliding_distance_rad: f64,
}

/// Deflection z (rad) of the bristle of one joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bristle {
    /// Deflection z (rad), within ± the presliding distance.
    pub deflection_rad: f64,
}

/// Fraction of critical bristle damping at rest [-].
const BRISTLE_DAMPING_RATIO: f64 = 0.4;
/// Speed [rad/s] at which the bristle damping has halved.
const DAMPING_FADE_RAD_S: f64 = 0.05;

impl Lugre {
    /// Torque (Nm) of steady sliding at qd [rad/s], given the (smoothed) sign of qd.
    #[inline]
    pub fn steady_torque(&self, qd: f64, sign: f64) -> f64 {
        self.viscous_nm_s_per_rad * qd + self.coulomb_nm * sign
    }

    /// Friction over one step of length h (s), implicit in the bristle and linear in the new velocity:
    ///
    /// ```text
    /// z⁺ = (z + h v⁺)/d,  d = 1 + h |qd|/dz;   tau_f = σ0 z⁺ + σ1 (z⁺ − z)/h + Fv v⁺
    /// ```
    ///
    /// qd [rad/s] at the start of the step, `inertia` [kg m²] the joint inertia seen by the bristle.
    #[inline]
    pub fn set_valued(&self, bristle: Bristle, qd: f64, inertia: f64, h: f64) -> SetValued {
        let stiffness = self.coulomb_nm / self.presliding_distance_rad;
        let fade = 1.0 + (qd / DAMPING_FADE_RAD_S).powi(2);
        let damping = 2.0 * BRISTLE_DAMPING_RATIO * (stiffness * inertia).sqrt() / fade;
        let d = self.denominator(qd, h);
        let z = bristle.deflection_rad;
        SetValued {
            viscous_nm_s_per_rad: (stiffness * h + damping) / d + self.viscous_nm_s_per_rad,
            offset_nm: (stiffness + damping / h) * z / d - damping * z / h,
            lower_nm: 0.0,
            upper_nm: 0.0,
        }
    }

    /// The bristle at the end of the step whose new velocity is `qd_new` [rad/s].
    #[inline]
    pub fn advanced(&self, bristle: Bristle, qd: f64, qd_new: f64, h: f64) -> Bristle {
        Bristle { deflection_rad: (bristle.deflection_rad + h * qd_new) / self.denominator(qd, h) }
    }

    #[inline]
    fn denominator(&self, qd: f64, h: f64) -> f64 {
        1.0 + h * qd.abs() / self.presliding_distance_rad
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { coulomb_nm: factor * self.coulomb_nm, viscous_nm_s_per_rad: factor * self.viscous_nm_s_per_rad, ..*self }
    }
}

impl From<Lugre> for JointFriction {
    fn from(law: Lugre) -> Self {
        Self::Lugre(law)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: pushed slowly past the presliding distance the bristle saturates at ±dz and the torque at Fc.
    #[test]
    fn steady_sliding_saturates_the_bristle() {
        let law = Lugre { coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.0, presliding_distance_rad: 5e-4 };
        let (mut z, qd, h) = (Bristle::default(), 0.02, 2e-4);
        let mut torque = 0.0;
        for _ in 0..2000 {
            let s = law.set_valued(z, qd, 0.5, h);
            torque = s.offset_nm + s.viscous_nm_s_per_rad * qd;
            z = law.advanced(z, qd, qd, h);
        }
        assert!((z.deflection_rad - 5e-4).abs() < 1e-9);
        assert!((torque - law.steady_torque(qd, 1.0)).abs() < 1e-6);
    }

    /// Within presliding the bristle is a spring: torque σ0 x.
    #[test]
    fn presliding_is_a_spring() {
        let law = Lugre { coulomb_nm: 0.6, viscous_nm_s_per_rad: 0.0, presliding_distance_rad: 5e-4 };
        let (mut z, qd, h) = (Bristle::default(), 1e-6, 2e-4);
        let mut travelled = 0.0;
        for _ in 0..1000 {
            z = law.advanced(z, qd, qd, h);
            travelled += qd * h;
        }
        assert!((z.deflection_rad - travelled).abs() < 1e-3 * travelled);
    }
}
