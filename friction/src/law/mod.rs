//! One friction law per file, and the enum that holds any of them for one joint.

mod asymmetric;
mod coulomb_viscous;
mod gaz_sigmoid;
mod lugre;
mod stribeck;

pub use asymmetric::Asymmetric;
pub use coulomb_viscous::CoulombViscous;
pub use gaz_sigmoid::GazSigmoid;
pub use lugre::{Bristle, Lugre};
pub use stribeck::Stribeck;

/// Friction of one joint near velocity v as a set-valued map, ready for a time-stepping plant:
///
/// ```text
/// tau_f ∈ offset + viscous · v + { p : lower ≤ p ≤ upper },   p = upper if v > 0, lower if v < 0
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SetValued {
    /// Slope [Nm s/rad], taken implicitly by the plant.
    pub viscous_nm_s_per_rad: f64,
    /// Part that does not depend on the new velocity (Nm).
    pub offset_nm: f64,
    /// Dry-friction torque when sliding backwards (Nm), ≤ 0.
    pub lower_nm: f64,
    /// Dry-friction torque when sliding forwards (Nm), ≥ 0.
    pub upper_nm: f64,
}

/// The friction of one joint under any of the laws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointFriction {
    /// Coulomb and viscous friction.
    CoulombViscous(CoulombViscous),
    /// Coulomb, viscous and Stribeck friction.
    Stribeck(Stribeck),
    /// The smooth sigmoid of gaz2019.
    GazSigmoid(GazSigmoid),
    /// Coulomb and viscous friction that differ by direction.
    Asymmetric(Asymmetric),
    /// Bristle friction with presliding.
    Lugre(Lugre),
}

impl JointFriction {
    /// Steady-sliding friction torque (Nm) at qd [rad/s], with sign(qd) replaced by tanh(qd/smoothing).
    ///
    /// `smoothing_rad_s = 0` is the hard sign with sign(0) = 0. The Gaz law is smooth already and ignores it.
    #[inline]
    pub fn torque(&self, qd: f64, smoothing_rad_s: f64) -> f64 {
        let sign = smooth_sign(qd, smoothing_rad_s);
        match self {
            Self::CoulombViscous(law) => law.torque(qd, sign),
            Self::Stribeck(law) => law.torque(qd, sign),
            Self::GazSigmoid(law) => law.torque(qd),
            Self::Asymmetric(law) => law.torque(qd, sign),
            Self::Lugre(law) => law.steady_torque(qd, sign),
        }
    }

    /// The static law as a set-valued map around qd [rad/s]. LuGre, which has a state, answers its steady sliding law:
    /// its own map needs the bristle, see [`Lugre::set_valued`].
    #[inline]
    pub fn set_valued(&self, qd: f64) -> SetValued {
        match self {
            Self::CoulombViscous(law) => law.set_valued(),
            Self::Stribeck(law) => law.set_valued(qd),
            Self::GazSigmoid(law) => law.set_valued(qd),
            Self::Asymmetric(law) => law.set_valued(qd),
            Self::Lugre(law) => {
                CoulombViscous { coulomb_nm: law.coulomb_nm, viscous_nm_s_per_rad: law.viscous_nm_s_per_rad }
                    .set_valued()
            }
        }
    }

    /// The same law with every torque scaled by `factor` (speeds, shapes and distances stay).
    pub fn scaled(&self, factor: f64) -> Self {
        match *self {
            Self::CoulombViscous(law) => Self::CoulombViscous(law.scaled(factor)),
            Self::Stribeck(law) => Self::Stribeck(law.scaled(factor)),
            Self::GazSigmoid(law) => Self::GazSigmoid(law.scaled(factor)),
            Self::Asymmetric(law) => Self::Asymmetric(law.scaled(factor)),
            Self::Lugre(law) => Self::Lugre(law.scaled(factor)),
        }
    }
}

/// `clip((qd + ℓ qdd)/w)`, clip to ±1: the sign of a velocity as a ramp that leads it by ℓ (s); qd and w in rad/s, qdd in rad/s².
#[inline]
pub fn leading_sign(qd: f64, qdd: f64, width_rad_s: f64, lead_s: f64) -> f64 {
    ((qd + lead_s * qdd) / width_rad_s.max(f64::MIN_POSITIVE)).clamp(-1.0, 1.0)
}

/// tanh(qd/smoothing), or the hard sign (sign(0) = 0) when the smoothing is not positive.
#[inline]
pub fn smooth_sign(qd: f64, smoothing_rad_s: f64) -> f64 {
    if smoothing_rad_s > 0.0 {
        (qd / smoothing_rad_s).tanh()
    } else if qd == 0.0 {
        0.0
    } else {
        qd.signum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all_laws() -> [JointFriction; 5] {
        [
            CoulombViscous { coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.0 }.into(),
            Stribeck {
                coulomb_nm: 0.5,
                viscous_nm_s_per_rad: 1.0,
                breakaway_minus_coulomb_nm: 0.3,
                inverse_stribeck_velocity_s_per_rad: 8.0,
                shape: 1.6,
            }
            .into(),
            GazSigmoid { phi1_nm: 0.54615, phi2_s_per_rad: 5.1181, phi3_rad_s: 0.039533 }.into(),
            Asymmetric {
                coulomb_positive_nm: 0.5,
                coulomb_negative_nm: 0.4,
                viscous_positive_nm_s_per_rad: 0.9,
                viscous_negative_nm_s_per_rad: 1.1,
            }
            .into(),
            Lugre { coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.0, presliding_distance_rad: 5e-4 }.into(),
        ]
    }

    /// Two forms of one law: at any sliding speed the set-valued map meets the steady torque.
    #[test]
    fn set_valued_form_agrees_with_the_torque_when_sliding() {
        for law in all_laws() {
            for qd in [-1.7, -0.2, -0.01, 0.01, 0.2, 1.7] {
                let s = law.set_valued(qd);
                let dry = if qd > 0.0 { s.upper_nm } else { s.lower_nm };
                let torque = s.offset_nm + s.viscous_nm_s_per_rad * qd + dry;
                assert!((torque - law.torque(qd, 0.0)).abs() < 1e-14, "{law:?} at {qd}");
                assert!(s.lower_nm <= 0.0 && s.upper_nm >= 0.0);
            }
        }
    }

    /// Friction never feeds energy in. (The Gaz law has an offset and may, within |qd| < |phi3|.)
    #[test]
    fn friction_dissipates() {
        for law in all_laws().into_iter().filter(|law| !matches!(law, JointFriction::GazSigmoid(_))) {
            for k in -200..=200 {
                let qd = f64::from(k) * 0.01;
                assert!(law.torque(qd, 0.005) * qd >= 0.0);
            }
        }
    }

    #[test]
    fn scaling_scales_the_torque() {
        for law in all_laws() {
            assert!((law.scaled(0.74).torque(0.3, 0.005) - 0.74 * law.torque(0.3, 0.005)).abs() < 1e-15);
        }
    }

    #[test]
    fn smooth_sign_tends_to_the_hard_sign() {
        assert_eq!(smooth_sign(0.0, 0.0), 0.0);
        assert_eq!(smooth_sign(-1e-9, 0.0), -1.0);
        assert!((smooth_sign(0.1, 0.005) - 1.0).abs() < 1e-15);
    }
}
