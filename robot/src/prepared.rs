//! A mechanism with what the algorithms make of it.

use std::ops::Deref;

use crate::Mechanism;
use crate::canonical::Canonical;

/// A [`Mechanism`] and what the algorithms make of it once, so that no call has to: it can be read, and replaced, not changed.
#[derive(Clone, Debug, PartialEq)]
pub struct PreparedMechanism<const N: usize> {
    described: Mechanism<N>,
    canonical: Canonical<N>,
}

impl<const N: usize> PreparedMechanism<N> {
    #[inline]
    pub(crate) fn canonical(&self) -> &Canonical<N> {
        &self.canonical
    }
}

impl<const N: usize> From<Mechanism<N>> for PreparedMechanism<N> {
    fn from(described: Mechanism<N>) -> Self {
        Self { canonical: Canonical::of(&described), described }
    }
}

impl<const N: usize> Deref for PreparedMechanism<N> {
    type Target = Mechanism<N>;

    #[inline]
    fn deref(&self) -> &Mechanism<N> {
        &self.described
    }
}

#[cfg(test)]
mod tests {
    use crate::canonical::Joint;
    use crate::presets;

    /// What makes them fast: with rounding in one right angle the general way would be taken, with the same results.
    #[test]
    fn right_angles_of_real_arms_are_found() {
        let squares = |joints: &[Joint]| joints.iter().filter(|joint| joint.square).count();
        assert_eq!(squares(&presets::panda().mechanism.canonical().joints), 6);
        assert_eq!(squares(&presets::kinova_gen3().mechanism.canonical().joints), 6);
        // Shoulder, elbow and first wrist of a UR are parallel.
        assert_eq!(squares(&presets::ur10e().mechanism.canonical().joints), 3);
        let read = crate::urdf::parse(&crate::urdf::to_urdf(&presets::panda()), None, None).expect("a URDF");
        assert_eq!(squares(&read.arm::<7>().expect("seven joints").arm.mechanism.canonical().joints), 6);
    }
}
