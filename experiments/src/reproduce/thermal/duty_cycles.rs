//! The identification logs of simoni2019 section 5.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_friction::thermal::{
    CapacityAnchor, ThermalFit, ThermalFitError, ThermalFitSettings, ThermalSample, ThermalSession, identify_cold,
    identify_thermal,
};
use tribo_sim::{JointWarmth, WarmJoint};

/// Peak speeds of the strokes as parts of the fastest (simoni2019 section 5).
const PEAKS: [f64; 6] = [0.05, 0.24, 0.43, 0.62, 0.81, 1.0];
/// Minutes of one cycle.
const CYCLE_MIN: usize = 4;
/// Length of a stroke out and back (s); no multiple of the sample time.
const STROKE_S: f64 = 4.37;
/// Sub-steps of the truth in one sample.
const SUB_STEPS: usize = 2;

/// Four duty cycles of one joint, each after a night's rest: the joint strokes back and forth at six peak speeds during one,
/// two, three or all four minutes of every four.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DutyCycleStudy {
    /// Fastest peak speed [rad/s].
    pub top_speed_rad_s: f64,
    /// Length of each session (min).
    pub minutes: f64,
    /// Samples per second (Hz).
    pub rate_hz: f64,
    /// Standard deviation of a sample of friction torque (Nm).
    pub noise_sd_nm: f64,
    /// Temperature of the room, and T0 (°C).
    pub room_c: f64,
}

impl DutyCycleStudy {
    /// Velocity [rad/s] at t (s) with `duty` of four minutes at work.
    pub fn velocity(&self, t_s: f64, duty: usize) -> f64 {
        if (t_s / 60.0) as usize % CYCLE_MIN >= duty {
            return 0.0;
        }
        let peak = self.top_speed_rad_s * PEAKS[(t_s / 10.0) as usize % PEAKS.len()];
        peak * (std::f64::consts::TAU * t_s / STROKE_S).sin()
    }

    /// One session.
    pub fn session(&self, joint: &WarmJoint, duty: usize, minutes: f64, seed: u64) -> ThermalSession {
        let mut rng = Pcg64::seed_from_u64(seed);
        let dt = 1.0 / self.rate_hz;
        let mut warmth = JointWarmth::rested(self.room_c);
        let count = (minutes * 60.0 * self.rate_hz) as usize;
        let samples = (0..count)
            .map(|k| {
                let time_s = k as f64 * dt;
                let qd_rad_s = self.velocity(time_s, duty);
                let noise = self.noise_sd_nm * rng.sample::<f64, _>(StandardNormal);
                let friction_nm = joint.friction_nm(qd_rad_s, warmth.gear_c) + noise;
                for _ in 0..SUB_STEPS {
                    warmth = joint.warmed(warmth, qd_rad_s, self.room_c, dt / SUB_STEPS as f64);
                }
                ThermalSample { time_s, qd_rad_s, friction_nm }
            })
            .collect();
        ThermalSession { ambient_c: self.room_c, start_c: None, samples }
    }

    /// Cold friction from the first `cold_minutes` of the four sessions, then everything from all of them.
    ///
    /// # Errors
    /// [`ThermalFitError`].
    pub fn identify(
        &self,
        joint: &WarmJoint,
        cold_minutes: f64,
        capacity: CapacityAnchor,
        seed: u64,
    ) -> Result<ThermalFit, ThermalFitError> {
        let of = |duty: usize, minutes: f64, stream: u64| {
            self.session(joint, duty, minutes, seed.wrapping_mul(100).wrapping_add(10 * stream + duty as u64))
        };
        // A cold log of its own, so that its noise is not counted twice.
        let cold: Vec<_> = (1..=CYCLE_MIN).map(|duty| of(duty, cold_minutes, 1)).collect();
        let sessions: Vec<_> = (1..=CYCLE_MIN).map(|duty| of(duty, self.minutes, 0)).collect();
        let settings = ThermalFitSettings { capacity: Some(capacity), ..ThermalFitSettings::new(self.room_c) };
        let cold = identify_cold(&cold, settings.threshold_rad_s, joint.stribeck_nm != 0.0)?;
        identify_thermal(&cold, &sessions, &settings)
    }
}
