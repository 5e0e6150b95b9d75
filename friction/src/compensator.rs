//! The friction compensator: a law, evaluated at the velocity one chooses to believe.

use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use crate::FrictionModel;

/// Which velocity the compensator believes near zero speed. This matters more than the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VelocitySource {
    /// The measured velocity (roveda2022). Below about two standard deviations of its noise the sign means nothing, so it
    /// is smoothed over 0.005 rad/s.
    Measured,
    /// The velocity of the nominal impedance model. Feed-forward: cannot go unstable, wrong while someone pushes the arm.
    Reference,
    /// The measured velocity where it is credible, the reference model's elsewhere.
    #[default]
    Hybrid,
}

/// Friction compensation torque `tau_f_hat = law(qd_believed)`.
///
/// ```text
/// measured:  qd_believed = qd_measured,                                   sign smoothed over 0.005 rad/s
/// reference: qd_believed = qd_reference,                                  sign smoothed over 0.001 rad/s
/// hybrid:    qd_measured where |qd_measured| > threshold, else qd_reference,  smoothed over 0.001 rad/s
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensator<const N: usize> {
    /// The friction believed to act.
    pub friction: FrictionModel<N>,
    /// The velocity believed near zero.
    pub source: VelocitySource,
    /// Width of the smooth sign [rad/s].
    pub smoothing_rad_s: f64,
    /// Speed above which the hybrid source trusts the measurement [rad/s]: four standard deviations of its noise.
    pub hybrid_threshold_rad_s: f64,
}

impl<const N: usize> Compensator<N> {
    /// Four standard deviations of the 50 Hz velocity signal of a 1e-5 rad encoder (2.9e-3 rad/s).
    pub const DEFAULT_HYBRID_THRESHOLD_RAD_S: f64 = 0.012;

    /// Compensator with the smoothing that suits the source.
    pub fn new(friction: FrictionModel<N>, source: VelocitySource) -> Self {
        let smoothing_rad_s = match source {
            VelocitySource::Measured => 0.005,
            VelocitySource::Reference | VelocitySource::Hybrid => 0.001,
        };
        Self { friction, source, smoothing_rad_s, hybrid_threshold_rad_s: Self::DEFAULT_HYBRID_THRESHOLD_RAD_S }
    }

    /// Compensation torque (Nm) from the measured and the reference joint velocity [rad/s].
    #[inline]
    pub fn torque(&self, qd_measured: &SVector<f64, N>, qd_reference: &SVector<f64, N>) -> SVector<f64, N> {
        SVector::from_fn(|j, _| {
            let qd = self.believed(qd_measured[j], qd_reference[j]);
            self.friction.joints[j].torque(qd, self.smoothing_rad_s)
        })
    }

    #[inline]
    fn believed(&self, measured: f64, reference: f64) -> f64 {
        match self.source {
            VelocitySource::Measured => measured,
            VelocitySource::Reference => reference,
            VelocitySource::Hybrid if measured.abs() > self.hybrid_threshold_rad_s => measured,
            VelocitySource::Hybrid => reference,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::CoulombViscous;

    #[test]
    fn hybrid_believes_the_measurement_only_above_its_noise() {
        let friction =
            FrictionModel::<1>::uniform(CoulombViscous { coulomb_nm: 1.0, viscous_nm_s_per_rad: 0.0 }.into());
        let torque = |source, measured: f64, reference: f64| {
            Compensator::new(friction, source).torque(&SVector::from([measured]), &SVector::from([reference]))[0]
        };
        assert!(torque(VelocitySource::Hybrid, 0.011, -0.05) < -0.99);
        assert!(torque(VelocitySource::Hybrid, 0.013, -0.05) > 0.99);
        assert!(torque(VelocitySource::Reference, 1.0, -0.05) < -0.99);
        assert!((torque(VelocitySource::Measured, 0.005, -1.0) - 1.0f64.tanh()).abs() < 1e-12);
    }
}
