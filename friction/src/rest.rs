//! Friction of a joint that stands, from how it came to rest.

use nalgebra::SVector;

use crate::{FrictionBand, JointBand};

/// Doubt below which a joint slides for certain: what is left at six deviations of the velocity's noise of a
/// [`JointBand::coulomb_viscous`]. A hybrid compensator goes over to the reference at four; a joint that slows down must be
/// noted well before that, or one noisy sample makes it a joint that has slid without compensation.
const SLIDING_DOUBT: f64 = 1e-5;
/// Time over which what a slide leaves is averaged (s): belief and velocity of one sample need not fit each other.
const SLIDE_S: f64 = 0.02;
/// Variance that stands for an unlimited one (Nm²).
pub const UNBOUNDED_NM2: f64 = 1e9;

/// What a belief leaves of the friction of every joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemainingFriction<const N: usize> {
    /// Mean of tau_f less the belief (Nm).
    pub mean_nm: SVector<f64, N>,
    /// Variance about it (Nm²).
    pub variance_nm2: SVector<f64, N>,
}

impl<const N: usize> RemainingFriction<N> {
    /// Nothing is left.
    pub fn none() -> Self {
        Self { mean_nm: SVector::zeros(), variance_nm2: SVector::zeros() }
    }

    /// The same as seen through a first-order low-pass that takes `share` of `now`.
    #[inline]
    pub fn follow(&mut self, now: &Self, share: f64) {
        self.mean_nm += (now.mean_nm - self.mean_nm) * share;
        self.variance_nm2 += (now.variance_nm2 - self.variance_nm2) * share;
    }
}

/// What one joint keeps of its last slide.
///
/// ```text
/// E = m        var = 0                            sliding
/// E = ½ u      var = ¼ u² + ½ (m² + w²/2)         standing; u is m of the last slide
/// E = 0        var = m² + w²/2                    standing, and not seen to slide
/// m, w: middle of the possible friction less what is believed of it, half-width of it
/// ```
///
/// The load of a joint changes little while it comes to rest, so its friction takes over what a compensator that fades there
/// withdraws: u stays, ±Fc without compensation and next to nothing with it. From then on pushes move the friction between its
/// bounds, and nobody sees it; w²/2 is the variance of the arcsine law, since they leave it near an end rather than in
/// the middle. Which of the two holds is not known, hence the halves. What the pushes leave has the mean zero and not m: the friction
/// of a standing joint holds whatever torque there is, the compensator's guess where it will slide next included. Between
/// sliding and standing the moments are weighted by the doubt about the sign of the velocity.
///
/// On a simulated Panda that is pushed with 15 N and 2.5 Nm every four seconds, standing joints have ⟨(tau_f − b)²⟩ = 0.60 Fc²
/// without compensation and 0.20 Fc² with it (mean over joints and three poses); the law says 0.75 and 0.25.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointRest {
    /// u (Nm), once the joint has slid.
    slid_nm: Option<f64>,
}

impl JointRest {
    /// Notes what the belief leaves of the friction (Nm) after a period of `dt_s` (s), if at this doubt (0 to 1) the joint
    /// slides for certain.
    #[inline]
    pub fn note(&mut self, doubt: f64, remaining_nm: f64, dt_s: f64) {
        if doubt < SLIDING_DOUBT {
            let share = -(-dt_s / SLIDE_S).exp_m1();
            self.slid_nm = Some(self.slid_nm.map_or(remaining_nm, |before| before + share * (remaining_nm - before)));
        }
    }

    /// Mean (Nm) and variance (Nm²) of what is left: `sliding_nm` if the joint slides, else between the bounds with this
    /// middle and half-width (Nm); `doubt` from 0 to 1.
    #[inline]
    pub fn remaining(&self, doubt: f64, sliding_nm: f64, middle_nm: f64, half_width_nm: f64) -> [f64; 2] {
        let pushed = middle_nm * middle_nm + 0.5 * half_width_nm * half_width_nm;
        let (mean, variance) = match self.slid_nm {
            Some(u) => (0.5 * u, 0.25 * u * u + 0.5 * pushed),
            None => (0.0, pushed),
        };
        let apart = mean - sliding_nm;
        [sliding_nm + doubt * apart, doubt * variance + doubt * (1.0 - doubt) * apart * apart]
    }

    /// Part of its dry friction w (Nm) that a standing joint is expected to use, for estimators that know bounds and no moments;
    /// m (Nm) is what is left of the middle now:
    ///
    /// ```text
    /// 1/3 + 2/3 (u² + m²)/w²     at most 1, and 1 for a joint that was not seen to slide
    /// ```
    ///
    /// It is E² + var of the law above, over what that is for a joint which came to rest with all its friction in hand and without
    /// compensation: such a joint fills its band. One that is turned round by its compensator may do so too: m is large there.
    #[inline]
    pub fn part_of_band(&self, middle_nm: f64, dry_nm: f64) -> f64 {
        let part = |u: f64| (1.0 + 2.0 * (u * u + middle_nm * middle_nm) / (dry_nm * dry_nm)) / 3.0;
        // NaN for a joint without dry friction, or with an unlimited one of unlimited memory: the whole band.
        self.slid_nm.map(part).filter(|part| *part < 1.0).unwrap_or(1.0)
    }
}

