//! The `limits` section of a model file.

use nalgebra::SVector;
use serde::{Deserialize, Serialize};
use tribo_robot::Limits;

use crate::FieldError;

/// `limits: {q_min_rad, …}`: those given take the place of the robot's, one value per joint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitsSection {
    /// Lower joint limits (rad).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub q_min_rad: Option<Vec<f64>>,
    /// Upper joint limits (rad).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub q_max_rad: Option<Vec<f64>>,
    /// Speed limits [rad/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub qd_max_rad_s: Option<Vec<f64>>,
    /// Torque limits (Nm).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tau_max_nm: Option<Vec<f64>>,
    /// Torque-rate limits [Nm/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tau_rate_max_nm_s: Option<Vec<f64>>,
}

impl LimitsSection {
    /// Puts what is given in the place of an arm's limits.
    pub(crate) fn put_over<const N: usize>(&self, limits: &mut Limits<N>) -> Result<(), FieldError> {
        let given = [
            ("limits.q_min_rad", &self.q_min_rad, &mut limits.q_min_rad, -1e3),
            ("limits.q_max_rad", &self.q_max_rad, &mut limits.q_max_rad, -1e3),
            ("limits.qd_max_rad_s", &self.qd_max_rad_s, &mut limits.qd_max_rad_s, 1e-3),
            ("limits.tau_max_nm", &self.tau_max_nm, &mut limits.tau_max_nm, 1e-3),
            ("limits.tau_rate_max_nm_s", &self.tau_rate_max_nm_s, &mut limits.tau_rate_max_nm_s, 1e-3),
        ];
        for (field, given, place, low) in given {
            if let Some(values) = given {
                *place = per_joint(field, values, low, 1e6)?;
            }
        }
        match (0..N).find(|&j| limits.q_min_rad[j] >= limits.q_max_rad[j]) {
            Some(j) => {
                let allowed = format!("below {}, the upper limit of joint {j}", limits.q_max_rad[j]);
                Err(FieldError::new("limits.q_min_rad", limits.q_min_rad[j], allowed))
            }
            None => Ok(()),
        }
    }
}

/// N values, each within [low, high].
pub(crate) fn per_joint<const N: usize>(
    field: &str,
    values: &[f64],
    low: f64,
    high: f64,
) -> Result<SVector<f64, N>, FieldError> {
    if values.len() != N {
        return Err(FieldError::new(field, format!("{} entries", values.len()), format!("{N} entries")));
    }
    for &value in values {
        FieldError::check(field, value, low, high)?;
    }
    Ok(SVector::from_column_slice(values))
}
