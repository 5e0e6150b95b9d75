//! The friction compensator: a law, evaluated at the velocity one chooses to believe.

use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use crate::law::smooth_sign;
use crate::{FrictionModel, JointEffects, JointFriction, MAX_BRISTLES};

/// Which velocity the compensator believes near zero speed. This matters more than the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VelocitySource {
    /// The measured velocity (roveda2022). Below about two standard deviations of its noise the sign means nothing, so it
    /// is smoothed over 0.005 rad/s.
    Measured,
    /// The velocity of the nominal impedance model. Feed-forward: cannot go unstable, wrong while someone pushes the arm.
    Reference,
    /// The measured velocity where it is credible, the reference model's elsewhere.
    #[default]
    Hybrid,
}

/// Friction compensation torque `tau_f_hat = law(qd_believed) + effects(q, qd_believed, load)`.
///
/// ```text
/// measured:  qd_believed = qd_measured,                                   sign smoothed over 0.005 rad/s
/// reference: qd_believed = qd_reference,                                  sign smoothed over 0.001 rad/s
/// hybrid:    qd_measured where |qd_measured| > threshold, else qd_reference,  smoothed over 0.001 rad/s
/// ```
///
/// A joint with a presliding distance d has `Fc z` in place of `Fc s`, in its law too: z is the deflection of a bristle,
/// `dz/dt = (qd_believed − |qd_believed| z)/d`, integrated exactly over each period ([`Bristles`]). A part a of dry friction
/// with a bristle of its own adds `a (z_a − s)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensator<const N: usize> {
    /// The friction believed to act.
    pub friction: FrictionModel<N>,
    /// Torques believed to act beyond the friction law.
    pub effects: [JointEffects; N],
    /// The velocity believed near zero.
    pub source: VelocitySource,
    /// Width of the smooth sign [rad/s].
    pub smoothing_rad_s: f64,
    /// Speed above which the hybrid source trusts the measurement [rad/s]: four standard deviations of its noise.
    pub hybrid_threshold_rad_s: f64,
}

/// What a compensator must be told at every tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompensatorInput<const N: usize> {
    /// Measured joint positions (rad).
    pub q: SVector<f64, N>,
    /// Measured joint velocities [rad/s].
    pub qd_measured: SVector<f64, N>,
    /// Joint velocities that the motion is meant to have [rad/s].
    pub qd_reference: SVector<f64, N>,
    /// Torque believed to pass through each gear to the links (Nm): gravity, Coriolis and link inertia.
    pub load_nm: SVector<f64, N>,
    /// Control period (s).
    pub dt_s: f64,
}

/// What a compensator adds (Nm), its two parts kept apart: whoever identifies the law must not be shown the effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensation<const N: usize> {
    /// Torque of the friction law.
    pub law_nm: SVector<f64, N>,
    /// Torque of the effects on top, presliding's change of the law included.
    pub effects_nm: SVector<f64, N>,
}

impl<const N: usize> Compensation<N> {
    /// Both parts (Nm).
    #[inline]
    pub fn total(&self) -> SVector<f64, N> {
        self.law_nm + self.effects_nm
    }
}

/// The only memory of a compensator: deflections of bristles over their largest, within ±1; at rest 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bristles<const N: usize> {
    /// Of each joint's whole Coulomb friction.
    pub whole: SVector<f64, N>,
    /// Of its parts ([`JointEffects::bristles`]), joint by joint.
    pub parts: [[f64; MAX_BRISTLES]; N],
}

impl<const N: usize> Default for Bristles<N> {
    fn default() -> Self {
        Self { whole: SVector::zeros(), parts: [[0.0; MAX_BRISTLES]; N] }
    }
}

impl<const N: usize> Compensator<N> {
    /// Four standard deviations of the 50 Hz velocity signal of a 1e-5 rad encoder (2.9e-3 rad/s).
    pub const DEFAULT_HYBRID_THRESHOLD_RAD_S: f64 = 0.012;

