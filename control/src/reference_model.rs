//! The motion that the nominal impedance would make without friction.

use nalgebra::{Matrix3, Vector3, Vector6};
use tribo_robot::{Pose, so3};

use crate::ImpedanceSettings;
use crate::pose_error::pose_error;

/// Nominal impedance, integrated on its own (no feedback from the arm):
///
/// ```text
/// M ẍ_m + D ẋ_m + K (x_m ⊖ x_d) = 0
/// ```
///
/// Its velocity tells a friction compensator which way a joint is meant to move while the measured velocity is still
/// noise. Semi-implicit Euler; rotations on the group, error `log(R_m R_dᵀ)` in base axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceModel {
    position: Vector3<f64>,
    rotation: Matrix3<f64>,
    twist: Vector6<f64>,
}

impl ReferenceModel {
    /// At rest at `pose`.
    pub fn at_rest(pose: &Pose) -> Self {
        Self { position: pose.translation.vector, rotation: *pose.rotation.matrix(), twist: Vector6::zeros() }
    }

    /// Pose it has reached, `base_from_flange`.
    pub fn pose(&self) -> Pose {
        Pose::from_parts(self.position.into(), nalgebra::Rotation3::from_matrix_unchecked(self.rotation))
    }

    /// Advances by dt (s) towards the reference pose and returns the twist ẋ_m (angular part first, base axes).
    #[inline]
    pub fn step(&mut self, settings: &ImpedanceSettings, reference: &Pose, dt_s: f64) -> Vector6<f64> {
        let e = pose_error(&self.position, &self.rotation, reference);
        self.twist += settings.acceleration(&self.twist, &e) * dt_s;
        let w: Vector3<f64> = self.twist.fixed_rows::<3>(0) * dt_s;
        self.rotation = so3::renormalized(&(so3::exp(&w) * self.rotation));
        self.position += self.twist.fixed_rows::<3>(3) * dt_s;
        self.twist
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: step response of a damped second-order system, ζ = 0.75, ω = √(K/M).
    #[test]
    fn step_response_is_that_of_the_impedance() {
        let settings = ImpedanceSettings::default();
        let mut target = Pose::identity();
        target.translation.vector.x = 0.01;
        let mut model = ReferenceModel::at_rest(&Pose::identity());
        let dt = 1e-4;
        let (omega, zeta) = (250f64.sqrt(), 0.75f64);
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        for k in 1..=5000 {
            model.step(&settings, &target, dt);
            let t = k as f64 * dt;
            let envelope = (-zeta * omega * t).exp();
            let exact = 0.01 * (1.0 - envelope * ((damped * t).cos() + zeta * omega / damped * (damped * t).sin()));
            assert!((model.position.x - exact).abs() < 2e-5, "t {t}");
        }
    }
}
