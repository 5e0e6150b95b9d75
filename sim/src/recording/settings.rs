//! How a log is taken.

use thiserror::Error;
use tribo_files::LogError;

use crate::{EffectError, TorqueSide};

/// Sensors, clock and columns of a log. Noise is white and normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recording {
    /// Rows per second (Hz).
    pub rate_hz: f64,
    /// Deviation of the sampling instants from the regular grid (s); the stamps tell the truth about it.
    pub sampling_jitter_sd_s: f64,
    /// Deviation of the stamps from the sampling instants (s): the stamps are wrong by it.
    pub stamp_jitter_sd_s: f64,
    /// Share of the rows that repeat the values of the row before under their own stamp [-].
    pub repeated_fraction: f64,
    /// Standard deviation of the encoder noise (rad).
    pub encoder_sd_rad: f64,
    /// Encoder resolution (rad); 0 is infinitely fine.
    pub encoder_resolution_rad: f64,
    /// Standard deviation of the torque noise (Nm).
    pub torque_sd_nm: f64,
    /// Resolution of the torque signal (Nm); 0 is infinitely fine.
    pub torque_resolution_nm: f64,
    /// Side of the gears of the torque signal. Link side leaves out rotor inertia, and keeps friction: on real arms a part
    /// of it sits behind the sensor.
    pub torque_side: TorqueSide,
    /// Cut-off of the first-order filter on the differentiated position (Hz).
    pub velocity_cutoff_hz: f64,
    /// Second encoder: `q` is the link and `theta` the motor. Without it `q` is the motor.
    pub dual_encoder: bool,
    /// Standard deviation of the noise of `theta` (rad).
    pub motor_encoder_sd_rad: f64,
    /// Lateness of `theta` against `q` (s).
    pub encoder_skew_s: f64,
    /// Rise and fall of an external contact (s), inside its window; at least 20 ms if a joint is elastic.
    pub contact_edge_s: f64,
    /// Temperature columns: of every joint and of the room.
    pub temperatures: bool,
    /// Temperature of the room [°C].
    pub ambient_c: f64,
    /// Temperature rise of a joint that has warmed up (K).
    pub warm_rise_k: f64,
}

impl Default for Recording {
    /// 500 Hz and the noise of [`crate::Sensors`]; one encoder, motor torques, no temperatures, nothing irregular.
    fn default() -> Self {
        Self {
            rate_hz: 500.0,
            sampling_jitter_sd_s: 0.0,
            stamp_jitter_sd_s: 0.0,
            repeated_fraction: 0.0,
            encoder_sd_rad: 1e-5,
            encoder_resolution_rad: 0.0,
            torque_sd_nm: 0.05,
            torque_resolution_nm: 0.0,
            torque_side: TorqueSide::Motor,
            velocity_cutoff_hz: 50.0,
            dual_encoder: false,
            motor_encoder_sd_rad: 1e-5,
            encoder_skew_s: 0.0,
            contact_edge_s: 0.02,
            temperatures: false,
            ambient_c: 22.0,
            warm_rise_k: 12.0,
        }
    }
}

impl Recording {
    /// The same recording without noise, jitter, quantisation and repeated rows.
    pub fn noise_free(self) -> Self {
        Self {
            sampling_jitter_sd_s: 0.0,
            stamp_jitter_sd_s: 0.0,
            repeated_fraction: 0.0,
            encoder_sd_rad: 0.0,
            encoder_resolution_rad: 0.0,
            torque_sd_nm: 0.0,
            torque_resolution_nm: 0.0,
            motor_encoder_sd_rad: 0.0,
            ..self
        }
    }

    pub(super) fn validate(&self) -> Result<(), RecordingError> {
        let not_negative = (0.0, f64::MAX, "0 and above");
        let bounds = [
            ("rate_hz", self.rate_hz, (1.0, 10_000.0, "1..10000")),
            ("sampling_jitter_sd_s", self.sampling_jitter_sd_s, not_negative),
            ("stamp_jitter_sd_s", self.stamp_jitter_sd_s, not_negative),
            ("repeated_fraction", self.repeated_fraction, (0.0, 0.9, "0..0.9")),
            ("encoder_sd_rad", self.encoder_sd_rad, not_negative),
            ("encoder_resolution_rad", self.encoder_resolution_rad, not_negative),
            ("torque_sd_nm", self.torque_sd_nm, not_negative),
            ("torque_resolution_nm", self.torque_resolution_nm, not_negative),
            ("velocity_cutoff_hz", self.velocity_cutoff_hz, (0.1, f64::MAX, "0.1 and above")),
            ("motor_encoder_sd_rad", self.motor_encoder_sd_rad, not_negative),
            ("encoder_skew_s", self.encoder_skew_s, (-0.1, 0.1, "-0.1..0.1")),
            ("contact_edge_s", self.contact_edge_s, (0.0, 10.0, "0..10")),
            ("ambient_c", self.ambient_c, (-100.0, 200.0, "-100..200")),
            ("warm_rise_k", self.warm_rise_k, (-200.0, 200.0, "-200..200")),
        ];
        for (field, value, (least, most, allowed)) in bounds {
            in_range(field, value, least, most, allowed)?;
        }
        Ok(())
    }
}

/// Why a log could not be made.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// A setting lies outside its range.
    #[error("{field}: {value} is outside {allowed}")]
    OutOfRange {
        /// Name of the setting.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The allowed range.
        allowed: &'static str,
    },
    /// A hidden effect cannot be simulated.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// The columns make no log.
    #[error(transparent)]
    Log(#[from] LogError),
}

pub(super) fn in_range(
    field: &'static str,
    value: f64,
    least: f64,
    most: f64,
    allowed: &'static str,
) -> Result<(), RecordingError> {
    if value >= least && value <= most { Ok(()) } else { Err(RecordingError::OutOfRange { field, value, allowed }) }
}
