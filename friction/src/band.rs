//! The velocity-dependent band of friction torque.

use nalgebra::SVector;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::{FrictionModel, JointFriction};

/// Friction of one joint at the measured velocity v (linderoth2013 eqs. 6 and 7):
///
/// ```text
/// upper(v) = Cmin + (Cmax − Cmin)/(1 + exp(−A (v + B))) + c v
/// lower(v) = Cmin + (Cmax − Cmin)/(1 + exp(−A (v − B))) + c v
/// lower ≤ tau_f ≤ upper,   noise e with standard deviation σ (1 + k |v|)
/// ```
///
/// Far from v = 0 the band closes onto Coulomb and viscous friction; near it, a joint may stick at any torque, and the
/// measured velocity may have the wrong sign. Cmin = Cmax is a band of zero width, Cmin = −∞ or Cmax = ∞ one without
/// that bound at any velocity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointBand {
    /// Cmin: friction when sliding backwards, without the viscous part (Nm).
    pub coulomb_min_nm: f64,
    /// Cmax: friction when sliding forwards, without the viscous part (Nm).
    pub coulomb_max_nm: f64,
    /// c: viscous friction (Nm s/rad).
    pub viscous_nm_s_per_rad: f64,
    /// A: steepness of the band's ends (s/rad).
    pub steepness_s_per_rad: f64,
    /// B: speed up to which the sign of the velocity is in doubt (rad/s).
    pub doubt_rad_s: f64,
    /// σ: standard deviation of e at rest (Nm).
    pub noise_sd_nm: f64,
    /// k: growth of that deviation with speed (s/rad).
    pub noise_growth_s_per_rad: f64,
}

impl JointBand {
    /// Coulomb and viscous friction seen through a velocity with noise of `velocity_sd_rad_s`: B is three and 1/A a
    /// quarter of that deviation, so a joint at rest may have any friction up to ±Fc whatever the noise reads.
    pub fn coulomb_viscous(
        coulomb_nm: f64,
        viscous_nm_s_per_rad: f64,
        velocity_sd_rad_s: f64,
        noise_sd_nm: f64,
    ) -> Self {
        Self {
            coulomb_min_nm: -coulomb_nm,
            coulomb_max_nm: coulomb_nm,
            viscous_nm_s_per_rad,
            steepness_s_per_rad: 4.0 / velocity_sd_rad_s,
            doubt_rad_s: 3.0 * velocity_sd_rad_s,
            noise_sd_nm,
            noise_growth_s_per_rad: 0.0,
        }
    }

    /// The band of a friction law, seen as [`Self::coulomb_viscous`] says: Coulomb level of each direction and mean viscous
    /// slope are those between 1 and 2 rad/s, so what a law adds at low speed (a Stribeck peak) widens nothing.
    pub fn of_law(law: &JointFriction, velocity_sd_rad_s: f64, noise_sd_nm: f64) -> Self {
        let f = |v: f64| law.torque(v, 0.0);
        let viscous = (0.5 * (f(2.0) - f(1.0) + f(-1.0) - f(-2.0))).max(0.0);
        let (forwards, backwards) = (f(1.0) - viscous, f(-1.0) + viscous);
        Self {
            coulomb_min_nm: backwards.min(forwards),
            coulomb_max_nm: backwards.max(forwards),
            ..Self::coulomb_viscous(0.0, viscous, velocity_sd_rad_s, noise_sd_nm)
        }
    }

    /// Mean square (Nm²) of the friction left at v (rad/s) by a belief (Nm), e included, for friction that is nearer to the
    /// ends of its band than to the middle, as pushes leave a joint that sticks:
    ///
    /// ```text
    /// (m − b)² + w²/2 + σ(v)²     m, w: middle and half-width of the band; w²/2 is the variance of the arcsine law
    /// ```
    #[inline]
    pub fn mean_square_left_nm2(&self, v: f64, belief_nm: f64) -> f64 {
        let [lower, upper] = self.limits_nm(v);
        let (middle, half_width) = (0.5 * (lower + upper) - belief_nm, 0.5 * (upper - lower));
        middle * middle + 0.5 * half_width * half_width + self.noise_sd_nm(v).powi(2)
    }

    /// No friction, noise of standard deviation `noise_sd_nm` (Nm): a band of zero width.
    pub fn frictionless(noise_sd_nm: f64) -> Self {
        Self::coulomb_viscous(0.0, 0.0, 1e-3, noise_sd_nm)
    }

