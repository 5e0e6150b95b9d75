//! The size that gives a hidden torque its strength.

use nalgebra::SVector;
use tribo_logs::RobotLog;
use tribo_sim::{Effect, ExtraTorque, Recorder, Recording, RecordingError};

use super::Scenario;
use super::drawn_effect::DrawnEffect;
use super::outside::Outside;
use super::world::Reality;

/// Band of the noise that strengths refer to (Hz).
pub const NOISE_BAND_HZ: f64 = 10.0;
/// Rate of the noise-free logs that strengths are computed on (Hz).
const RATE_HZ: f64 = 200.0;
/// Bisections of sizes that the torque is not proportional to.
const BISECTIONS: usize = 6;

/// A size, the strength it has, and whether the plausible range cut it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibrated {
    /// Size.
    pub size: f64,
    /// RMS over noise [-].
    pub strength: f64,
    /// Whether the strength that was asked for is out of reach.
    pub clamped: bool,
}

impl Scenario {
    /// White torque noise in the band (Nm): `sd √(2 band/rate)`.
    pub fn torque_noise_nm(&self) -> f64 {
        self.recording.torque_sd_nm * (2.0 * NOISE_BAND_HZ / self.recording.rate_hz).min(1.0).sqrt()
    }

    /// Noise of `theta − q` in the band (rad).
    fn deflection_noise_rad(&self) -> f64 {
        let recording = &self.recording;
        let lattice = recording.encoder_resolution_rad / 12.0_f64.sqrt();
        let sd = recording.encoder_sd_rad.hypot(recording.motor_encoder_sd_rad).hypot(2.0_f64.sqrt() * lattice);
        sd * (2.0 * NOISE_BAND_HZ / recording.rate_hz).min(1.0).sqrt()
    }

    /// One log per motion of the real arm with effects and perhaps another torque.
    pub(super) fn logs(
        &self,
        effects: &[Effect],
        outside: Option<&Outside>,
        recording: Recording,
        seed: u64,
    ) -> Result<Vec<RobotLog>, RecordingError> {
        self.logs_of(&self.reality, effects, outside, recording, seed)
    }

    /// The same of another arm.
    pub(super) fn logs_of(
        &self,
        reality: &Reality,
        effects: &[Effect],
        outside: Option<&Outside>,
        recording: Recording,
        seed: u64,
    ) -> Result<Vec<RobotLog>, RecordingError> {
        let mut truth = reality.truth.clone();
        truth.effects.extend(effects.iter().cloned());
        let smoothing_rad_s = self.nominal.smoothing_rad_s;
        let motions = self.motions.iter().enumerate();
        motions
            .map(|(index, motion)| {
                let stranger = outside.map(|outside| outside.torque(&self.nominal, motion.as_ref()));
                let torque = |t: f64, q: &SVector<f64, 7>, qd: &SVector<f64, 7>, qdd: &SVector<f64, 7>| {
                    let soft = reality.soft.map_or_else(SVector::zeros, |soft| soft.torque(qd, qdd));
                    soft + stranger.as_ref().map_or_else(SVector::zeros, |stranger| stranger(t, q, qd, qdd))
                };
                let extra: Option<&ExtraTorque<'_, 7>> =
                    (reality.soft.is_some() || stranger.is_some()).then_some(&torque);
                let recorder = Recorder { truth: &truth, smoothing_rad_s, recording, extra };
                let seed = seed.wrapping_add(index as u64);
                match &self.session {
                    Some(session) => recorder.record_session(motion.as_ref(), session, seed),
                    None => recorder.record(motion.as_ref(), seed),
                }
            })
            .collect()
    }

    /// Logs without noise for strengths, with these effects or torque.
    fn clean(&self, effects: &[Effect], outside: Option<&Outside>) -> Result<Vec<RobotLog>, RecordingError> {
        let recording = self.recording.noise_free();
        self.logs(effects, outside, Recording { rate_hz: recording.rate_hz.min(RATE_HZ), ..recording }, 0)
    }

