//! The temperature observer on one joint (simoni2019 section 7).

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_friction::thermal::ThermalJoint;
use tribo_residual::{
    ContactGate, ContactSettings, FrictionSample, ObserverSettings, TemperatureObserver, ThermalSettingsError,
};
use tribo_sim::{JointWarmth, WarmJoint};

/// Samples per second (Hz).
pub(super) const RATE_HZ: f64 = 50.0;
/// Corner of the low-pass on the torque that the gate looks at [rad/s]: that of the extra torques in simoni2017, table II.
const GATE_CORNER_RAD_S: f64 = 1.0;
/// Strokes are as in the identification, at changing peak speeds.
const PEAKS: [f64; 4] = [0.4, 0.7, 1.0, 0.55];

/// One joint, the estimated friction of which is watched.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObserverRun<'a> {
    pub truth: &'a WarmJoint,
    pub model: ThermalJoint,
    pub top_speed_rad_s: f64,
    pub noise_sd_nm: f64,
    pub room_c: f64,
    /// Constant torque (Nm) on the joint between two times (s) after the observer's start.
    pub disturbance: (f64, [f64; 2]),
    /// Whether contact keeps the observer from correcting.
    pub gated: bool,
}

/// A run, sample by sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObserverTrace {
    /// Time since the observer's start (s).
    pub time_s: Vec<f64>,
    /// Estimated temperature (°C).
    pub estimated_c: Vec<f64>,
    /// Temperature (°C) at which the model's friction would be the true one.
    pub true_c: Vec<f64>,
}

impl ObserverTrace {
    /// First time (s) from which |T̂ − T| stays below `band_k` (K) for ten seconds; the length of the run if there is none.
    pub fn settled_s(&self, band_k: f64) -> f64 {
        let need = (10.0 * RATE_HZ) as usize;
        let mut inside = 0;
        for k in 0..self.time_s.len() {
            inside = if (self.estimated_c[k] - self.true_c[k]).abs() < band_k { inside + 1 } else { 0 };
            if inside == need {
                return self.time_s[k + 1 - need];
            }
        }
        self.time_s.last().copied().unwrap_or(0.0)
    }

    /// Mean and standard deviation of T̂ − T (K) between two times (s).
    pub fn error_k(&self, [from_s, to_s]: [f64; 2]) -> [f64; 2] {
        let errors: Vec<f64> = (0..self.time_s.len())
            .filter(|&k| (from_s..to_s).contains(&self.time_s[k]))
            .map(|k| self.estimated_c[k] - self.true_c[k])
            .collect();
        let n = errors.len().max(1) as f64;
        let mean = errors.iter().sum::<f64>() / n;
        [mean, (errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / n).sqrt()]
    }

    /// Largest |T̂ − T| (K) between two times (s).
    pub fn worst_k(&self, [from_s, to_s]: [f64; 2]) -> f64 {
        (0..self.time_s.len())
            .filter(|&k| (from_s..to_s).contains(&self.time_s[k]))
            .map(|k| (self.estimated_c[k] - self.true_c[k]).abs())
            .fold(0.0, f64::max)
    }
}

impl ObserverRun<'_> {
    fn velocity(&self, t_s: f64) -> f64 {
        let peak = self.top_speed_rad_s * PEAKS[(t_s / 10.0) as usize % PEAKS.len()];
        peak * (std::f64::consts::TAU * t_s / 4.37).sin()
    }

    /// See [`equivalent_c`].
    pub fn equivalent_c(&self, warmth: JointWarmth) -> f64 {
        equivalent_c(self.truth, &self.model, warmth)
    }

    /// The true joint after `seconds` of this work, from a night's rest.
    pub fn warmed_up(&self, seconds: f64) -> JointWarmth {
        let dt = 0.1;
        (0..(seconds / dt) as usize).fold(JointWarmth::rested(self.room_c), |warmth, k| {
            self.truth.warmed(warmth, self.velocity(k as f64 * dt), self.room_c, dt)
        })
    }

    /// Runs the observer for `seconds` from `start_c` (°C) beside a joint that starts with `warmth`.
    pub fn run(
        &self,
        settings: ObserverSettings,
        warmth: JointWarmth,
        start_c: f64,
        seconds: f64,
        seed: u64,
    ) -> Result<ObserverTrace, ThermalSettingsError> {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut observer = TemperatureObserver::new(self.model, settings, start_c)?;
        // The low-pass lets a contact pass for a second more.
        let mut gate = ContactGate::new(ContactSettings { hold_s: 5.0, ..ContactSettings::default() })?;
        let (law, dt) = (*self.model.law(), 1.0 / RATE_HZ);
        let share = -(-GATE_CORNER_RAD_S * dt).exp_m1();
        let (mut warmth, mut slow_nm, mut slow_slope) = (warmth, 0.0, 0.0);
        let mut trace = ObserverTrace::default();
        for k in 0..(seconds * RATE_HZ) as usize {
            let t = k as f64 * dt;
            let qd = self.velocity(t);
            let (push_nm, [from, to]) = self.disturbance;
            let noise = self.noise_sd_nm * rng.sample::<f64, _>(StandardNormal);
            let push = if (from..to).contains(&t) { push_nm } else { 0.0 };
            let measured_nm = self.truth.friction_nm(qd, warmth.gear_c) + push + noise;
            let temperature = observer.temperature_c();
            let (predicted_nm, slope_nm_per_k) = (law.torque_nm(qd, temperature), law.slope_nm_per_k(qd, temperature));
            // Joints that stick say nothing: simoni2019, after figure 15.
            let slides = qd.abs() > 0.03;
            if slides {
                slow_nm += share * (measured_nm - predicted_nm - slow_nm);
                slow_slope += share * (slope_nm_per_k - slow_slope);
            }
            let error = (settings.model_error * predicted_nm).powi(2) + settings.friction_sd_nm.powi(2);
            let white = self.noise_sd_nm.powi(2) * share / (2.0 - share);
            let variance = white + error + slow_slope * slow_slope * observer.variance_k2();
            let was_free = gate.is_free();
            let free = gate.step(slow_nm * slow_nm / variance, 0.0, dt) || !self.gated;
            if self.gated && was_free && !free {
                observer.forget_window();
            }
            observer.warm(predicted_nm * qd, self.room_c, dt);
            if free && slides {
                let noise_variance_nm2 = self.noise_sd_nm.powi(2);
                observer.correct(&FrictionSample { measured_nm, predicted_nm, slope_nm_per_k, noise_variance_nm2 }, dt);
            }
            warmth = self.truth.warmed(warmth, qd, self.room_c, dt);
            trace.time_s.push(t);
            trace.estimated_c.push(observer.temperature_c());
            trace.true_c.push(self.equivalent_c(warmth));
        }
        Ok(trace)
    }
}

/// Temperature (°C) at which the polynomial part of the model's friction is the true one. A temperature that nobody measures has
/// no unit of its own: α (T − T0) is what a friction torque shows, and the fit of a joint with two thermal masses by one
/// settles on another α.
pub(super) fn equivalent_c(truth: &WarmJoint, model: &ThermalJoint, warmth: JointWarmth) -> f64 {
    let law = model.law();
    let factor = 1.0 + truth.polynomial_slope_per_k * (warmth.gear_c - truth.reference_c);
    law.reference_c + (factor - law.polynomial.level) / law.polynomial.slope_per_k
}
