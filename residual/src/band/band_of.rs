//! What a friction band is about.

use nalgebra::SVector;
use tribo_friction::FrictionBand;

/// Which friction the band of an estimator is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BandOf {
    /// The whole friction of the joint, compensated or not.
    #[default]
    Friction,
    /// What is left of friction when the belief b of the input is taken off, where b is all that is known of it:
    ///
    /// ```text
    /// d (Cmin − b) ≤ tau_f − b ≤ d (Cmax − b),   d = (upper − lower)/(Cmax − Cmin)
    /// ```
    ///
    /// d is 1 at rest, where friction may be anything, and 0 at speed, where friction that is not believed is seen as a
    /// wrench. For judging a compensator.
    Remainder,
}

impl BandOf {
    /// Bounds (Nm) of friction less the belief (Nm) at qd (rad/s).
    #[inline(never)]
    pub(crate) fn left_nm<const N: usize>(
        self,
        band: &FrictionBand<N>,
        qd: &SVector<f64, N>,
        belief: &SVector<f64, N>,
    ) -> [SVector<f64, N>; 2] {
        match self {
            Self::Friction => band.limits_nm(qd).map(|limit| limit - belief),
            Self::Remainder => {
                let (mut lower, mut upper) = (SVector::zeros(), SVector::zeros());
                for (j, joint) in band.joints().iter().enumerate() {
                    let doubt = joint.doubt(qd[j]);
                    lower[j] = doubt * (joint.coulomb_min_nm - belief[j]).min(0.0);
                    upper[j] = doubt * (joint.coulomb_max_nm - belief[j]).max(0.0);
                }
                [lower, upper]
            }
        }
    }
}
