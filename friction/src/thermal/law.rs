//! Friction torque as a function of speed and temperature.

use super::{ColdFriction, ThermalError};

/// `factor(T) = slope (T − T0) + level`: what warmth makes of one part of the friction (simoni2017 (4), (5)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TemperatureFactor {
    /// α or γ [1/K].
    pub slope_per_k: f64,
    /// β or δ [-]; 1 if the model were perfect.
    pub level: f64,
}

impl TemperatureFactor {
    /// No dependence on temperature.
    pub const NONE: Self = Self { slope_per_k: 0.0, level: 1.0 };

    /// The factor at `rise_k` = T − T0 (K).
    #[inline]
    pub fn at(&self, rise_k: f64) -> f64 {
        self.slope_per_k * rise_k + self.level
    }

    fn validate(&self, names: [&'static str; 2]) -> Result<(), ThermalError> {
        ThermalError::check(names[0], self.slope_per_k, self.slope_per_k.abs() <= 1.0, "-1 to 1 1/K")?;
        ThermalError::check(names[1], self.level, self.level > 0.0 && self.level <= 10.0, "above 0, up to 10")
    }
}

/// Friction of a joint at speed q̇ and temperature T (simoni2017 (6), (11); simoni2019 (22)):
///
/// ```text
/// tau_f(q̇, T) = tau_pol(q̇) [α (T − T0) + β] + tau_str(q̇) [γ (T − T0) + δ]
/// ```
///
/// A factor that would be negative is taken as zero: (4) and (5) are lines, and friction does not drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalLaw {
    /// tau_pol and tau_str: the friction at T0.
    pub cold: ColdFriction,
    /// α and β, of the polynomial part.
    pub polynomial: TemperatureFactor,
    /// γ and δ, of the Stribeck part.
    pub stribeck: TemperatureFactor,
    /// T0 (°C).
    pub reference_c: f64,
    /// Speed below which the sign of q̇ is softened [rad/s], see [`ColdFriction::parts_nm`].
    pub threshold_rad_s: f64,
}

impl ThermalLaw {
    /// A friction that knows nothing of temperature.
    pub fn without_temperature(cold: ColdFriction) -> Self {
        let none = TemperatureFactor::NONE;
        Self { cold, polynomial: none, stribeck: none, reference_c: 22.0, threshold_rad_s: 0.005 }
    }

    /// Friction torque (Nm) at q̇ [rad/s] and T (°C).
    #[inline]
    pub fn torque_nm(&self, qd: f64, temperature_c: f64) -> f64 {
        let [polynomial, stribeck] = self.cold.parts_nm(qd, self.threshold_rad_s);
        let [f, g] = self.factors(temperature_c);
        polynomial * f + stribeck * g
    }

    /// Friction torque (Nm) of sliding at q̇ [rad/s] and T (°C): the sign of q̇ is hard and zero at rest.
    #[inline]
    pub fn sliding_nm(&self, qd: f64, temperature_c: f64) -> f64 {
        let [polynomial, stribeck] = self.cold.parts_nm(qd, 0.0);
        let [f, g] = self.factors(temperature_c);
        polynomial * f + stribeck * g
    }

    /// ∂tau_f/∂T [Nm/K] at q̇ [rad/s] and T (°C).
    #[inline]
    pub fn slope_nm_per_k(&self, qd: f64, temperature_c: f64) -> f64 {
        let [polynomial, stribeck] = self.cold.parts_nm(qd, self.threshold_rad_s);
        let [f, g] = self.factors(temperature_c);
        let slope = |factor: f64, slope: f64| if factor > 0.0 { slope } else { 0.0 };
        polynomial * slope(f, self.polynomial.slope_per_k) + stribeck * slope(g, self.stribeck.slope_per_k)
    }

    /// The two factors [-] at T (°C).
    #[inline]
    pub fn factors(&self, temperature_c: f64) -> [f64; 2] {
        let rise = temperature_c - self.reference_c;
        [self.polynomial.at(rise).max(0.0), self.stribeck.at(rise).max(0.0)]
    }

    pub(super) fn validate(&self) -> Result<(), ThermalError> {
        self.cold.validate()?;
        self.polynomial.validate(["alpha_per_k", "beta"])?;
        self.stribeck.validate(["gamma_per_k", "delta"])?;
        let t = self.reference_c;
        ThermalError::check("reference_c", t, (-100.0..=200.0).contains(&t), "-100 to 200 °C")?;
        let v = self.threshold_rad_s;
        ThermalError::check("threshold_rad_s", v, v > 0.0 && v <= 1.0, "above 0, up to 1 rad/s")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thermal::PolynomialStribeck;

    fn law() -> ThermalLaw {
        ThermalLaw {
            cold: PolynomialStribeck {
                polynomial: [60.0, 80.0, 25.0, -8.0],
                stribeck_nm: 20.0,
                stribeck_decay_s_per_rad: 15.0,
            }
            .into(),
            polynomial: TemperatureFactor { slope_per_k: -0.00937, level: 0.91708 },
            stribeck: TemperatureFactor { slope_per_k: 0.004, level: 1.05 },
            reference_c: 24.0,
            threshold_rad_s: 0.01,
        }
    }

    /// simoni2017, section II: warmer means less friction at high speed and more at low speed.
    #[test]
    fn warmth_helps_at_high_speed_and_hurts_at_low_speed() {
        let warm_less_cold = |law: &ThermalLaw, qd: f64| law.torque_nm(qd, 44.0) - law.torque_nm(qd, 24.0);
        assert!(warm_less_cold(&law(), 1.5) < 0.0);
        let creeping = ThermalLaw {
            cold: PolynomialStribeck { polynomial: [0.0; 4], stribeck_nm: 20.0, stribeck_decay_s_per_rad: 15.0 }.into(),
            ..law()
        };
        assert!(warm_less_cold(&creeping, 0.05) > 0.0);
    }

    /// Witness: finite difference of the torque.
    #[test]
    fn slope_is_the_derivative() {
        for qd in [-1.2, -0.004, 0.03, 0.8] {
            let difference = (law().torque_nm(qd, 31.0 + 1e-3) - law().torque_nm(qd, 31.0 - 1e-3)) / 2e-3;
            assert!((difference - law().slope_nm_per_k(qd, 31.0)).abs() < 1e-8);
        }
    }

    #[test]
    fn friction_never_drives_however_hot() {
        for temperature in [-50.0, 24.0, 120.0, 500.0] {
            for k in -100..=100 {
                let qd = 0.02 * f64::from(k);
                assert!(law().torque_nm(qd, temperature) * qd >= 0.0);
            }
        }
        assert_eq!(law().slope_nm_per_k(1.0, 300.0), 20.0 * (-15.0_f64).exp() * 0.004);
    }
}
