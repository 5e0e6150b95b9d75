//! The columns in which a friction law is linear.

use crate::law::{CoulombViscous, JointFriction, Stribeck};

/// 1/vs [s/rad] at which the Stribeck column is frozen: from 5 to 10 the identified cost is the same.
pub const STRIBECK_BASIS_INVERSE_VELOCITY_S_PER_RAD: f64 = 8.0;
/// Shape exponent at which the Stribeck column is frozen.
pub const STRIBECK_BASIS_SHAPE: f64 = 1.6;

/// Friction laws made linear in their parameters, per joint:
///
/// ```text
/// Coulomb-viscous: tau_f = [qd, s] · [Fv, Fc]
/// Stribeck:        tau_f = [qd, s, s exp(−(8 |qd|)^1.6)] · [Fv, Fc, dF]
/// ```
///
/// s is the sign of qd. The Stribeck velocity and shape are hardly identifiable from a tuning trial and stay fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Two columns per joint.
    CoulombViscous,
    /// Three columns per joint.
    Stribeck,
}

impl Basis {
    /// Number of columns per joint.
    pub fn columns(self) -> usize {
        match self {
            Self::CoulombViscous => 2,
            Self::Stribeck => 3,
        }
    }

    /// The columns at qd [rad/s] with the given sign; unused entries are zero.
    #[inline]
    pub fn evaluate(self, qd: f64, sign: f64) -> [f64; 3] {
        match self {
            Self::CoulombViscous => [qd, sign, 0.0],
            Self::Stribeck => {
                let x = (STRIBECK_BASIS_INVERSE_VELOCITY_S_PER_RAD * qd).abs();
                [qd, sign, sign * (-x.powf(STRIBECK_BASIS_SHAPE)).exp()]
            }
        }
    }

    /// The law with these coefficients (at least [`Basis::columns`] of them, in column order).
    pub fn law(self, coefficients: &[f64]) -> JointFriction {
        let at = |k: usize| coefficients.get(k).copied().unwrap_or(0.0);
        match self {
            Self::CoulombViscous => CoulombViscous { viscous_nm_s_per_rad: at(0), coulomb_nm: at(1) }.into(),
            Self::Stribeck => Stribeck {
                viscous_nm_s_per_rad: at(0),
                coulomb_nm: at(1),
                breakaway_minus_coulomb_nm: at(2),
                inverse_stribeck_velocity_s_per_rad: STRIBECK_BASIS_INVERSE_VELOCITY_S_PER_RAD,
                shape: STRIBECK_BASIS_SHAPE,
            }
            .into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_times_coefficients_are_the_law() {
        let coefficients = [0.9, 0.5, 0.3];
        for basis in [Basis::CoulombViscous, Basis::Stribeck] {
            for qd in [-0.4, -0.02, 0.003, 0.3] {
                let columns = basis.evaluate(qd, f64::signum(qd));
                let torque: f64 = (0..basis.columns()).map(|k| columns[k] * coefficients[k]).sum();
                assert!((torque - basis.law(&coefficients).torque(qd, 0.0)).abs() < 1e-15);
            }
        }
    }
}
