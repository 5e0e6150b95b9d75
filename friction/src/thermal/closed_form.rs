//! Temperature under a steady duty cycle.

/// `T(t) = T∞ + (T(0) − T∞) exp(−t/t_c)` (simoni2019 (23)–(25)); see [`super::ThermalJoint::response`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalResponse {
    /// T(0) (°C).
    pub start_c: f64,
    /// T∞ (°C).
    pub steady_c: f64,
    /// t_c (s).
    pub time_constant_s: f64,
}

impl ThermalResponse {
    /// T(t) (°C) after t (s).
    #[inline]
    pub fn temperature_c(&self, t_s: f64) -> f64 {
        self.steady_c + (self.start_c - self.steady_c) * (-t_s / self.time_constant_s).exp()
    }

    /// Mean of T (°C) over the first `t_s` (s), t > 0.
    #[inline]
    pub fn mean_c(&self, t_s: f64) -> f64 {
        let x = t_s / self.time_constant_s;
        self.steady_c + (self.start_c - self.steady_c) * (-(-x).exp_m1() / x)
    }

    /// Longest time between two updates of the temperature (s): t_c/10 (simoni2019, after (25)).
    #[inline]
    pub fn update_interval_s(&self) -> f64 {
        self.time_constant_s / 10.0
    }
}
