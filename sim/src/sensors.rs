//! What the joint sensors make of the truth.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_robot::SensorFrame;

use crate::TorqueSide;

/// Noise and filters of the joint sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Standard deviation of the encoder noise (rad).
    pub encoder_sd_rad: f64,
    /// Encoder resolution (rad); 0 is infinitely fine.
    pub encoder_resolution_rad: f64,
    /// Cut-off of the first-order filter on the differentiated position (Hz).
    pub velocity_cutoff_hz: f64,
    /// Standard deviation of the torque signal (Nm).
    pub torque_sd_nm: f64,
    /// Side of the gears of the torque signal.
    pub torque_side: TorqueSide,
    /// Standard deviation of the noise of the motor encoders (rad) of a robot with two encoders per joint: `q` then is
    /// the link's angle and `theta` the motor's. `None`: one encoder, at the motor, is `q`.
    pub motor_encoder_sd_rad: Option<f64>,
}

impl Default for Sensors {
    /// 1e-5 rad encoder noise and a 50 Hz velocity filter, so the velocity noise is 2.9e-3 rad/s; 0.05 Nm torque noise.
    fn default() -> Self {
        Self {
            encoder_sd_rad: 1e-5,
            encoder_resolution_rad: 0.0,
            velocity_cutoff_hz: 50.0,
            torque_sd_nm: 0.05,
            torque_side: TorqueSide::Motor,
            motor_encoder_sd_rad: None,
        }
    }
}

impl Sensors {
    /// Sensors without any noise (filters stay).
    pub fn noise_free() -> Self {
        Self::default().scaled_noise(0.0)
    }

    /// The same sensors with every noise scaled by `factor`.
    pub fn scaled_noise(self, factor: f64) -> Self {
        Self {
            encoder_sd_rad: factor * self.encoder_sd_rad,
            torque_sd_nm: factor * self.torque_sd_nm,
            motor_encoder_sd_rad: self.motor_encoder_sd_rad.map(|sd| factor * sd),
            ..self
        }
    }

    fn quantised<const N: usize>(&self, x: SVector<f64, N>) -> SVector<f64, N> {
        let resolution = self.encoder_resolution_rad;
        if resolution > 0.0 { x.map(|x| (x / resolution).round() * resolution) } else { x }
    }

    /// The same sensors with a second encoder per joint, as noisy as the first.
    pub fn with_motor_encoders(self) -> Self {
        Self { motor_encoder_sd_rad: Some(self.encoder_sd_rad), ..self }
    }
}

/// The state of the sensors: filter and noise stream.
#[derive(Clone, Debug)]
pub(crate) struct SensorState<const N: usize> {
    settings: Sensors,
    rng: Pcg64,
    /// Control period (s) and the weight of a new difference in the velocity filter at it.
    filter: (f64, f64),
    last_q: Option<SVector<f64, N>>,
    qd: SVector<f64, N>,
}

impl<const N: usize> SensorState<N> {
    pub(crate) fn new(settings: Sensors, seed: u64) -> Self {
        Self { settings, rng: Pcg64::seed_from_u64(seed), filter: (0.0, 0.0), last_q: None, qd: SVector::zeros() }
    }

    /// `q_m = quantise(q + n)`, `qd_m = LPF((q_m − q_m,last)/dt)`; `theta_m = quantise(theta + n)` with two encoders, else
    /// q is that of the motors.
    pub(crate) fn sample(
        &mut self,
        time_s: f64,
        link: &SVector<f64, N>,
        motor: &SVector<f64, N>,
        tau: &SVector<f64, N>,
        dt_s: f64,
    ) -> SensorFrame<N> {
        let settings = self.settings;
        let q = if settings.motor_encoder_sd_rad.is_some() { link } else { motor };
        let measured = settings.quantised(q + self.noise(settings.encoder_sd_rad));
        let tau = tau + self.noise(settings.torque_sd_nm);
        if let Some(last) = self.last_q {
            if self.filter.0 != dt_s {
                let weight = 1.0 - (-2.0 * std::f64::consts::PI * settings.velocity_cutoff_hz * dt_s).exp();
                self.filter = (dt_s, weight);
            }
            self.qd += ((measured - last) / dt_s - self.qd) * self.filter.1;
        }
        self.last_q = Some(measured);
        // Drawn last: the numbers of a robot with one encoder stay what they are.
        let theta = settings.motor_encoder_sd_rad.map(|sd| settings.quantised(motor + self.noise(sd)));
        SensorFrame { time_s, q: measured, qd: self.qd, tau, theta }
    }

    fn noise(&mut self, sd: f64) -> SVector<f64, N> {
        let mut noise = SVector::<f64, N>::zeros();
        if sd > 0.0 {
            for value in noise.iter_mut() {
                *value = sd * self.rng.sample::<f64, _>(StandardNormal);
            }
        }
        noise
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: sd of the filtered difference = (σ/dt) a √(2/(2 − a)), a = 1 − exp(−2π f dt).
    #[test]
    fn velocity_noise_has_the_predicted_deviation() {
        let settings = Sensors::default();
        let mut state = SensorState::<1>::new(settings, 3);
        let (zero, dt) = (SVector::zeros(), 1e-3);
        let n = 200_000;
        let sum: f64 = (0..n).map(|_| state.sample(0.0, &zero, &zero, &zero, dt).qd[0].powi(2)).sum();
        let a = 1.0 - (-2.0 * std::f64::consts::PI * settings.velocity_cutoff_hz * dt).exp();
        let expected = settings.encoder_sd_rad / dt * a * (2.0 / (2.0 - a)).sqrt();
        assert!(((sum / n as f64).sqrt() / expected - 1.0).abs() < 0.02, "{} {expected}", (sum / n as f64).sqrt());
    }

    /// Two encoders read both sides of the spring; the link's numbers are those of a robot with one.
    #[test]
    fn a_second_encoder_reads_the_motor_and_changes_nothing_else() {
        let (link, motor, tau) = (SVector::from([0.3, 0.4]), SVector::from([0.301, 0.402]), SVector::from([1.0, 2.0]));
        let mut two = SensorState::<2>::new(Sensors::noise_free().with_motor_encoders(), 1);
        let frame = two.sample(0.0, &link, &motor, &tau, 1e-3);
        assert_eq!((frame.q, frame.theta), (link, Some(motor)));
        let one = SensorState::<2>::new(Sensors::default(), 1).sample(0.0, &link, &link, &tau, 1e-3);
        let noisy = Sensors::default().with_motor_encoders();
        let two = SensorState::<2>::new(noisy, 1).sample(0.0, &link, &link, &tau, 1e-3);
        assert_eq!((one.q, one.tau, one.theta), (two.q, two.tau, None));
        let noise = two.theta.unwrap() - link;
        assert!(noise.amax() > 1e-7 && noise.amax() < 1e-4 && two.theta != Some(two.q), "{noise}");
    }
}
