//! Motions one after the other.

use super::{JointState, JointTrajectory};

/// Trajectories in turn. Each must end where the next begins, as those drawn from one envelope do.
pub struct Chain<const N: usize> {
    parts: Vec<Box<dyn JointTrajectory<N>>>,
}

impl<const N: usize> Chain<N> {
    /// Of at least one part.
    pub fn new(first: Box<dyn JointTrajectory<N>>, rest: Vec<Box<dyn JointTrajectory<N>>>) -> Self {
        let mut parts = vec![first];
        parts.extend(rest);
        Self { parts }
    }
}

impl<const N: usize> JointTrajectory<N> for Chain<N> {
    fn duration_s(&self) -> f64 {
        self.parts.iter().map(|part| part.duration_s()).sum()
    }

    fn at(&self, time_s: f64) -> JointState<N> {
        let (mut time_s, last) = (time_s, self.parts.len() - 1);
        for part in &self.parts[..last] {
            if time_s <= part.duration_s() {
                return part.at(time_s);
            }
            time_s -= part.duration_s();
        }
        self.parts[last].at(time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation::{Envelope, Excitation};
    use tribo_robot::presets;

    #[test]
    fn parts_follow_each_other_without_a_jump() {
        let envelope = Envelope::of(&presets::panda());
        let parts = [Excitation::Cruise, Excitation::SmallFast, Excitation::Multisine];
        let mut drawn = parts.map(|kind| kind.draw(&envelope, 10.0, 1)).into_iter();
        let chain = Chain::new(drawn.next().unwrap(), drawn.collect());
        assert!((chain.duration_s() - 30.0).abs() < 1e-9);
        for joint_s in [0.0, 10.0, 20.0, 30.0] {
            let (before, after) = (chain.at(joint_s - 1e-6), chain.at(joint_s + 1e-6));
            assert!((before.q - after.q).amax() < 1e-9 && (before.qdd - after.qdd).amax() < 1e-2);
        }
    }
}
