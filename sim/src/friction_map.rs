//! The friction of all joints over one step.

use nalgebra::SVector;
use tribo_friction::SetValued;

/// [`SetValued`] of every joint, the dry part as an impulse over the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrictionMap<const N: usize> {
    /// Slopes [Nm s/rad].
    pub viscous: SVector<f64, N>,
    /// Torques that do not depend on the new velocity (Nm).
    pub offset: SVector<f64, N>,
    /// Least impulses of dry friction (Nm s).
    pub lower: SVector<f64, N>,
    /// Largest impulses of dry friction (Nm s).
    pub upper: SVector<f64, N>,
}

impl<const N: usize> FrictionMap<N> {
    /// Over a step of h (s), of what each joint answers.
    #[inline]
    pub fn of(h: f64, joint: impl Fn(usize) -> SetValued) -> Self {
        let zero = SVector::zeros();
        let mut map = Self { viscous: zero, offset: zero, lower: zero, upper: zero };
        for j in 0..N {
            let s = joint(j);
            map.viscous[j] = s.viscous_nm_s_per_rad;
            map.offset[j] = s.offset_nm;
            map.lower[j] = h * s.lower_nm;
            map.upper[j] = h * s.upper_nm;
        }
        map
    }
}
