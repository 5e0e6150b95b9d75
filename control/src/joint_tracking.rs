//! Stiff tracking of a joint-space motion.

use nalgebra::SVector;
use tribo_robot::ControlTerms;

/// Computed torque with a critically damped joint-space spring, one bandwidth ω for all joints:
///
/// ```text
/// tau = M(q)(qdd_d + 2 ω (qd_d − qd) + ω² (q_d − q)) + C qd + g + tau_f_hat
/// ```
///
/// Friction dFc that is not compensated holds the joint back by about `dFc/(M_jj ω²)`. Leaves out: limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTracking {
    /// Bandwidth ω [1/s].
    pub bandwidth_per_s: f64,
}

impl Default for JointTracking {
    /// 40 1/s: a Panda's joint with 0.5 Nm of unknown friction is off by a milliradian, and 3 mrad/s of noise on the
    /// velocity make 0.3 Nm on its heaviest joint.
    fn default() -> Self {
        Self { bandwidth_per_s: 40.0 }
    }
}

/// Where the joints are meant to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTarget<const N: usize> {
    /// Positions (rad).
    pub q: SVector<f64, N>,
    /// Velocities [rad/s].
    pub qd: SVector<f64, N>,
    /// Accelerations [rad/s²].
    pub qdd: SVector<f64, N>,
}

impl JointTracking {
    /// Torque without friction compensation (Nm), and the acceleration it asks for [rad/s²], for the measured state.
    #[inline]
    pub fn tick<const N: usize>(
        &self,
        terms: &ControlTerms<N>,
        q: &SVector<f64, N>,
        qd: &SVector<f64, N>,
        target: &JointTarget<N>,
    ) -> (SVector<f64, N>, SVector<f64, N>) {
        let omega = self.bandwidth_per_s;
        let qdd = target.qdd + (target.qd - qd) * (2.0 * omega) + (target.q - q) * (omega * omega);
        (terms.mass_matrix * qdd + terms.bias_nm(), qdd)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::{forward_dynamics, presets};

    /// Witness: forward dynamics under the torque gives the acceleration asked for, and an error decays as exp(−ω t)(1 + ω t).
    #[test]
    fn an_error_decays_at_the_bandwidth() {
        let (arm, tracking) = (presets::panda(), JointTracking::default());
        let target = JointTarget { q: presets::panda_ready_pose(), qd: SVector::zeros(), qdd: SVector::zeros() };
        let (mut q, mut qd) = (target.q.add_scalar(0.01), SVector::zeros());
        let h = 1e-4;
        for k in 1..=1000 {
            let (tau, asked) = tracking.tick(&ControlTerms::at(&arm, &q, &qd), &q, &qd, &target);
            let qdd = forward_dynamics(&arm, &q, &qd, &tau);
            assert!((qdd - asked).amax() < 1e-8);
            qd += qdd * h;
            q += qd * h;
            let t = 40.0 * h * f64::from(k);
            let exact = 0.01 * (-t).exp() * (1.0 + t);
            // Semi-implicit Euler is off by ω h of the error it started with.
            assert!((q - target.q).add_scalar(-exact).amax() < 0.01 * 40.0 * h, "at {t}");
        }
    }
}
