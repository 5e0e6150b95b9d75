//! Friction of a joint that stands, from how it came to rest.

use nalgebra::SVector;

use crate::{FrictionBand, JointBand};

/// Doubt below which a joint slides for certain: what is left at 4.3 deviations of the velocity's noise of a
/// [`JointBand::coulomb_viscous`]. A hybrid compensator goes over to the reference at four; a joint that slows down must be
/// noted before that, or every standing joint seems to have slid without compensation.
const SLIDING_DOUBT: f64 = 0.005;

/// Mean square of the friction that a belief b leaves, e included, with a memory of the last slide:
///
/// ```text
/// σ_f² = m² + σ(v)²                                     sliding
/// σ_f² = ½ u² + ½ (m² + w²/3) + σ(v)²                   standing; u is m of the last slide
/// m, w: middle of the band less b, half-width of the band
/// ```
///
/// The load of a joint changes little while it comes to rest, so its friction takes over what a compensator that fades there
/// withdraws: u stays, ±Fc without compensation and next to nothing with it. From then on pushes move the friction
/// anywhere in the band, and nobody sees it. Which of the two holds is not known, hence the halves. Between sliding
/// and standing the two are weighted by [`JointBand::doubt`]. A joint that was not seen to slide has
/// [`JointBand::mean_square_left_nm2`].
///
/// On a simulated Panda that is pushed with 15 N and 2.5 Nm, standing joints have ⟨(tau_f − b)²⟩ = 0.62 Fc² without
/// compensation and 0.19 Fc² with it (mean over joints, 3 seeds); the law above says 0.67 and 0.17.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestMemory<const N: usize> {
    /// u of every joint (Nm), once it has slid.
    slid_nm: [Option<f64>; N],
}

impl<const N: usize> Default for RestMemory<N> {
    fn default() -> Self {
        Self { slid_nm: [None; N] }
    }
}

impl<const N: usize> RestMemory<N> {
    /// Notes which joints slide at qd (rad/s), and what of their friction the belief (Nm) leaves.
    #[inline]
    pub fn note(&mut self, band: &FrictionBand<N>, qd: &SVector<f64, N>, belief_nm: &SVector<f64, N>) {
        for (j, joint) in band.joints().iter().enumerate() {
            if joint.doubt(qd[j]) < SLIDING_DOUBT {
                self.slid_nm[j] = Some(middle_and_half_width(joint, qd[j])[0] - belief_nm[j]);
            }
        }
    }

    /// σ_f² (Nm²) of every joint at qd (rad/s), with the belief (Nm) of now.
    #[inline]
    pub fn mean_square_left_nm2(
        &self,
        band: &FrictionBand<N>,
        qd: &SVector<f64, N>,
        belief_nm: &SVector<f64, N>,
    ) -> SVector<f64, N> {
        SVector::from_fn(|j, _| {
            let (joint, v) = (&band.joints()[j], qd[j]);
            let Some(slid_nm) = self.slid_nm[j] else { return joint.mean_square_left_nm2(v, belief_nm[j]) };
            let [middle, half_width] = middle_and_half_width(joint, v);
            let middle_square = (middle - belief_nm[j]).powi(2);
            let standing = 0.5 * (slid_nm * slid_nm + middle_square + half_width * half_width / 3.0);
            let doubt = joint.doubt(v);
            doubt * standing + (1.0 - doubt) * middle_square + joint.noise_sd_nm(v).powi(2)
        })
    }
}

#[inline]
fn middle_and_half_width(joint: &JointBand, v: f64) -> [f64; 2] {
    let [lower, upper] = joint.limits_nm(v);
    [0.5 * (lower + upper), 0.5 * (upper - lower)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const COULOMB_NM: f64 = 0.6;
    const NOISE_NM: f64 = 0.1;

    fn band() -> FrictionBand<1> {
        FrictionBand::new([JointBand::coulomb_viscous(COULOMB_NM, 0.0, 3e-3, NOISE_NM)]).expect("a valid band")
    }

    fn after_a_slide(belief_nm: f64, then_qd: f64, then_belief_nm: f64) -> f64 {
        let (mut memory, of) = (RestMemory::default(), SVector::<f64, 1>::repeat);
        memory.note(&band(), &of(-0.2), &of(belief_nm));
        memory.note(&band(), &of(then_qd), &of(then_belief_nm));
        memory.mean_square_left_nm2(&band(), &of(then_qd), &of(then_belief_nm))[0]
    }

    /// Closed forms: edge and uniform by halves without compensation, the uniform half alone with it.
    #[test]
    fn a_standing_joint_remembers_how_it_came_to_rest() {
        let square = COULOMB_NM * COULOMB_NM;
        // The band is open at rest to 1e-5, the noise as it is.
        let standing = |belief: f64| after_a_slide(belief, 0.0, 0.0) - NOISE_NM * NOISE_NM;
        assert!((standing(0.0) - square * (0.5 + 1.0 / 6.0)).abs() < 1e-4);
        assert!((standing(-COULOMB_NM) - square / 6.0).abs() < 1e-4);
        // A velocity within the doubt is no slide: the memory stays.
        assert!((after_a_slide(-COULOMB_NM, 6e-3, 0.0) - after_a_slide(-COULOMB_NM, -6e-3, 0.0)).abs() < 1e-12);
    }

    #[test]
    fn a_sliding_joint_leaves_what_the_belief_misses() {
        for belief in [0.0, 0.3, COULOMB_NM] {
            let expected = (COULOMB_NM - belief).powi(2) + NOISE_NM * NOISE_NM;
            assert!((after_a_slide(-COULOMB_NM, 0.5, belief) - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn a_joint_that_was_not_seen_to_slide_has_the_arcsine_law() {
        let (memory, zero) = (RestMemory::default(), SVector::<f64, 1>::zeros());
        let expected = band().joints()[0].mean_square_left_nm2(0.0, 0.0);
        assert_eq!(memory.mean_square_left_nm2(&band(), &zero, &zero)[0], expected);
    }
}
