//! What a joint does beyond its friction law.

use crate::law::smooth_sign;

/// Ripples kept per joint.
pub const MAX_RIPPLES: usize = 4;

/// Torque ripple of gear or motor over the joint angle: `amplitude sin(n q + phase)`, n cycles per revolution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ripple {
    /// Cycles per revolution of the joint [1/rev]; equally, radians of phase per radian of the joint.
    pub cycles_per_rev: f64,
    /// Amplitude (Nm); 0 is none.
    pub amplitude_nm: f64,
    /// Phase at q = 0 (rad).
    pub phase_rad: f64,
}

/// Friction curves kept per joint.
pub const MAX_CURVES: usize = 3;
/// Bristles with an amplitude of their own kept per joint.
pub const MAX_BRISTLES: usize = 3;

/// Friction that bends with speed: `amplitude tanh(qd/width)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Curve {
    /// Torque far above the width (Nm); 0 is none.
    pub amplitude_nm: f64,
    /// Speed at which three quarters are reached [rad/s]; above 0 where there is an amplitude.
    pub width_rad_s: f64,
}

impl Curve {
    /// Torque (Nm) at qd [rad/s].
    #[inline]
    pub fn torque_nm(&self, qd: f64) -> f64 {
        // An unused curve has no width.
        if self.amplitude_nm == 0.0 { 0.0 } else { self.amplitude_nm * (qd / self.width_rad_s).tanh() }
    }

    /// Torque per velocity [Nm s/rad] at qd [rad/s], `A tanh(qd/w)/qd`: the slope of the chord from standstill, A/w there.
    ///
    /// As viscous friction it never turns a velocity round, as the tangent of a steep curve would.
    #[inline]
    pub fn chord_nm_s_per_rad(&self, qd: f64) -> f64 {
        if self.amplitude_nm == 0.0 {
            return 0.0;
        }
        let x = qd / self.width_rad_s;
        if x == 0.0 { self.amplitude_nm / self.width_rad_s } else { self.amplitude_nm * x.tanh() / qd }
    }
}

/// A part of dry friction that builds up over a distance: `amplitude (z − s)`, `dz/dt = (qd − |qd| z)/distance`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BristlePart {
    /// Dry friction that follows this bristle in place of s (Nm); 0 is none.
    pub amplitude_nm: f64,
    /// Travel over which it builds up (rad).
    pub distance_rad: f64,
}

/// Torques of one joint that add to its friction law; all zero by default.
///
/// ```text
/// tau = dFc s + dFv qd + dF exp(−(qd/vs)²) s + a |s| + offset + γ |tau_link| s + Σ A sin(n q + φ) + k (q − rest)
///     + Σ A tanh(qd/w) + Fc (z − s) + Σ b (z_b − s)
/// ```
///
/// s is the sign of qd, smoothed. With a presliding distance the whole Coulomb friction Fc, the law's included, follows a
/// bristle z instead of s (see [`crate::law::Lugre`]), and each part b of dry friction one of its own, z_b. Bristles need a
/// state, so the last two terms are the caller's; [`Self::torque_nm`] is all before them. They vanish in steady sliding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointEffects {
    /// Added Coulomb friction (Nm).
    pub coulomb_nm: f64,
    /// Added viscous friction [Nm s/rad].
    pub viscous_nm_s_per_rad: f64,
    /// Added Stribeck bump: breakaway torque less Coulomb friction (Nm).
    pub breakaway_minus_coulomb_nm: f64,
    /// Stribeck velocity of the bump [rad/s]; matters only with a bump.
    pub stribeck_velocity_rad_s: f64,
    /// Torque that is positive whichever way the joint moves (Nm): Coulomb friction forwards less backwards, halved.
    pub asymmetry_nm: f64,
    /// Constant torque (Nm).
    pub offset_nm: f64,
    /// Coulomb friction per link-side torque [-].
    pub load_coefficient: f64,
    /// Torque ripples; unused ones have amplitude zero.
    pub ripples: [Ripple; MAX_RIPPLES],
    /// Stiffness of a spring across the joint, such as a hose [Nm/rad].
    pub spring_nm_per_rad: f64,
    /// Joint angle at which that spring is slack (rad).
    pub spring_rest_rad: f64,
    /// Travel over which dry friction builds up after a reversal (rad); 0 is at once.
    pub presliding_distance_rad: f64,
    /// Friction that bends with speed; unused curves have amplitude zero.
    pub curves: [Curve; MAX_CURVES],
    /// Parts of dry friction with a bristle each; unused ones have amplitude zero.
    pub bristles: [BristlePart; MAX_BRISTLES],
}