    /// Least and largest friction torque (Nm) at v (rad/s).
    #[inline]
    pub fn limits_nm(&self, v: f64) -> [f64; 2] {
        let range = self.coulomb_max_nm - self.coulomb_min_nm;
        if !range.is_finite() {
            return [self.coulomb_min_nm, self.coulomb_max_nm];
        }
        let base = self.coulomb_min_nm + self.viscous_nm_s_per_rad * v;
        let part = |u: f64| range / (1.0 + (-self.steepness_s_per_rad * u).exp());
        [base + part(v - self.doubt_rad_s), base + part(v + self.doubt_rad_s)]
    }

    /// Width of the band at v (rad/s) as a part of Cmax − Cmin: 1 where the joint may stick, 0 at speed. A band without a
    /// bound is in doubt at any speed.
    #[inline]
    pub fn doubt(&self, v: f64) -> f64 {
        if !(self.coulomb_max_nm - self.coulomb_min_nm).is_finite() {
            return 1.0;
        }
        let part = |u: f64| 1.0 / (1.0 + (-self.steepness_s_per_rad * u).exp());
        part(v + self.doubt_rad_s) - part(v - self.doubt_rad_s)
    }

    /// Standard deviation of e (Nm) at v (rad/s).
    #[inline]
    pub fn noise_sd_nm(&self, v: f64) -> f64 {
        self.noise_sd_nm * (1.0 + self.noise_growth_s_per_rad * v.abs())
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// The first field outside its range, of joint `joint`.
    pub fn validate(&self, joint: usize) -> Result<(), BandError> {
        let out = |field, allowed| Err(BandError { joint, field, allowed });
        let finite_or = |x: f64, infinity: f64| x.is_finite() || x == infinity;
        if !finite_or(self.coulomb_min_nm, f64::NEG_INFINITY) {
            return out("coulomb_min_nm", "a number or −∞");
        }
        if !finite_or(self.coulomb_max_nm, f64::INFINITY) || self.coulomb_max_nm < self.coulomb_min_nm {
            return out("coulomb_max_nm", "a number or ∞, not below coulomb_min_nm");
        }
        for (field, value) in [
            ("viscous_nm_s_per_rad", self.viscous_nm_s_per_rad),
            ("doubt_rad_s", self.doubt_rad_s),
            ("noise_growth_s_per_rad", self.noise_growth_s_per_rad),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                return out(field, "0 and above");
            }
        }
        for (field, value) in [("steepness_s_per_rad", self.steepness_s_per_rad), ("noise_sd_nm", self.noise_sd_nm)] {
            if !(value > 0.0 && value.is_finite()) {
                return out(field, "above 0");
            }
        }
        Ok(())
    }
}

/// A number of a band lies outside its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("band of joint {joint}: {field} must be {allowed}")]
pub struct BandError {
    /// The joint, from 0.
    pub joint: usize,
    /// The field of [`JointBand`].
    pub field: &'static str,
    /// Its range.
    pub allowed: &'static str,
}

/// The valid bands of all joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionBand<const N: usize> {
    joints: [JointBand; N],
}

impl<const N: usize> FrictionBand<N> {
    /// Checks the bands.
    ///
    /// # Errors
    /// The first field outside its range.
    pub fn new(joints: [JointBand; N]) -> Result<Self, BandError> {
        joints.iter().enumerate().try_for_each(|(joint, band)| band.validate(joint))?;
        Ok(Self { joints })
    }

    /// The band of a friction model, each joint as [`JointBand::of_law`] says. Deviations at or below zero count as 1e-9.
    pub fn of_model(model: &FrictionModel<N>, velocity_sd_rad_s: f64, noise_sd_nm: f64, growth_s_per_rad: f64) -> Self {
        let (velocity_sd_rad_s, noise_sd_nm) = (velocity_sd_rad_s.max(1e-9), noise_sd_nm.max(1e-9));
        let joints = model.joints.map(|law| JointBand {
            noise_growth_s_per_rad: growth_s_per_rad.max(0.0),
            ..JointBand::of_law(&law, velocity_sd_rad_s, noise_sd_nm)
        });
        Self { joints }
    }

    /// The same band with the noise multiplied.
    #[must_use]
    pub fn with_noise_times(&self, factor: f64) -> Self {
        let noisier = |band: JointBand| JointBand { noise_sd_nm: band.noise_sd_nm * factor.max(1e-9), ..band };
        Self { joints: self.joints.map(noisier) }
    }

