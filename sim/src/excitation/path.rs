//! One profile per joint.

use nalgebra::SVector;

use super::{JointProfile, JointState, JointTrajectory, Motion};

/// `q_j(t) = profile_j(t)`; as long as its longest profile, shorter ones rest at their end.
#[derive(Clone, Debug, PartialEq)]
pub struct Path<const N: usize> {
    joints: [JointProfile; N],
    duration_s: f64,
}

impl<const N: usize> Path<N> {
    /// Of profiles that each end at rest.
    pub fn new(joints: [JointProfile; N]) -> Self {
        let duration_s = joints.iter().map(JointProfile::duration_s).fold(0.0, f64::max);
        Self { joints, duration_s }
    }

    /// The same path, at rest until `duration_s` (s) if it ends before.
    pub fn lasting(self, duration_s: f64) -> Self {
        Self { duration_s: self.duration_s.max(duration_s), ..self }
    }

    /// Quintic Hermite interpolation: the path that passes every state of the motion; stamps increase from 0.
    pub fn through(motion: &Motion<N>) -> Self {
        let joints = std::array::from_fn(|j| {
            let mut profile = JointProfile::resting_at(motion.q.first().map_or(0.0, |q| q[j]));
            let mut last_s = 0.0;
            for (k, &time_s) in motion.time_s.iter().enumerate() {
                let (q, qd, qdd) = (motion.q[k][j], motion.qd[k][j], motion.qdd[k][j]);
                if time_s > last_s {
                    profile.quintic_to(q, qd, qdd, time_s - last_s);
                } else {
                    profile.start_at(qd, qdd);
                }
                last_s = time_s;
            }
            profile
        });
        Self::new(joints)
    }
}

impl<const N: usize> JointTrajectory<N> for Path<N> {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, time_s: f64) -> JointState<N> {
        let mut state = JointState::resting_at(SVector::zeros());
        for (j, profile) in self.joints.iter().enumerate() {
            [state.q[j], state.qd[j], state.qdd[j]] = profile.at(time_s);
        }
        state
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::{Envelope, Excitation};
    use tribo_robot::presets;

    /// Second algorithm: interpolating the samples of a multisine gives the multisine back.
    #[test]
    fn interpolation_reproduces_a_smooth_motion() {
        let envelope = Envelope::of(&presets::panda());
        let original = Excitation::Multisine.draw(&envelope, 10.0, 5);
        let path = Path::through(&Motion::at_rate(original.as_ref(), 50.0));
        for k in 0..3000 {
            let t = k as f64 * 3.3e-3;
            let (a, b) = (original.at(t), path.at(t));
            assert!((a.q - b.q).amax() < 1e-7 && (a.qd - b.qd).amax() < 1e-5, "at {t}");
        }
    }
}