impl JointEffects {
    /// Whether nothing is added.
    #[inline]
    pub fn is_none(&self) -> bool {
        let Self {
            coulomb_nm,
            viscous_nm_s_per_rad,
            breakaway_minus_coulomb_nm,
            stribeck_velocity_rad_s,
            asymmetry_nm,
            offset_nm,
            load_coefficient,
            ripples,
            spring_nm_per_rad,
            spring_rest_rad,
            presliding_distance_rad,
            curves,
            bristles,
        } = *self;
        let single = [
            coulomb_nm,
            viscous_nm_s_per_rad,
            breakaway_minus_coulomb_nm,
            stribeck_velocity_rad_s,
            asymmetry_nm,
            offset_nm,
            load_coefficient,
            spring_nm_per_rad,
            spring_rest_rad,
            presliding_distance_rad,
        ];
        let ripples = ripples.map(|ripple| [ripple.cycles_per_rev, ripple.amplitude_nm, ripple.phase_rad]);
        // Every tick asks every joint: all bits but the signs at once, no branch.
        let bits = |values: &[f64]| values.iter().fold(0, |all, value| all | value.to_bits() << 1);
        let curves = curves.map(|curve| curve.amplitude_nm);
        let bristles = bristles.map(|part| part.amplitude_nm);
        bits(&single) | bits(ripples.as_flattened()) | bits(&curves) | bits(&bristles) == 0
    }

    /// Dry friction that is added at qd [rad/s] under the link-side torque `load_nm` (Nm), per unit of s.
    #[inline]
    pub fn dry_limit_nm(&self, qd: f64, load_nm: f64) -> f64 {
        let bump = if self.breakaway_minus_coulomb_nm == 0.0 {
            0.0
        } else {
            let x = qd / self.stribeck_velocity_rad_s;
            self.breakaway_minus_coulomb_nm * (-x * x).exp()
        };
        self.coulomb_nm + bump + self.load_coefficient * load_nm.abs()
    }

    /// Torque that depends on the joint angle alone, offset included (Nm).
    #[inline]
    pub fn position_torque_nm(&self, q: f64) -> f64 {
        let ripple: f64 =
            self.ripples.iter().map(|r| r.amplitude_nm * (r.cycles_per_rev * q + r.phase_rad).sin()).sum();
        self.offset_nm + ripple + self.spring_nm_per_rad * (q - self.spring_rest_rad)
    }

    /// Whether any friction bends with speed.
    pub fn has_curves(&self) -> bool {
        self.curves.iter().any(|curve| curve.amplitude_nm != 0.0)
    }

    /// Friction that bends with speed (Nm) at qd [rad/s].
    #[inline]
    pub fn curve_torque_nm(&self, qd: f64) -> f64 {
        self.curves.iter().map(|curve| curve.torque_nm(qd)).sum()
    }

    /// The whole added torque (Nm) at q (rad), qd [rad/s] and link-side torque `load_nm` (Nm), given the (smoothed)
    /// sign of qd; bristles as in steady sliding.
    #[inline]
    pub fn torque_nm(&self, q: f64, qd: f64, sign: f64, load_nm: f64) -> f64 {
        self.dry_limit_nm(qd, load_nm) * sign
            + self.viscous_nm_s_per_rad * qd
            + self.asymmetry_nm * sign.abs()
            + self.curve_torque_nm(qd)
            + self.position_torque_nm(q)
    }

    /// [`Self::torque_nm`] with sign(qd) replaced by tanh(qd/smoothing).
    #[inline]
    pub fn steady_torque_nm(&self, q: f64, qd: f64, load_nm: f64, smoothing_rad_s: f64) -> f64 {
        self.torque_nm(q, qd, smooth_sign(qd, smoothing_rad_s), load_nm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The chord ends on the curve, at standstill it is the tangent, and a curve that is not there is nothing.
    #[test]
    fn the_chord_ends_on_the_curve() {
        let curve = Curve { amplitude_nm: -0.7, width_rad_s: 0.3 };
        for qd in [-1.0, -0.2, 0.05, 0.4] {
            assert!((curve.chord_nm_s_per_rad(qd) * qd - curve.torque_nm(qd)).abs() < 1e-15, "{qd}");
        }
        for qd in [0.0, 1e-9, -1e-300] {
            assert!((curve.chord_nm_s_per_rad(qd) + 0.7 / 0.3).abs() < 1e-12, "{qd}");
        }
        assert!((curve.torque_nm(0.3) + 0.7 * 0.761_594_155_955_765).abs() < 1e-15);
        let unused = Curve::default();
        assert_eq!([unused.torque_nm(0.0), unused.torque_nm(2.0), unused.chord_nm_s_per_rad(0.0)], [0.0; 3]);
    }

    #[test]
    fn one_curve_or_bristle_is_not_nothing() {
        let mut effects = JointEffects::default();
        assert!(effects.is_none());
        effects.curves[2].amplitude_nm = -1e-3;
        assert!(!effects.is_none());
        effects = JointEffects::default();
        effects.bristles[2].amplitude_nm = 1e-3;
        assert!(!effects.is_none());
    }
}