/// [`JointRest`] of every joint in a [`FrictionBand`], whose noise e is part of the variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestMemory<const N: usize> {
    joints: [JointRest; N],
}

impl<const N: usize> Default for RestMemory<N> {
    fn default() -> Self {
        Self { joints: [JointRest::default(); N] }
    }
}

impl<const N: usize> RestMemory<N> {
    /// Notes which joints slide at qd (rad/s) after a period of `dt_s` (s), and what of their friction the belief (Nm) leaves.
    #[inline]
    pub fn note(&mut self, band: &FrictionBand<N>, qd: &SVector<f64, N>, belief_nm: &SVector<f64, N>, dt_s: f64) {
        for (j, joint) in band.joints().iter().enumerate() {
            let [middle, _] = middle_and_half_width(joint, qd[j]);
            self.joints[j].note(joint.doubt(qd[j]), middle - belief_nm[j], dt_s);
        }
    }

    /// What is left of every joint's friction at qd (rad/s) with the belief (Nm) of now: nothing is expected of a joint without
    /// bounds, and 1e9 Nm² stand for its variance.
    #[inline]
    pub fn remaining(
        &self,
        band: &FrictionBand<N>,
        qd: &SVector<f64, N>,
        belief_nm: &SVector<f64, N>,
    ) -> RemainingFriction<N> {
        let mut remaining = RemainingFriction::none();
        for (j, joint) in band.joints().iter().enumerate() {
            let [middle, half_width] = middle_and_half_width(joint, qd[j]);
            let left = middle - belief_nm[j];
            let [mean, variance] = self.joints[j].remaining(joint.doubt(qd[j]), left, left, half_width);
            let bounded = mean.is_finite() && variance.is_finite();
            remaining.mean_nm[j] = if bounded { mean } else { 0.0 };
            remaining.variance_nm2[j] =
                if bounded { variance + joint.noise_sd_nm(qd[j]).powi(2) } else { UNBOUNDED_NM2 };
        }
        remaining
    }