    /// The band of each joint.
    pub fn joints(&self) -> &[JointBand; N] {
        &self.joints
    }

    /// Least and largest friction torque (Nm) of every joint at qd (rad/s).
    #[inline]
    pub fn limits_nm(&self, qd: &SVector<f64, N>) -> [SVector<f64, N>; 2] {
        let (mut lower, mut upper) = (SVector::zeros(), SVector::zeros());
        for j in 0..N {
            [lower[j], upper[j]] = self.joints[j].limits_nm(qd[j]);
        }
        [lower, upper]
    }

    /// Variance of e (Nm²) of every joint at qd (rad/s).
    #[inline]
    pub fn noise_variance_nm2(&self, qd: &SVector<f64, N>) -> SVector<f64, N> {
        SVector::from_fn(|j, _| self.joints[j].noise_sd_nm(qd[j]).powi(2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::CoulombViscous;

    /// Closed form: at the middle of each end the sigmoid is half way, far away it is closed, at rest it is open.
    #[test]
    fn the_band_is_open_at_rest_and_closed_at_speed() {
        let band = JointBand { coulomb_min_nm: -0.4, ..JointBand::coulomb_viscous(0.6, 1.0, 2e-3, 0.1) };
        let [lower, upper] = band.limits_nm(0.0);
        assert!((lower + 0.4).abs() < 1e-5 && (upper - 0.6).abs() < 1e-5);
        let [lower, _] = band.limits_nm(6e-3);
        assert!((lower - (0.1 + 6e-3)).abs() < 1e-12, "half way at v = B");
        for v in [-1e3, -0.5, 0.5, 1e3] {
            let [lower, upper] = band.limits_nm(v);
            let friction = v + if v > 0.0 { 0.6 } else { -0.4 };
            assert!((lower - friction).abs() < 1e-12 && (upper - friction).abs() < 1e-12);
        }
        for k in -1000..1000 {
            let [lower, upper] = band.limits_nm(f64::from(k) * 1e-4);
            assert!(lower <= upper);
        }
        let noisy = JointBand { noise_growth_s_per_rad: 5.0, ..band };
        assert!((noisy.noise_sd_nm(-0.2) - 0.2).abs() < 1e-15);
    }

    /// Witness: the law itself at speed, the mean square of the sine of a uniform angle at rest.
    #[test]
    fn a_law_lies_in_its_band_and_what_is_left_has_its_mean_square() {
        let law = JointFriction::CoulombViscous(CoulombViscous { coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.2 });
        let band = JointBand::of_law(&law, 3e-3, 0.1);
        for v in [-1.5, -0.1, 0.1, 0.8] {
            let [lower, upper] = band.limits_nm(v);
            assert!((lower - law.torque(v, 0.0)).abs() < 1e-9 && (upper - law.torque(v, 0.0)).abs() < 1e-9);
            assert!((band.mean_square_left_nm2(v, law.torque(v, 0.0)) - 0.01).abs() < 1e-9);
        }
        // sin of a uniform angle has the arcsine law.
        let steps = 10_000;
        let angle = |k: i32| std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(steps);
        let mean = (0..steps).map(|k| (0.6 * angle(k).sin() - 0.2).powi(2)).sum::<f64>() / f64::from(steps);
        assert!((band.mean_square_left_nm2(0.0, 0.2) - 0.01 - mean).abs() < 1e-5);
    }

    #[test]
    fn bounds_may_be_equal_or_infinite_and_nothing_else_odd() {
        let band = JointBand::frictionless(0.1);
        assert_eq!(band.limits_nm(0.3), [0.0, 0.0]);
        let (least, most) = (f64::NEG_INFINITY, f64::INFINITY);
        let unknown = JointBand { coulomb_min_nm: least, coulomb_max_nm: most, ..band };
        assert_eq!(unknown.limits_nm(0.3), [least, most]);
        assert!(FrictionBand::new([band, unknown]).is_ok());
        for (bad, field) in [
            (JointBand { noise_sd_nm: 0.0, ..band }, "noise_sd_nm"),
            (JointBand { coulomb_max_nm: -1.0, ..band }, "coulomb_max_nm"),
            (JointBand { coulomb_min_nm: f64::NAN, ..band }, "coulomb_min_nm"),
            (JointBand { doubt_rad_s: -1.0, ..band }, "doubt_rad_s"),
        ] {
            let error = FrictionBand::new([band, bad]).unwrap_err();
            assert_eq!((error.joint, error.field), (1, field));
        }
    }
}