    /// Compensator of a friction law alone, with the smoothing that suits the source.
    pub fn new(friction: FrictionModel<N>, source: VelocitySource) -> Self {
        let smoothing_rad_s = match source {
            VelocitySource::Measured => 0.005,
            VelocitySource::Reference | VelocitySource::Hybrid => 0.001,
        };
        Self {
            friction,
            effects: [JointEffects::default(); N],
            source,
            smoothing_rad_s,
            hybrid_threshold_rad_s: Self::DEFAULT_HYBRID_THRESHOLD_RAD_S,
        }
    }

    /// The same compensator that believes `effects` on top of its law.
    pub fn with_effects(mut self, effects: [JointEffects; N]) -> Self {
        self.effects = effects;
        self
    }

    /// Compensation torque (Nm) of the friction law alone, from the measured and the reference joint velocity [rad/s].
    #[inline]
    pub fn torque(&self, qd_measured: &SVector<f64, N>, qd_reference: &SVector<f64, N>) -> SVector<f64, N> {
        SVector::from_fn(|j, _| {
            let qd = self.believed(qd_measured[j], qd_reference[j]);
            self.friction.joints[j].torque(qd, self.smoothing_rad_s)
        })
    }

    /// Compensation torque (Nm) of law and effects for one tick; moves the bristles by one period.
    #[inline]
    pub fn tick(&self, bristles: &mut Bristles<N>, input: &CompensatorInput<N>) -> Compensation<N> {
        let law_nm = self.torque(&input.qd_measured, &input.qd_reference);
        let effects_nm = SVector::from_fn(|j, _| {
            let effects = &self.effects[j];
            if effects.is_none() {
                return 0.0;
            }
            let qd = self.believed(input.qd_measured[j], input.qd_reference[j]);
            let steady = effects.steady_torque_nm(input.q[j], qd, input.load_nm[j], self.smoothing_rad_s);
            // A velocity that is not finite must not stay in the memory; the torque shows it.
            if !qd.is_finite() {
                return steady;
            }
            let sign = smooth_sign(qd, self.smoothing_rad_s);
            let mut torque_nm = steady;
            if effects.presliding_distance_rad > 0.0 {
                let z = &mut bristles.whole[j];
                *z = bristle_after(*z, qd, input.dt_s, effects.presliding_distance_rad);
                torque_nm += (coulomb_nm(&self.friction.joints[j], qd) + effects.coulomb_nm) * (*z - sign);
            }
            for (part, z) in effects.bristles.iter().zip(&mut bristles.parts[j]) {
                if part.amplitude_nm != 0.0 {
                    *z = bristle_after(*z, qd, input.dt_s, part.distance_rad);
                    torque_nm += part.amplitude_nm * (*z - sign);
                }
            }
            torque_nm
        });
        Compensation { law_nm, effects_nm }
    }

    #[inline]
    fn believed(&self, measured: f64, reference: f64) -> f64 {
        match self.source {
            VelocitySource::Measured => measured,
            VelocitySource::Reference => reference,
            VelocitySource::Hybrid if measured.abs() > self.hybrid_threshold_rad_s => measured,
            VelocitySource::Hybrid => reference,
        }
    }
}

/// Coulomb friction of a law at speed (Nm), which a bristle takes over. The sigmoid of Gaz has none.
#[inline]
fn coulomb_nm(law: &JointFriction, qd: f64) -> f64 {
    match law {
        JointFriction::CoulombViscous(law) => law.coulomb_nm,
        JointFriction::Stribeck(law) => law.coulomb_nm,
        JointFriction::GazSigmoid(_) => 0.0,
        JointFriction::Asymmetric(law) if qd < 0.0 => law.coulomb_negative_nm,
        JointFriction::Asymmetric(law) => law.coulomb_positive_nm,
        JointFriction::Lugre(law) => law.coulomb_nm,
    }
}

