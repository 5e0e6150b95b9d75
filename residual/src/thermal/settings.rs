//! Settings of the thermal virtual sensor.

use crate::momentum::{OBSERVER_GAIN_RAD_S, PANDA_TORQUE_SD_NM, PANDA_VELOCITY_SD_RAD_S};
use nalgebra::SVector;
use tribo_friction::FrictionModel;
use tribo_friction::thermal::{HeatBalance, ThermalJoint, ThermalLaw};

use super::{ContactSettings, ObserverSettings, ThermalSettingsError};

/// Settings of [`super::ThermalEstimator`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalSettings<const N: usize> {
    /// Friction and heat of each joint.
    pub joints: [ThermalJoint; N],
    /// Temperature of the room (°C).
    pub ambient_c: f64,
    /// Temperature of each joint at a reset (°C).
    pub initial_c: SVector<f64, N>,
    /// Gain K of the momentum observer (rad/s).
    pub gain_rad_s: f64,
    /// White noise of the torque, per sample (Nm).
    pub torque_sd_nm: SVector<f64, N>,
    /// Noise of the velocity signal (rad/s); up to three of it the sign of the friction is in doubt.
    pub velocity_sd_rad_s: SVector<f64, N>,
    /// Speed from which a joint's friction says something of its temperature (rad/s).
    pub sliding_rad_s: f64,
    /// Time between two samples of the temperature observers (s).
    pub observe_every_s: f64,
    /// The temperature observers. Their error of the law and of the friction is also that of the wrench.
    pub observer: ObserverSettings,
    /// When the arm counts as free.
    pub contact: ContactSettings,
    /// Force (N) beyond which a direction that the joints cannot see is cut off.
    pub force_damping_n: f64,
    /// The same for the moment (Nm).
    pub moment_damping_nm: f64,
}

impl<const N: usize> ThermalSettings<N> {
    /// Joints as identified, in a room of `ambient_c` (°C) and as warm as it until they show otherwise. K, noise and damping
    /// as in [`crate::MomentumSettings::new`]; N = 40 samples of 5 ms make an RMS over 0.2 s, a part of a stroke.
    pub fn new(joints: [ThermalJoint; N], ambient_c: f64) -> Self {
        Self {
            joints,
            ambient_c,
            initial_c: SVector::repeat(ambient_c),
            gain_rad_s: OBSERVER_GAIN_RAD_S,
            torque_sd_nm: SVector::repeat(PANDA_TORQUE_SD_NM),
            velocity_sd_rad_s: SVector::repeat(PANDA_VELOCITY_SD_RAD_S),
            sliding_rad_s: 0.03,
            observe_every_s: 5e-3,
            observer: ObserverSettings::default(),
            contact: ContactSettings::default(),
            force_damping_n: 500.0,
            moment_damping_nm: 100.0,
        }
    }

    /// A believed friction of which no dependence on temperature is known: T has no effect, and the estimate is that of the
    /// friction law alone. Heat as that of [`HeatBalance::SIMONI2019`], for want of better; 22 °C.
    ///
    /// # Errors
    /// A law whose numbers are not finite.
    pub fn without_temperature(friction: &FrictionModel<N>) -> Result<Self, tribo_friction::thermal::ThermalError> {
        let joint = |j: usize| {
            ThermalJoint::new(ThermalLaw::without_temperature(friction.joints[j].into()), HeatBalance::SIMONI2019)
        };
        // Array::try_map is not stable: the first joint stands in until its own is checked.
        let mut joints = [joint(0)?; N];
        for (j, slot) in joints.iter_mut().enumerate() {
            *slot = joint(j)?;
        }
        Ok(Self::new(joints, 22.0))
    }

    pub(super) fn validate(&self) -> Result<(), ThermalSettingsError> {
        let check = ThermalSettingsError::check;
        check("ambient_c", self.ambient_c, (-60.0..=100.0).contains(&self.ambient_c), "-60 to 100 °C")?;
        let positive = [
            ("gain_rad_s", self.gain_rad_s),
            ("sliding_rad_s", self.sliding_rad_s),
            ("observe_every_s", self.observe_every_s),
            ("force_damping_n", self.force_damping_n),
            ("moment_damping_nm", self.moment_damping_nm),
        ];
        for (field, value) in positive {
            check(field, value, value > 0.0 && value <= 1e6, "above 0, up to 1e6")?;
        }
        for j in 0..N {
            let (tau, qd) = (self.torque_sd_nm[j], self.velocity_sd_rad_s[j]);
            check("torque_sd_nm", tau, tau > 0.0 && tau <= 1e3, "above 0, up to 1e3 Nm")?;
            check("velocity_sd_rad_s", qd, (0.0..=10.0).contains(&qd), "0 to 10 rad/s")?;
        }
        Ok(())
    }
}
