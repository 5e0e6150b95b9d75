//! Friction and heat of one joint together.

use super::{HeatBalance, InjectedPower, ThermalError, ThermalLaw, ThermalResponse};

/// A joint whose friction heats it, checked.
///
/// ```
/// use tribo_friction::thermal::{HeatBalance, InjectedPower, PolynomialStribeck, TemperatureFactor, ThermalJoint, ThermalLaw};
///
/// // Joint 2 of simoni2019, always in motion: 140.8 W at T0.
/// let cold = PolynomialStribeck { polynomial: [80.0, 60.0, 0.0, 0.0], ..PolynomialStribeck::default() };
/// let polynomial = TemperatureFactor { slope_per_k: -0.00937, level: 0.91708 };
/// let law = ThermalLaw { polynomial, ..ThermalLaw::without_temperature(cold.into()) };
/// let joint = ThermalJoint::new(law, HeatBalance::SIMONI2019)?;
/// let power = InjectedPower { polynomial_w: 140.8, stribeck_w: 0.0 };
/// let response = joint.response(&power, 22.0, 22.0)?;
/// assert!((response.time_constant_s / 60.0 - 73.96).abs() < 0.02);
/// # Ok::<(), tribo_friction::thermal::ThermalError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalJoint {
    law: ThermalLaw,
    heat: HeatBalance,
}

impl ThermalJoint {
    /// Checks every number.
    ///
    /// # Errors
    /// The first field outside its range.
    pub fn new(law: ThermalLaw, heat: HeatBalance) -> Result<Self, ThermalError> {
        law.validate()?;
        heat.validate()?;
        Ok(Self { law, heat })
    }

    /// Its friction.
    pub fn law(&self) -> &ThermalLaw {
        &self.law
    }

    /// Its heat.
    pub fn heat(&self) -> &HeatBalance {
        &self.heat
    }

    /// Temperature (°C) after `dt_s` (s) at q̇ [rad/s] in a room of `ambient_c` (°C): simoni2017 (7) with the power of the
    /// start of the period. The power of friction is never negative.
    #[inline]
    pub fn warmed_c(&self, temperature_c: f64, qd: f64, ambient_c: f64, dt_s: f64) -> f64 {
        let power = (qd * self.law.torque_nm(qd, temperature_c)).max(0.0);
        self.heat.step(temperature_c, power, ambient_c, dt_s)
    }

    /// Closed form for a steady duty cycle of power P at T0:
    ///
    /// ```text
    /// t_c = C/(K − α P_pol − γ P_str)                                                       (25)
    /// T∞ = T0 + (β P_pol + δ P_str + K (T_env − T0))/(K − α P_pol − γ P_str)                  (23)
    /// ```
    ///
    /// # Errors
    /// Where the denominator is not positive, friction would grow with the heat it makes, without end.
    pub fn response(
        &self,
        power: &InjectedPower,
        ambient_c: f64,
        start_c: f64,
    ) -> Result<ThermalResponse, ThermalError> {
        let (k, c) = (self.heat.conductance_w_per_k, self.heat.capacity_j_per_k);
        let (p, s) = (self.law.polynomial, self.law.stribeck);
        let effective = k - p.slope_per_k * power.polynomial_w - s.slope_per_k * power.stribeck_w;
        let allowed = "K above α P_pol + γ P_str";
        ThermalError::check("effective_conductance_w_per_k", effective, effective > 0.0, allowed)?;
        let t0 = self.law.reference_c;
        let heating = p.level * power.polynomial_w + s.level * power.stribeck_w + k * (ambient_c - t0);
        Ok(ThermalResponse { start_c, steady_c: t0 + heating / effective, time_constant_s: c / effective })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thermal::{PolynomialStribeck, TemperatureFactor};

    fn joint() -> ThermalJoint {
        let law = ThermalLaw {
            cold: PolynomialStribeck {
                polynomial: [70.0, 60.0, 8.0, -2.0],
                stribeck_nm: 20.0,
                stribeck_decay_s_per_rad: 8.0,
            }
            .into(),
            polynomial: TemperatureFactor { slope_per_k: -0.00937, level: 0.91708 },
            stribeck: TemperatureFactor { slope_per_k: 0.005, level: 1.1 },
            reference_c: 20.0,
            threshold_rad_s: 0.01,
        };
        ThermalJoint::new(law, HeatBalance::SIMONI2019).unwrap()
    }

    /// Witness: the closed form against (8) integrated at 10 Hz through real cycles, in a room that is not at T0.
    #[test]
    fn closed_form_is_the_integral() {
        let joint = joint();
        let cycle: Vec<f64> =
            (0..600).map(|k| if k < 400 { 1.3 * (f64::from(k) * 0.0942).sin() } else { 0.0 }).collect();
        let power = InjectedPower::of_cycle(&joint.law().cold, 0.01, &cycle);
        let response = joint.response(&power, 26.0, 31.0).unwrap();
        let mut temperature = 31.0;
        for minute in 1..=300 {
            for &qd in &cycle {
                temperature = joint.warmed_c(temperature, qd, 26.0, 0.1);
            }
            let closed = response.temperature_c(f64::from(minute) * 60.0);
            assert!((temperature - closed).abs() < 0.05, "{minute} min: {temperature} against {closed}");
        }
        assert!(temperature > 40.0);
        // The mean of the closed form is its integral.
        let samples = 10_000;
        let mean: f64 = (0..samples).map(|k| response.temperature_c((f64::from(k) + 0.5) * 0.3)).sum::<f64>();
        assert!((mean / f64::from(samples) - response.mean_c(3000.0)).abs() < 1e-6);
    }

    /// simoni2019: the four published time constants, each from (25) and the power it implies, and what those powers are.
    #[test]
    fn published_time_constants() {
        let law = ThermalLaw { stribeck: TemperatureFactor::NONE, ..*joint().law() };
        let joint = ThermalJoint::new(law, HeatBalance::SIMONI2019).unwrap();
        for (minutes, watt) in [(101.38, 23.19), (89.51, 65.27), (81.58, 100.21), (73.96, 140.84)] {
            let power = InjectedPower { polynomial_w: watt, stribeck_w: 0.0 };
            let response = joint.response(&power, 20.0, 20.0).unwrap();
            assert!((response.time_constant_s / 60.0 - minutes).abs() < 0.005, "{watt} W");
            assert_eq!(response.update_interval_s(), response.time_constant_s / 10.0);
        }
    }

    #[test]
    fn bad_numbers_and_runaway_are_named() {
        let law = *joint().law();
        let bad = |law: ThermalLaw, heat: HeatBalance| ThermalJoint::new(law, heat).unwrap_err().field;
        let heat = HeatBalance::SIMONI2019;
        assert_eq!(bad(law, HeatBalance { conductance_w_per_k: 0.0, ..heat }), "conductance_w_per_k");
        assert_eq!(bad(law, HeatBalance { capacity_j_per_k: f64::NAN, ..heat }), "capacity_j_per_k");
        assert_eq!(bad(ThermalLaw { threshold_rad_s: 0.0, ..law }, heat), "threshold_rad_s");
        let factor = TemperatureFactor { slope_per_k: 2.0, level: 1.0 };
        assert_eq!(bad(ThermalLaw { polynomial: factor, ..law }, heat), "alpha_per_k");
        let power = InjectedPower { polynomial_w: 0.0, stribeck_w: 600.0 };
        let error = joint().response(&power, 20.0, 20.0).unwrap_err();
        assert_eq!(error.field, "effective_conductance_w_per_k");
        assert!(error.to_string().contains("allowed: K above"));
    }
}
