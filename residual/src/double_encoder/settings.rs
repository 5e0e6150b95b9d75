//! What is calibrated, and how the estimator runs.

use crate::OBSERVER_GAIN_RAD_S;
use serde::{Deserialize, Serialize};

use super::CalibrationError;

/// What the deflection without load is before anything is learnt of it: m(x) of eqs. (9) and (10).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DeflectionMean {
    /// Nothing, eq. (12): the arm's masses are not known.
    Zero,
    /// The deflection by the gravity torque of the model, g(G(q)): only what the model lacks is learnt.
    RigidBody,
}

/// Settings of the calibration and of the estimator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DoubleEncoderSettings {
    /// Mean of the Gaussian process.
    pub mean: DeflectionMean,
    /// Whether the direction from which a joint came is an input of its process.
    pub direction_input: bool,
    /// Whether the branch of the gear's hysteresis is an input.
    pub loading_input: bool,
    /// Whether the stiffness curve is that of the whole load: the deflection without contact says where on it a joint is.
    /// The paper's curve starts at zero whatever gravity does.
    pub preload: bool,
    /// Half-width of the memory of the direction (rad); above encoder noise, below a stroke. Default 2e-3.
    pub direction_travel_rad: f64,
    /// Half-width of the memory of the loading (rad); a few times the noise of the filtered deflection. Default 2e-5.
    pub loading_travel_rad: f64,
    /// Inducing points per joint of the process inside the tick. Default 128.
    pub inducing: usize,
    /// Rests to which hyper-parameters are fitted before the whole set. Default 480.
    pub coarse: usize,
    /// Gain of the observer that filters the torque (rad/s). Default 50, as the momentum estimator.
    pub gain_rad_s: f64,
    /// Force (N) beyond which a direction that the joints cannot see is cut off. Default 500.
    pub force_damping_n: f64,
    /// The same for the moment (Nm). Default 100.
    pub moment_damping_nm: f64,
    /// Noise of one reading of one encoder (rad). Default 1e-5.
    pub encoder_sd_rad: f64,
    /// Noise of the velocity signal (rad/s). Default 3e-3.
    pub velocity_sd_rad_s: f64,
}

impl Default for DoubleEncoderSettings {
    /// The model's gravity as the mean, and everything that uhlmann2023 propose as extensions.
    fn default() -> Self {
        Self {
            mean: DeflectionMean::RigidBody,
            direction_input: true,
            loading_input: true,
            preload: true,
            direction_travel_rad: 2e-3,
            loading_travel_rad: 2e-5,
            inducing: 128,
            coarse: 480,
            gain_rad_s: OBSERVER_GAIN_RAD_S,
            force_damping_n: 500.0,
            moment_damping_nm: 100.0,
            encoder_sd_rad: 1e-5,
            velocity_sd_rad_s: 3e-3,
        }
    }
}

impl DoubleEncoderSettings {
    /// The paper as it stands: joint angles as the only inputs, zero mean, a stiffness curve from zero.
    pub fn paper() -> Self {
        Self {
            mean: DeflectionMean::Zero,
            direction_input: false,
            loading_input: false,
            preload: false,
            ..Self::default()
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`CalibrationError::BadSetting`] names the first field outside its range.
    pub fn validate(self) -> Result<ValidDoubleEncoder, CalibrationError> {
        let checks = [
            ("direction_travel_rad", self.direction_travel_rad, 1e-6, 1.0, "1e-6 to 1 rad"),
            ("loading_travel_rad", self.loading_travel_rad, 1e-8, 1e-1, "1e-8 to 0.1 rad"),
            ("inducing", self.inducing as f64, 1.0, 2000.0, "1 to 2000"),
            ("coarse", self.coarse as f64, 20.0, 1e5, "20 to 100000"),
            ("gain_rad_s", self.gain_rad_s, 0.1, 1e4, "0.1 to 1e4 rad/s"),
            ("force_damping_n", self.force_damping_n, 1e-3, 1e9, "1e-3 to 1e9 N"),
            ("moment_damping_nm", self.moment_damping_nm, 1e-3, 1e9, "1e-3 to 1e9 Nm"),
            ("encoder_sd_rad", self.encoder_sd_rad, 1e-9, 1e-1, "1e-9 to 0.1 rad"),
            ("velocity_sd_rad_s", self.velocity_sd_rad_s, 0.0, 10.0, "0 to 10 rad/s"),
        ];
        for (field, value, least, most, allowed) in checks {
            if !(least..=most).contains(&value) {
                return Err(CalibrationError::BadSetting { field, value, allowed });
            }
        }
        Ok(ValidDoubleEncoder(self))
    }
}

/// Settings of which every field is in its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidDoubleEncoder(DoubleEncoderSettings);

impl std::ops::Deref for ValidDoubleEncoder {
    type Target = DoubleEncoderSettings;

    fn deref(&self) -> &DoubleEncoderSettings {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_outside_its_range_is_named() {
        assert!(DoubleEncoderSettings::default().validate().is_ok());
        assert!(DoubleEncoderSettings::paper().validate().is_ok());
        let wrong = DoubleEncoderSettings { gain_rad_s: f64::NAN, ..DoubleEncoderSettings::default() };
        assert!(matches!(wrong.validate(), Err(CalibrationError::BadSetting { field: "gain_rad_s", .. })));
    }
}