/// Solution of `dz/dt = (qd − |qd| z)/d` after dt (s) at constant qd [rad/s]; never beyond ±1, at any step length.
#[inline]
fn bristle_after(z: f64, qd: f64, dt_s: f64, distance_rad: f64) -> f64 {
    let target = smooth_sign(qd, 0.0);
    target + (z - target) * (-qd.abs() * dt_s / distance_rad).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::CoulombViscous;
    use crate::{BristlePart, Curve, Ripple};

    fn coulomb(coulomb_nm: f64) -> FrictionModel<1> {
        FrictionModel::uniform(CoulombViscous { coulomb_nm, viscous_nm_s_per_rad: 0.3 }.into())
    }

    fn input(q: f64, qd: f64, load: f64) -> CompensatorInput<1> {
        let one = SVector::<f64, 1>::from_element;
        CompensatorInput { q: one(q), qd_measured: one(qd), qd_reference: one(qd), load_nm: one(load), dt_s: 1e-3 }
    }

    #[test]
    fn hybrid_believes_the_measurement_only_above_its_noise() {
        let friction =
            FrictionModel::<1>::uniform(CoulombViscous { coulomb_nm: 1.0, viscous_nm_s_per_rad: 0.0 }.into());
        let torque = |source, measured: f64, reference: f64| {
            Compensator::new(friction, source).torque(&SVector::from([measured]), &SVector::from([reference]))[0]
        };
        assert!(torque(VelocitySource::Hybrid, 0.011, -0.05) < -0.99);
        assert!(torque(VelocitySource::Hybrid, 0.013, -0.05) > 0.99);
        assert!(torque(VelocitySource::Reference, 1.0, -0.05) < -0.99);
        assert!((torque(VelocitySource::Measured, 0.005, -1.0) - 1.0f64.tanh()).abs() < 1e-12);
    }

    #[test]
    fn without_effects_a_tick_is_the_law_bit_for_bit() {
        let compensator = Compensator::new(coulomb(0.7), VelocitySource::Hybrid);
        let mut bristles = Bristles::default();
        for k in -50..50 {
            let input = input(0.1, 1.7e-3 * f64::from(k), 20.0);
            let law = compensator.torque(&input.qd_measured, &input.qd_reference);
            assert_eq!(compensator.tick(&mut bristles, &input).total(), law);
        }
        assert_eq!(bristles, Bristles::default());
    }

    /// Closed form of every term, joint sliding forwards and backwards.
    #[test]
    fn every_effect_adds_its_torque() {
        let ripple = Ripple { cycles_per_rev: 3.0, amplitude_nm: 0.2, phase_rad: 0.4 };
        let effects = JointEffects {
            coulomb_nm: 0.1,
            viscous_nm_s_per_rad: 0.5,
            breakaway_minus_coulomb_nm: 0.3,
            stribeck_velocity_rad_s: 0.2,
            asymmetry_nm: 0.05,
            offset_nm: -0.02,
            load_coefficient: 0.01,
            ripples: [ripple, Ripple::default(), Ripple::default(), Ripple::default()],
            spring_nm_per_rad: 4.0,
            spring_rest_rad: 0.25,
            presliding_distance_rad: 0.0,
            curves: [
                Curve { amplitude_nm: 0.4, width_rad_s: 0.1 },
                Curve { amplitude_nm: -0.3, width_rad_s: 0.5 },
                Curve::default(),
            ],
            bristles: Default::default(),
        };
        let compensator = Compensator::new(coulomb(0.7), VelocitySource::Measured).with_effects([effects]);
        for qd in [-0.2_f64, 0.2] {
            let s = qd.signum();
            let dry = 0.7 + 0.1 + 0.3 * (-1.0_f64).exp() + 0.01 * 30.0;
            let position = -0.02 + 0.2 * (3.0 * 1.1_f64 + 0.4).sin() + 4.0 * (1.1 - 0.25);
            let bent = 0.4 * (10.0 * qd).tanh() - 0.3 * (2.0 * qd).tanh();
            let expected = dry * s + 0.8 * qd + 0.05 + position + bent;
            let torque = compensator.tick(&mut Bristles::default(), &input(1.1, qd, -30.0)).total()[0];
            assert!((torque - expected).abs() < 1e-12, "{qd}: {torque} {expected}");
        }
    }

    /// Closed form: from rest, after a travel x at constant speed, z = 1 − exp(−x/d); and the law's dry part follows it.
    #[test]
    fn presliding_builds_up_over_its_distance() {
        let effects = JointEffects { presliding_distance_rad: 0.01, ..JointEffects::default() };
        let compensator = Compensator::new(coulomb(0.7), VelocitySource::Measured).with_effects([effects]);
        let mut bristles = Bristles::default();
        let mut torque = 0.0;
        for _ in 0..200 {
            torque = compensator.tick(&mut bristles, &input(0.0, 0.05, 0.0)).total()[0];
        }
        let z = 1.0 - (-1.0_f64).exp();
        assert!((bristles.whole[0] - z).abs() < 1e-12);
        assert!((torque - (0.7 * z + 0.3 * 0.05)).abs() < 1e-12);
        // Any step length keeps it within ±1, standing keeps it where it is, and a broken signal leaves no trace.
        compensator.tick(&mut bristles, &input(0.0, -1e9, 0.0));
        assert_eq!(bristles.whole[0], -1.0);
        compensator.tick(&mut bristles, &input(0.0, 0.0, 0.0));
        assert!(compensator.tick(&mut bristles, &input(0.0, f64::NAN, 0.0)).total()[0].is_nan());
        assert_eq!(bristles.whole[0], -1.0);
    }

    /// Closed form: after a travel x forwards and y back, `z = −1 + (2 − exp(−x/d)) exp(−y/d)` of every part by its own d,
    /// on top of Coulomb friction that stays with s, or follows a bristle of its own.
    #[test]
    fn parts_of_dry_friction_follow_bristles_of_their_own() {
        let parts = [(0.4, 0.01), (-0.1, 0.03), (0.2, 0.002)];
        let bristles = parts.map(|(amplitude_nm, distance_rad)| BristlePart { amplitude_nm, distance_rad });
        for whole_rad in [0.0, 0.005] {
            let effects = JointEffects { presliding_distance_rad: whole_rad, bristles, ..JointEffects::default() };
            let compensator = Compensator::new(coulomb(0.7), VelocitySource::Measured).with_effects([effects]);
            let mut bristles = Bristles::default();
            for _ in 0..300 {
                compensator.tick(&mut bristles, &input(0.0, 0.05, 0.0));
            }
            let mut torque = 0.0;
            for _ in 0..60 {
                torque = compensator.tick(&mut bristles, &input(0.0, -0.05, 0.0)).total()[0];
            }
            let z = |distance: f64| -1.0 + (2.0 - (-0.015 / distance).exp()) * (-0.003 / distance).exp();
            let whole = if whole_rad > 0.0 { 0.7 * z(whole_rad) } else { -0.7 };
            let bent: f64 = parts.iter().map(|&(amplitude, distance)| amplitude * (z(distance) + 1.0)).sum();
            // The smoothed sign is −1 to exp(−20).
            assert!((torque - (whole - 0.3 * 0.05 + bent)).abs() < 1e-8, "{whole_rad}: {torque}");
        }
    }

    /// Any step length keeps parts within ±1, standing keeps them, and a broken signal leaves no trace.
    #[test]
    fn parts_remember_no_broken_signal() {
        let part = BristlePart { amplitude_nm: 0.4, distance_rad: 0.01 };
        let effects = JointEffects { bristles: [part; 3], ..JointEffects::default() };
        let compensator = Compensator::new(coulomb(0.7), VelocitySource::Measured).with_effects([effects]);
        let mut bristles = Bristles::default();
        compensator.tick(&mut bristles, &input(0.0, 1e9, 0.0));
        compensator.tick(&mut bristles, &input(0.0, 0.0, 0.0));
        assert_eq!(bristles.parts, [[1.0; 3]]);
        for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!compensator.tick(&mut bristles, &input(0.0, broken, 0.0)).total()[0].is_finite());
            assert_eq!(bristles.parts, [[1.0; 3]]);
        }
    }
}