    /// Least and largest friction torque (Nm) expected of every joint at qd (rad/s) with the belief (Nm) of now: the band about
    /// its middle, where a joint stands only [`JointRest::part_of_band`] of it.
    #[inline]
    pub fn limits_nm(
        &self,
        band: &FrictionBand<N>,
        qd: &SVector<f64, N>,
        belief_nm: &SVector<f64, N>,
    ) -> [SVector<f64, N>; 2] {
        let [mut lower, mut upper] = band.limits_nm(qd);
        for (j, joint) in band.joints().iter().enumerate() {
            let dry_nm = 0.5 * (joint.coulomb_max_nm - joint.coulomb_min_nm);
            let [middle, half_width] = middle_and_half_width(joint, qd[j]);
            let part = self.joints[j].part_of_band(middle - belief_nm[j], dry_nm);
            if part < 1.0 && dry_nm.is_finite() {
                let half_width = half_width * (1.0 - joint.doubt(qd[j]) * (1.0 - part));
                (lower[j], upper[j]) = (middle - half_width, middle + half_width);
            }
        }
        [lower, upper]
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

    fn of(value: f64) -> SVector<f64, 1> {
        SVector::<f64, 1>::repeat(value)
    }

    /// Mean and variance without the noise, after a slide backwards with one belief and with another since.
    fn after_a_slide(belief_nm: f64, then_qd: f64, then_belief_nm: f64) -> [f64; 2] {
        let mut memory = RestMemory::default();
        memory.note(&band(), &of(-0.2), &of(belief_nm), 1e-3);
        memory.note(&band(), &of(then_qd), &of(then_belief_nm), 1.0);
        let remaining = memory.remaining(&band(), &of(then_qd), &of(then_belief_nm));
        [remaining.mean_nm[0], remaining.variance_nm2[0] - NOISE_NM * NOISE_NM]
    }

    fn close(found: [f64; 2], expected: [f64; 2], tolerance: f64) {
        assert!((0..2).all(|i| (found[i] - expected[i]).abs() < tolerance), "{found:?} {expected:?}");
    }

    /// Witness: moments of the mixture by quadrature, the arcsine law as the sine of a uniform angle. The band is open at rest to
    /// 1e-5.
    #[test]
    fn a_standing_joint_remembers_how_it_came_to_rest() {
        let mixture = |u: f64, belief: f64| {
            let steps = 100_000;
            let angle = |k: i32| std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(steps);
            let square = (0..steps).map(|k| (COULOMB_NM * angle(k).sin() - belief).powi(2)).sum::<f64>();
            let mean = 0.5 * u;
            [mean, 0.5 * u * u + 0.5 * square / f64::from(steps) - mean * mean]
        };
        close(after_a_slide(0.0, 0.0, 0.0), mixture(-COULOMB_NM, 0.0), 1e-4);
        close(after_a_slide(-COULOMB_NM, 0.0, 0.0), mixture(0.0, 0.0), 1e-4);
        // What is believed of a standing joint does not move what is left of it, and widens it.
        close(after_a_slide(-COULOMB_NM, 0.0, 0.2), mixture(0.0, 0.2), 1e-4);
        // A velocity within the doubt is no slide: the memory stays.
        let [forwards, backwards] = [6e-3, -6e-3].map(|qd| after_a_slide(-COULOMB_NM, qd, 0.0));
        close([forwards[0], forwards[1]], [-backwards[0], backwards[1]], 1e-12);
    }

    /// One sample at which belief and velocity do not fit each other is not remembered for the rest of the standstill.
    #[test]
    fn one_odd_sample_of_a_slide_counts_little() {
        let mut joint = JointRest::default();
        (0..200).for_each(|_| joint.note(0.0, 0.0, 1e-3));
        joint.note(0.0, COULOMB_NM, 1e-3);
        assert!(joint.remaining(1.0, 0.0, 0.0, COULOMB_NM)[0] < 0.03 * COULOMB_NM);
        (0..200).for_each(|_| joint.note(0.0, COULOMB_NM, 1e-3));
        assert!((joint.remaining(1.0, 0.0, 0.0, COULOMB_NM)[0] - 0.5 * COULOMB_NM).abs() < 1e-4);
    }

    #[test]
    fn a_sliding_joint_leaves_what_the_belief_misses() {
        for belief in [0.0, 0.3, COULOMB_NM] {
            close(after_a_slide(-COULOMB_NM, 0.5, belief), [COULOMB_NM - belief, 0.0], 1e-9);
        }
    }

    /// Half in doubt: the law of total variance, by hand.
    #[test]
    fn between_sliding_and_standing_the_moments_are_mixed() {
        let mut joint = JointRest::default();
        joint.note(0.0, 0.4, 1e-3);
        let (standing, sliding) = (0.5 * (0.4_f64.powi(2) + 0.36 / 2.0), -0.1_f64);
        let mean = 0.5 * (0.2 + sliding);
        let square = 0.5 * (standing + sliding * sliding);
        close(joint.remaining(0.5, sliding, 0.0, 0.6), [mean, square - mean * mean], 1e-12);
    }

    /// Witness: the second moments of [`RestMemory::remaining`], about the middle.
    #[test]
    fn the_band_of_a_standing_joint_goes_with_what_it_came_to_rest_with() {
        let square = |belief_nm: f64| {
            let [mean, variance] = after_a_slide(belief_nm, 0.0, 0.0);
            mean * mean + variance
        };
        for belief in [0.0, -0.2, -0.4, -COULOMB_NM] {
            let mut memory = RestMemory::default();
            memory.note(&band(), &of(-0.2), &of(belief), 1e-3);
            let [lower, upper] = memory.limits_nm(&band(), &of(0.0), &of(0.0));
            let part = square(belief) / square(0.0);
            assert!((upper[0] - part * COULOMB_NM).abs() < 1e-4 && lower[0] == -upper[0], "{belief}: {lower} {upper}");
            // At speed the band is what it was.
            assert_eq!(memory.limits_nm(&band(), &of(0.5), &of(0.0)), band().limits_nm(&of(0.5)));
            // Friction must hold what a compensator adds to a standing joint.
            assert_eq!(memory.limits_nm(&band(), &of(0.0), &of(COULOMB_NM)), band().limits_nm(&of(0.0)));
        }
        let never = RestMemory::default();
        assert_eq!(never.limits_nm(&band(), &of(0.0), &of(0.0)), band().limits_nm(&of(0.0)));
    }

    #[test]
    fn a_joint_that_was_not_seen_to_slide_has_the_arcsine_law() {
        let remaining = RestMemory::default().remaining(&band(), &of(0.0), &of(0.2));
        let expected = band().joints()[0].mean_square_left_nm2(0.0, 0.2);
        close([remaining.mean_nm[0], remaining.variance_nm2[0]], [0.0, expected], 1e-5);
    }

    #[test]
    fn a_joint_without_bounds_says_nothing() {
        let (least, most) = (f64::NEG_INFINITY, f64::INFINITY);
        let joint = JointBand { coulomb_min_nm: least, coulomb_max_nm: most, ..band().joints()[0] };
        let band = FrictionBand::new([joint]).expect("a band");
        let mut memory = RestMemory::default();
        memory.note(&band, &of(0.5), &of(0.0), 1e-3);
        let remaining = memory.remaining(&band, &of(0.0), &of(0.0));
        assert_eq!([remaining.mean_nm[0], remaining.variance_nm2[0]], [0.0, UNBOUNDED_NM2]);
        assert_eq!(memory.limits_nm(&band, &of(0.0), &of(0.0)).map(|limit| limit[0]), [least, most]);
    }
}
