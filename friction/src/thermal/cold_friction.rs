//! Friction at the reference temperature, in the two parts that warmth changes differently.

use super::ThermalError;
use crate::law::{JointFriction, smooth_sign};

/// `tau_f = [c0 + c1 |q̇| + c2 q̇² + c3 |q̇|³ + c4 exp(−h |q̇|)] sign(q̇)` (simoni2017 (1)–(3)).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolynomialStribeck {
    /// c0 … c3 [Nm, Nm s/rad, Nm s²/rad², Nm s³/rad³].
    pub polynomial: [f64; 4],
    /// c4: what the joint needs more when it starts (Nm).
    pub stribeck_nm: f64,
    /// h: inverse of the speed at which that has faded to 1/e [s/rad].
    pub stribeck_decay_s_per_rad: f64,
}

impl PolynomialStribeck {
    /// Columns `[1, v, v², v³, exp(−h v)]` at speed v ≥ 0 [rad/s].
    #[inline]
    pub fn columns(speed_rad_s: f64, decay_s_per_rad: f64) -> [f64; 5] {
        let v = speed_rad_s;
        [1.0, v, v * v, v * v * v, (-decay_s_per_rad * v).exp()]
    }

    /// Polynomial and Stribeck part (Nm) at speed v ≥ 0 [rad/s].
    #[inline]
    fn magnitudes(&self, v: f64) -> [f64; 2] {
        let [c0, c1, c2, c3] = self.polynomial;
        [c0 + v * (c1 + v * (c2 + v * c3)), self.stribeck_nm * (-self.stribeck_decay_s_per_rad * v).exp()]
    }
}

/// Friction of a joint at the reference temperature T0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColdFriction {
    /// The papers' law.
    Polynomial(PolynomialStribeck),
    /// Any other law: of Stribeck friction the exponential is the Stribeck part, all else is the polynomial part.
    Law(JointFriction),
}

impl ColdFriction {
    /// Polynomial and Stribeck part (Nm) at q̇ [rad/s]; their sum is the friction at T0.
    ///
    /// Below the threshold [rad/s] the papers' law runs linearly through zero (simoni2017 (11)); any other law has its
    /// sign smoothed over it. Zero is the hard sign.
    #[inline]
    pub fn parts_nm(&self, qd: f64, threshold_rad_s: f64) -> [f64; 2] {
        match self {
            Self::Polynomial(law) => {
                let speed = qd.abs();
                let sign = if speed < threshold_rad_s { qd / threshold_rad_s } else { smooth_sign(qd, 0.0) };
                law.magnitudes(speed.max(threshold_rad_s)).map(|part| part * sign)
            }
            Self::Law(JointFriction::Stribeck(law)) => {
                let sign = smooth_sign(qd, threshold_rad_s);
                let bump = (law.dry_limit(qd) - law.coulomb_nm) * sign;
                [law.viscous_nm_s_per_rad * qd + law.coulomb_nm * sign, bump]
            }
            Self::Law(law) => [law.torque(qd, threshold_rad_s), 0.0],
        }
    }

    pub(super) fn validate(&self) -> Result<(), ThermalError> {
        let Self::Polynomial(law) = self else { return Ok(()) };
        for c in law.polynomial {
            ThermalError::check("polynomial", c, true, "a finite number")?;
        }
        ThermalError::check("stribeck_nm", law.stribeck_nm, true, "a finite number")?;
        let h = law.stribeck_decay_s_per_rad;
        ThermalError::check("stribeck_decay_s_per_rad", h, h >= 0.0, "0 and above")
    }
}

impl From<PolynomialStribeck> for ColdFriction {
    fn from(law: PolynomialStribeck) -> Self {
        Self::Polynomial(law)
    }
}

impl From<JointFriction> for ColdFriction {
    fn from(law: JointFriction) -> Self {
        Self::Law(law)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{CoulombViscous, Stribeck};

    /// Witness: a Stribeck law of shape 1 is the papers' law with c2 = c3 = 0, part by part.
    #[test]
    fn two_forms_of_one_law_agree() {
        let polynomial =
            PolynomialStribeck { polynomial: [0.5, 1.1, 0.0, 0.0], stribeck_nm: 0.3, stribeck_decay_s_per_rad: 7.0 };
        let stribeck = Stribeck {
            coulomb_nm: 0.5,
            viscous_nm_s_per_rad: 1.1,
            breakaway_minus_coulomb_nm: 0.3,
            inverse_stribeck_velocity_s_per_rad: 7.0,
            shape: 1.0,
        };
        let (a, b) = (ColdFriction::from(polynomial), ColdFriction::from(JointFriction::from(stribeck)));
        for qd in [-2.0, -0.3, -0.01, 0.02, 0.4, 1.5] {
            let (p, s) = (a.parts_nm(qd, 1e-3), b.parts_nm(qd, 1e-6));
            assert!((p[0] - s[0]).abs() < 1e-14 && (p[1] - s[1]).abs() < 1e-14, "{qd}: {p:?} {s:?}");
        }
    }

    /// (11): continuous at the threshold, odd, zero at rest; any law sums to its own torque.
    #[test]
    fn the_threshold_is_continuous() {
        let law = ColdFriction::from(PolynomialStribeck {
            polynomial: [0.5, 1.0, -0.2, 0.05],
            stribeck_nm: 0.2,
            stribeck_decay_s_per_rad: 20.0,
        });
        let sum = |qd: f64| law.parts_nm(qd, 0.01).iter().sum::<f64>();
        assert!((sum(0.01 - 1e-9) - sum(0.01 + 1e-9)).abs() < 1e-6);
        assert_eq!((sum(0.0), sum(-0.3)), (0.0, -sum(0.3)));
        assert!((sum(0.005) - 0.5 * sum(0.01)).abs() < 1e-15);
        let plain = JointFriction::from(CoulombViscous { coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.0 });
        assert_eq!(ColdFriction::from(plain).parts_nm(0.2, 0.005), [plain.torque(0.2, 0.005), 0.0]);
    }
}
