//! Noise settings of the wrench filter.

use serde::{Deserialize, Serialize};

/// What the filter believes the tool's acceleration to be without a wrench.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum KnownInput {
    /// From the torque that was really sent: `u = J B⁻¹(tau − tau_f_hat − bias) + J̇ qd`. Right under saturation too.
    #[default]
    AppliedTorque,
    /// The impedance acceleration that was asked for, `u = −M⁻¹(D v + K e)` (the paper's form).
    CommandedAcceleration,
}

/// Covariance of the pose measured through the encoders.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MeasurementNoise {
    /// The same standard deviation on all axes.
    Diagonal {
        /// Of the position (m).
        position_m: f64,
        /// Of the orientation (rad).
        rotation_rad: f64,
    },
    /// `R = σ² J Jᵀ`: exact for independent encoder noise of standard deviation σ.
    Encoder {
        /// Of one encoder (rad).
        sd_rad: f64,
    },
}

/// Settings of [`crate::WrenchEkf`]. Spectral densities are those of white noise; freeze them before tuning anything.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WrenchEkfSettings {
    /// Where the known acceleration comes from.
    pub known_input: KnownInput,
    /// Noise of the measured pose.
    pub measurement: MeasurementNoise,
    /// Linear acceleration noise [m/s²/√Hz].
    pub acceleration_noise_m_s2: f64,
    /// Angular acceleration noise [rad/s²/√Hz].
    pub acceleration_noise_rad_s2: f64,
    /// Force random walk [N/√s].
    pub force_walk_n: f64,
    /// Moment random walk [Nm/√s].
    pub moment_walk_nm: f64,
    /// Standard deviation of the force at the start (N).
    pub initial_force_sd_n: f64,
    /// Standard deviation of the moment at the start (Nm).
    pub initial_moment_sd_nm: f64,
}

impl Default for WrenchEkfSettings {
    /// Random walks of 5 N/√s and 1 Nm/√s: 12.5 / 13.3 Hz bandwidth, 0.12 N / 0.03 Nm noise floor with 1e-5 rad encoders.
    fn default() -> Self {
        Self {
            known_input: KnownInput::AppliedTorque,
            measurement: MeasurementNoise::Diagonal { position_m: 1e-5, rotation_rad: 2e-5 },
            acceleration_noise_m_s2: 0.002,
            acceleration_noise_rad_s2: 0.01,
            force_walk_n: 5.0,
            moment_walk_nm: 1.0,
            initial_force_sd_n: 5.0,
            initial_moment_sd_nm: 1.0,
        }
    }
}
