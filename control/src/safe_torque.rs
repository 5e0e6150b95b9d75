//! What is sent when the controller must not be trusted.

use nalgebra::SVector;
use tribo_robot::{Arm, gravity_torque};

/// Safe torque `tau = g(q) − d qd`: hold the arm's weight and brake, from the last state that made sense.
///
/// Non-finite input leaves the remembered state as it was, so the torque is finite whatever comes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SafeTorque<const N: usize> {
    damping_nm_s_per_rad: f64,
    q: SVector<f64, N>,
}

impl<const N: usize> SafeTorque<N> {
    /// Starts from a configuration known to be right. Braking constant 5 Nm s/rad.
    pub fn new(q: SVector<f64, N>) -> Self {
        Self { damping_nm_s_per_rad: 5.0, q }
    }

    /// Remembers a configuration that made sense (q (rad)).
    #[inline]
    pub fn remember(&mut self, q: &SVector<f64, N>) {
        self.q = *q;
    }

    /// Gravity torque (Nm) of the remembered configuration: that within the last safe torque.
    pub fn gravity(&self, arm: &Arm<N>) -> SVector<f64, N> {
        gravity_torque(arm, &self.q)
    }

    /// The safe torque (Nm) at the measured state (q (rad), qd [rad/s]), within the torque limits.
    #[inline]
    pub fn torque(&mut self, arm: &Arm<N>, q: &SVector<f64, N>, qd: &SVector<f64, N>) -> SVector<f64, N> {
        if q.iter().all(|x| x.is_finite()) {
            self.q = *q;
        }
        let gravity = self.gravity(arm);
        SVector::from_fn(|j, _| {
            let brake = if qd[j].is_finite() { -self.damping_nm_s_per_rad * qd[j] } else { 0.0 };
            let limit = arm.limits.tau_max_nm[j];
            (gravity[j] + brake).max(-limit).min(limit)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;

    #[test]
    fn is_finite_whatever_comes_in() {
        let arm = presets::panda();
        let ready = presets::panda_ready_pose();
        let mut safe = SafeTorque::new(ready);
        let nan = SVector::repeat(f64::NAN);
        assert!((safe.torque(&arm, &nan, &nan) - gravity_torque(&arm, &ready)).amax() < 1e-12);
        let fast = SVector::repeat(f64::INFINITY);
        assert!(safe.torque(&arm, &ready, &fast).iter().all(|tau| tau.is_finite()));
        assert!(
            safe.torque(&arm, &ready, &SVector::repeat(1e9))
                .iter()
                .zip(arm.limits.tau_max_nm.iter())
                .all(|(tau, max)| tau.abs() <= *max)
        );
    }
}
