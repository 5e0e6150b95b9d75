//! Whether a trial ran with the compensator that was asked for.

use nalgebra::SVector;

use super::JudgeError;

/// Speed (rad/s) from which on measured and reference velocity say the same of friction.
const MOVING_RAD_S: f64 = 0.02;
/// Samples of a moving joint that tell enough.
const LEAST_SAMPLES: f64 = 50.0;
/// Difference that is allowed, over the larger of both RMS: the reference velocity of a controller is not quite the measured one.
const APART: f64 = 0.45;
/// The same of the scale between both, where nothing but a scale is between them.
const SCALED: f64 = 0.25;
/// What is left of the logged torque beside the scaled one, over its RMS, up to which that is so.
const BESIDE: f64 = 0.15;
/// Torque (Nm) that is as good as none.
const NONE_NM: f64 = 0.01;

/// What a log says that the compensator added, beside what the asked one adds at the speeds of the log.
pub(super) struct LoggedCompensation<const N: usize> {
    samples: SVector<f64, N>,
    logged: SVector<f64, N>,
    asked: SVector<f64, N>,
    product: SVector<f64, N>,
}

impl<const N: usize> LoggedCompensation<N> {
    pub fn new() -> Self {
        let zero = SVector::zeros();
        Self { samples: zero, logged: zero, asked: zero, product: zero }
    }

    /// One sample: velocity [rad/s], torque logged and torque of the asked compensator (Nm).
    pub fn add(&mut self, qd: &SVector<f64, N>, logged_nm: &SVector<f64, N>, asked_nm: &SVector<f64, N>) {
        for j in (0..N).filter(|j| qd[*j].abs() > MOVING_RAD_S) {
            self.samples[j] += 1.0;
            self.logged[j] += logged_nm[j].powi(2);
            self.asked[j] += asked_nm[j].powi(2);
            self.product[j] += logged_nm[j] * asked_nm[j];
        }
    }

    /// An error of the joint that is furthest off, if one is.
    pub fn is_the_asked_one(&self) -> Result<(), JudgeError> {
        let off = (0..N).filter(|j| self.samples[*j] >= LEAST_SAMPLES).map(|joint| {
            let (logged, asked, product) = (self.logged[joint], self.asked[joint], self.product[joint]);
            let rms = |sum: f64| (sum.max(0.0) / self.samples[joint]).sqrt();
            let [logged_nm, asked_nm, apart_nm] = [logged, asked, logged + asked - 2.0 * product].map(rms);
            let apart = apart_nm / logged_nm.max(asked_nm).max(NONE_NM);
            // Least squares of the logged torque on the asked one: scale, and what is beside it.
            let scale = product / asked.max(f64::MIN_POSITIVE);
            let beside_nm = rms(logged - scale * product);
            let scaled = (scale - 1.0).abs() > SCALED && asked_nm > NONE_NM && beside_nm < BESIDE * logged_nm;
            (apart, scaled, JudgeError::OtherCompensation { joint, logged_nm, asked_nm, apart_nm })
        });
        match off.filter(|(apart, scaled, _)| *apart > APART || *scaled).max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((.., error)) => Err(error),
            None => Ok(()),
        }
    }
}
