//! What one working cycle puts into a joint.

use super::{ColdFriction, ThermalLaw};

/// Mean power (W) of a working cycle at T0: `mean(q̇ tau_pol)` and `mean(q̇ tau_str)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InjectedPower {
    /// Of the polynomial part (W).
    pub polynomial_w: f64,
    /// Of the Stribeck part (W).
    pub stribeck_w: f64,
}

impl InjectedPower {
    /// Mean over a cycle of equally spaced velocities q̇ [rad/s], rests included.
    pub fn of_cycle(cold: &ColdFriction, threshold_rad_s: f64, qd: &[f64]) -> Self {
        let mut power = Self::default();
        for &qd in qd {
            let [polynomial, stribeck] = cold.parts_nm(qd, threshold_rad_s);
            power.polynomial_w += polynomial * qd;
            power.stribeck_w += stribeck * qd;
        }
        let count = qd.len().max(1) as f64;
        Self { polynomial_w: power.polynomial_w / count, stribeck_w: power.stribeck_w / count }
    }
}

/// A working cycle as simoni2019 describes it: RMS friction torque and equivalent thermal velocity (21).
///
/// ```text
/// tau_RMS = √mean(tau_f²),   ω̄ = mean(tau_f q̇)/tau_RMS,   hence tau_RMS ω̄ = mean(tau_f q̇) = W_in
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DutyCycle {
    /// tau_f,RMS (Nm).
    pub rms_torque_nm: f64,
    /// ω̄ [rad/s].
    pub equivalent_velocity_rad_s: f64,
}

impl DutyCycle {
    /// Of equally spaced velocities q̇ [rad/s] at T (°C), rests included.
    pub fn of(law: &ThermalLaw, temperature_c: f64, qd: &[f64]) -> Self {
        let (mut square, mut power) = (0.0, 0.0);
        for &qd in qd {
            let torque = law.torque_nm(qd, temperature_c);
            square += torque * torque;
            power += torque * qd;
        }
        let count = qd.len().max(1) as f64;
        let rms = (square / count).sqrt();
        let velocity = if rms > 0.0 { power / count / rms } else { 0.0 };
        Self { rms_torque_nm: rms, equivalent_velocity_rad_s: velocity }
    }

    /// W_in = tau_RMS ω̄ (W).
    pub fn power_w(&self) -> f64 {
        self.rms_torque_nm * self.equivalent_velocity_rad_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thermal::PolynomialStribeck;

    /// (21) and the two powers are one: at T0 the RMS torque times ω̄ is the mean power; half the duty is half of it.
    #[test]
    fn power_is_proportional_to_the_duty() {
        let cold = ColdFriction::from(PolynomialStribeck {
            polynomial: [50.0, 90.0, 10.0, -3.0],
            stribeck_nm: 15.0,
            stribeck_decay_s_per_rad: 9.0,
        });
        let law = ThermalLaw { threshold_rad_s: 0.01, ..ThermalLaw::without_temperature(cold) };
        let moving: Vec<f64> = (0..4000).map(|k| 1.5 * (f64::from(k) * 0.00314).sin()).collect();
        let mut half = moving.clone();
        half.resize(8000, 0.0);
        let (full, part) = (DutyCycle::of(&law, 22.0, &moving), DutyCycle::of(&law, 22.0, &half));
        assert!((part.power_w() / full.power_w() - 0.5).abs() < 1e-12);
        let power = InjectedPower::of_cycle(&cold, 0.01, &moving);
        assert!((power.polynomial_w + power.stribeck_w - full.power_w()).abs() < 1e-9);
    }
}
