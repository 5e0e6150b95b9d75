//! One thermal mass between friction and the room.

use super::ThermalError;

/// `C Ṫ = W_in − K (T − T_env)` (simoni2019 (13)–(17)).
///
/// T is an equivalent mean temperature of bearings and reducer. Leaves out: the housing as a second mass, radiation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatBalance {
    /// K: heat that goes to the room per kelvin [W/K].
    pub conductance_w_per_k: f64,
    /// C: heat that one kelvin takes [J/K].
    pub capacity_j_per_k: f64,
}

impl HeatBalance {
    /// Joint 2 of the arm of simoni2019, a Comau NS 16: K = 2.75614 W/K, C = 18086.82 J/K.
    pub const SIMONI2019: Self = Self { conductance_w_per_k: 2.756_14, capacity_j_per_k: 18_086.82 };

    /// Temperature (°C) after `dt_s` (s) of constant power (W) in a room of `ambient_c` (°C):
    /// `T⁺ = T∞ + (T − T∞) exp(−K dt/C)`, `T∞ = T_env + W_in/K`. simoni2017 (8) is its first order in dt.
    #[inline]
    pub fn step(&self, temperature_c: f64, power_w: f64, ambient_c: f64, dt_s: f64) -> f64 {
        let rate = (power_w - self.conductance_w_per_k * (temperature_c - ambient_c)) / self.capacity_j_per_k;
        let x = self.conductance_w_per_k * dt_s / self.capacity_j_per_k;
        // (1 − exp(−x))/x, also where K = 0.
        let mean = if x > 0.0 { -(-x).exp_m1() / x } else { 1.0 };
        temperature_c + rate * dt_s * mean
    }

    /// C/K (s): time constant of a joint at rest.
    #[inline]
    pub fn rest_time_constant_s(&self) -> f64 {
        self.capacity_j_per_k / self.conductance_w_per_k
    }

    pub(super) fn validate(&self) -> Result<(), ThermalError> {
        let (k, c) = (self.conductance_w_per_k, self.capacity_j_per_k);
        ThermalError::check("conductance_w_per_k", k, k > 0.0 && k <= 1e4, "above 0, up to 1e4 W/K")?;
        ThermalError::check("capacity_j_per_k", c, (1.0..=1e7).contains(&c), "1 to 1e7 J/K")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Witness: a thousand Euler steps (8), and energy: what came in is stored or went out.
    #[test]
    fn one_exact_step_is_many_euler_steps() {
        let heat = HeatBalance::SIMONI2019;
        let (mut euler, mut lost_j) = (25.0, 0.0);
        let (power, ambient, h) = (140.0, 22.0, 0.5);
        for _ in 0..4000 {
            let loss_w = heat.conductance_w_per_k * (euler - ambient);
            lost_j += loss_w * h;
            euler += (power - loss_w) / heat.capacity_j_per_k * h;
        }
        let exact = heat.step(25.0, power, ambient, 2000.0);
        assert!((exact - euler).abs() < 1e-3, "{exact} {euler}");
        let stored_j = heat.capacity_j_per_k * (exact - 25.0);
        assert!((stored_j + lost_j - power * 2000.0).abs() < 1e-3 * power * 2000.0);
        assert!((heat.step(80.0, 0.0, ambient, 1e9) - ambient).abs() < 1e-9);
    }
}