    /// The size at which the drawn effect has the strength.
    pub(super) fn calibrate(&self, drawn: &DrawnEffect, strength: f64) -> Result<Calibrated, RecordingError> {
        let plain = self.clean(&[], None)?;
        let strength_at = |size: f64| -> Result<f64, RecordingError> {
            let with = self.clean(&[drawn.sized(size)], None)?;
            Ok(if drawn.seen_by_encoders {
                deflection_rms(&with) / self.deflection_noise_rad()
            } else {
                torque_rms(&with, &plain) / self.torque_noise_nm()
            })
        };
        let [least, most] = drawn.sizes;
        if drawn.carried_by_friction_of.is_some() {
            // Dry friction, and what a bristle makes of it, is proportional to the friction of the joint.
            let own = strength_at(1.0)?;
            let asked = strength / own.max(1e-12);
            let size = asked.clamp(least, most);
            return Ok(Calibrated { size, strength: own * size, clamped: size != asked });
        }
        if drawn.seen_by_encoders {
            // Every plausible size is plain to see: strength picks its third of the range.
            let third = strength.clamp(0.5, 10.0).ln() - 0.5_f64.ln();
            let share = third / (10.0_f64.ln() - 0.5_f64.ln());
            let size = least * (most / least).powf(share);
            let reached = strength_at(size)?;
            return Ok(Calibrated { size, strength: reached, clamped: (reached / strength).ln().abs() > 0.3 });
        }
        if drawn.proportional {
            let probe = if least > 0.0 { (least * most).sqrt() } else { 0.05 * most };
            let asked = probe * strength / strength_at(probe)?.max(1e-12);
            let size = asked.clamp(least, most);
            return Ok(Calibrated { size, strength: strength_at(size)?, clamped: size != asked });
        }
        // Strength grows with size.
        let (mut low, mut high) = (least, most);
        for (end, reached) in [(least, strength_at(least)?), (most, strength_at(most)?)] {
            if (end == least && reached >= strength) || (end == most && reached <= strength) {
                return Ok(Calibrated { size: end, strength: reached, clamped: true });
            }
        }
        for _ in 0..BISECTIONS {
            let middle = (low * high).sqrt();
            if strength_at(middle)? < strength { low = middle } else { high = middle }
        }
        let size = (low * high).sqrt();
        Ok(Calibrated { size, strength: strength_at(size)?, clamped: false })
    }

    /// The amplitude at which a torque outside the vocabulary has the strength.
    pub(super) fn calibrate_outside(&self, outside: &Outside, strength: f64) -> Result<Calibrated, RecordingError> {
        let plain = self.clean(&[], None)?;
        let strength_at = |size: f64| -> Result<f64, RecordingError> {
            Ok(torque_rms(&self.clean(&[], Some(&outside.sized(size)))?, &plain) / self.torque_noise_nm())
        };
        // Nearly in proportion: a dead zone is not quite.
        let mut size = 0.05;
        for _ in 0..3 {
            size *= strength / strength_at(size)?.max(1e-9);
        }
        Ok(Calibrated { size, strength: strength_at(size)?, clamped: false })
    }
}

/// RMS of the difference of the torques over all logs, of the joint where it is largest (Nm).
fn torque_rms(with: &[RobotLog], without: &[RobotLog]) -> f64 {
    let joints = with.first().map_or(0, |log| log.tau_j_nm.len());
    let rms = |j: usize| {
        let (mut sum, mut count) = (0.0, 0);
        for (a, b) in with.iter().zip(without) {
            sum += a.tau_j_nm[j].iter().zip(&b.tau_j_nm[j]).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            count += a.tau_j_nm[j].len();
        }
        (sum / count.max(1) as f64).sqrt()
    };
    (0..joints).map(rms).fold(0.0, f64::max)
}

/// RMS of theta − q over all logs, of the joint where it is largest (rad).
fn deflection_rms(logs: &[RobotLog]) -> f64 {
    let joints = logs.first().map_or(0, |log| log.q_rad.len());
    let rms = |j: usize| {
        let pairs = logs.iter().filter_map(|log| Some((log.theta_rad.as_ref()?, &log.q_rad)));
        let squares: Vec<f64> =
            pairs.flat_map(|(theta, q)| theta[j].iter().zip(&q[j]).map(|(a, b)| (a - b).powi(2))).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
    };
    (0..joints).map(rms).fold(0.0, f64::max)
}
