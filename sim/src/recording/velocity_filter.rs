//! The velocity signal of a drive.

use nalgebra::SVector;

/// First-order filter on the differentiated position: `v += (1 − exp(−2π f dt)) ((q − q_last)/dt − v)`.
#[derive(Clone, Debug)]
pub(super) struct VelocityFilter<const N: usize> {
    rate_rad_s: f64,
    last_rad: SVector<f64, N>,
    pub velocity_rad_s: SVector<f64, N>,
}

impl<const N: usize> VelocityFilter<N> {
    pub fn new(cutoff_hz: f64, q: SVector<f64, N>, qd: SVector<f64, N>) -> Self {
        Self { rate_rad_s: std::f64::consts::TAU * cutoff_hz, last_rad: q, velocity_rad_s: qd }
    }

    /// The next position, `dt_s` (s) after the last.
    pub fn push(&mut self, q: SVector<f64, N>, dt_s: f64) {
        let slope = (q - self.last_rad) / dt_s;
        self.velocity_rad_s += (slope - self.velocity_rad_s) * (1.0 - (-self.rate_rad_s * dt_s).exp());
        self.last_rad = q;
    }
}
