//! What watches a friction compensator while it acts.

use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use crate::GuardInput;
use crate::oscillation_energy::{OSCILLATION_MEMORY_S, OscillationEnergy};

/// Time constant with which the energy balance of the motion and the drift are forgotten (s): longer than it takes the motion to
/// turn round, since unmodelled weight gives back what it takes.
const MOTION_MEMORY_S: f64 = 10.0;
/// Five standard deviations of a velocity differentiated and filtered at 50 Hz, over its mean change from tick to tick [-].
const NOISE: f64 = 8.0;
/// Speed [rad/s] up to which a joint stands, of its velocity averaged over [`STANDING_MEAN_S`]; at least the noise of that, over its mean change
/// from tick to tick [-].
const STANDING_RAD_S: f64 = 2e-3;
const STANDING_MEAN_S: f64 = 0.1;
const STANDING_NOISE: f64 = 1.5;
/// Time after which a joint that has been so slow is stuck, and does not turn round (s).
const STUCK_S: f64 = 0.5;
/// Time over which a compensation is withdrawn (s).
const WITHDRAWAL_S: f64 = 0.1;
/// Work of the compensator over what an oscillation gains, at least [-]: what it did not put in is not its fault.
const PUT_IN: f64 = 1.2;

/// Bounds of a [`CompensationGuard`] and of what may be tried on a robot at all; energies and drift are those of an arm with the
/// friction of a Panda.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct GuardSettings {
    /// Largest compensation that is tried, over the friction identified before [-]; its uncertainty is allowed for.
    pub predicted_ratio: f64,
    /// Largest ratio of the energy that the compensator puts in to the energy that friction takes [-].
    pub observed_ratio: f64,
    /// Energy that the compensator puts in on top of what friction takes, below which the ratio means nothing (J): a weight that the model
    /// lacks takes and gives as much.
    pub surplus_j: f64,
    /// The same of oscillation, which no weight gives (J); a tenth of the work done on the motion comes on top, since friction that takes
    /// hold and lets go leaves as much.
    pub oscillation_j: f64,
    /// Largest motion of the arm that does not move the tool (rad), norm over the joints.
    pub drift_rad: f64,
    /// Deviation from the velocity that the motion is meant to have beyond which a joint swings [rad/s]; at least five standard
    /// deviations of the noise of its sensor, which the guard finds out.
    pub swing_rad_s: f64,
    /// Swings from one side to the other, within about a second, that are a limit cycle.
    pub swings: f64,
}

impl GuardSettings {
    /// The same for joints with `factor` times the friction of a Panda's. On the same motion the work of friction goes with it, and so
    /// does the way that what is over-compensated makes the arm slide; stick-slip against the same stiffness leaves an energy that
    /// goes with its square.
    pub fn for_friction(self, factor: f64) -> Self {
        Self {
            surplus_j: factor * self.surplus_j,
            oscillation_j: factor * factor * self.oscillation_j,
            drift_rad: factor * self.drift_rad,
            ..self
        }
    }
}

impl Default for GuardSettings {
    /// Found in a sweep of 0 to 300 % (`experiments/09_overcompensation`): trips before the tool leaves its path by 2 mm, and never
    /// below 110 %.
    fn default() -> Self {
        Self {
            predicted_ratio: 1.3,
            observed_ratio: 1.5,
            surplus_j: 0.2,
            oscillation_j: 0.015,
            drift_rad: 0.1,
            swing_rad_s: 0.03,
            swings: 8.0,
        }
    }
}

/// Why a compensator was withdrawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
pub enum GuardTrip {
    /// It puts more energy into the arm than friction takes out.
    #[error("more energy goes into the arm than friction takes: too much compensation, or somebody pushes")]
    EnergySurplus,
    /// It feeds an oscillation of the arm.
    #[error("an oscillation is fed: too much compensation, or somebody pushes")]
    Oscillation,
    /// A joint swings about the velocity that it is meant to have.
    #[error("joint {joint} swings under its compensation")]
    LimitCycle {
        /// The joint.
        joint: usize,
    },
    /// The arm slides while the tool stays on its path.
    #[error("the compensation makes the arm slide where the tool does not feel it")]
    NullSpaceDrift,
}

/// Withdraws a compensator before it shakes the arm or lets it run away.
///
/// ```text
/// motion       E_c = ∫ qdᵀ tau_c dt,   E = ∫ qdᵀ (tau_task + tau_null) dt,   E_f = E_c + E       ratio E_c/E_f, surplus −E
/// oscillation  [`OscillationEnergy`]                                            surplus of what it gains
/// drift        x = ∫ (I − J#J) qd dt and ∫ s (I − J#J) qd dt, the lesser of both      s ≤ 1: as far as joints that are stuck let the arm slide
/// swings       changes of side of qd − qd_reference, beyond ± swing
/// ```
///
/// forgotten exponentially, motion and drift over 10 s, oscillation and swings over 1 s. Gravity and Coriolis torques cancel what they are sent
/// against, and motion gives its energy back: what the impedance and the null space put in (E) is what friction takes (E_f) less what the
/// compensator puts in (E_c). The impedance, not the estimated wrench: where a joint is stuck, the wrench is of a torque that does no work. This
/// is a passivity observer (hannaford2002) of the compensator that knows no friction: its ratio is 1 for exact compensation. A wrong weight does no work over a motion that comes back, and hardly any in an oscillation.
/// Sliding that the tool does not feel shows as drift, oscillation that loses as much as it gains as swings. An arm slides along one direction of
/// its joints: where one of them is stuck in its friction, what looks like it is the way of the others round that joint.
///
/// Whoever pushes the arm puts energy in too: the guard is for free motion, and what it does, taking friction compensation away
/// within 0.1 s, is safe in contact as well. It stays away until the guard is built anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompensationGuard<const N: usize> {
    settings: GuardSettings,
    compensated_j: f64,
    left_j: f64,
    oscillation: OscillationEnergy<N>,
    /// Compensator's work, of the memory of oscillations.
    lately_compensated_j: f64,
    drift_rad: SVector<f64, N>,
    /// The same of what stuck joints leave free: that motion does not come back where they hold it on one way alone, and so is no drift by itself.
    free_drift_rad: SVector<f64, N>,
    /// Velocity averaged over [`STANDING_MEAN_S`] [rad/s], and for how long it has been that of a standing joint (s).
    mean_qd: SVector<f64, N>,
    stands_s: SVector<f64, N>,
    side: SVector<f64, N>,
    swings: SVector<f64, N>,
    /// Mean change of the measured velocity from tick to tick [rad/s], and of how many ticks.
    change_rad_s: SVector<f64, N>,
    last_qd: SVector<f64, N>,
    ticks: f64,
    trip: Option<GuardTrip>,
    /// Share of the compensation that acts.
    share: f64,
}

impl<const N: usize> CompensationGuard<N> {
    /// A guard that has seen nothing.
    pub fn new(settings: GuardSettings) -> Self {
        let zero = SVector::zeros();
        Self {
            settings,
            compensated_j: 0.0,
            left_j: 0.0,
            oscillation: OscillationEnergy::new(),
            lately_compensated_j: 0.0,
            drift_rad: zero,
            free_drift_rad: zero,
            mean_qd: zero,
            stands_s: zero,
            side: zero,
            swings: zero,
            change_rad_s: zero,
            last_qd: zero,
            ticks: 0.0,
            trip: None,
            share: 1.0,
        }
    }

    /// Share of the compensation that may act in the next tick: 1, and after a trip less and less.
    #[inline]
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Energy that the compensator put in over the energy that friction took [-]; none while the surplus means nothing.
    #[inline]
    pub fn ratio(&self) -> Option<f64> {
        let taken_j = (self.compensated_j + self.left_j).max(f64::MIN_POSITIVE);
        (-self.left_j > self.settings.surplus_j).then(|| self.compensated_j / taken_j)
    }

    /// What one tick shows; the first reason stays. No heap, no panic, no clock; values that are not finite trip nothing: the loop has a
    /// fault of its own for them.
    #[inline]
    pub fn observe(&mut self, input: &GuardInput<'_, N>) -> Option<GuardTrip> {
        let dt_s = input.dt_s;
        if self.trip.is_some() {
            self.share = (self.share - dt_s / WITHDRAWAL_S).max(0.0);
            return self.trip;
        }
        let (keep, keep_fast) = (1.0 - dt_s / MOTION_MEMORY_S, 1.0 - dt_s / OSCILLATION_MEMORY_S);
        let left_w = input.qd.dot(&(input.task_torque + input.nullspace_torque));
        let compensated_w = input.qd.dot(input.compensation);
        self.compensated_j = keep * self.compensated_j + compensated_w * dt_s;
        self.lately_compensated_j = keep_fast * self.lately_compensated_j + compensated_w * dt_s;
        self.left_j = keep * self.left_j + left_w * dt_s;
        self.oscillation.observe(input);
        self.drift_rad = self.drift_rad * keep + input.nullspace_qd * dt_s;
        let free = self.free_share(input);
        self.free_drift_rad = self.free_drift_rad * keep + input.nullspace_qd * (free * dt_s);
        self.swings *= keep_fast;
        let weight = (1.0 / self.ticks.max(1.0)).max(1.0 - keep_fast);
        self.change_rad_s += ((input.qd - self.last_qd).abs() - self.change_rad_s) * weight;
        (self.last_qd, self.ticks) = (*input.qd, self.ticks + 1.0);
        for j in 0..N {
            let deviation = input.qd[j] - input.qd_reference[j];
            if deviation.abs() > self.settings.swing_rad_s.max(NOISE * self.change_rad_s[j]) {
                let side = 1.0_f64.copysign(deviation);
                self.swings[j] += if side * self.side[j] < 0.0 { 1.0 } else { 0.0 };
                self.side[j] = side;
            }
        }
        self.trip = self.reason();
        self.trip
    }

    /// Share of the motion that the tool does not feel that no stuck joint forces.
    #[inline]
    fn free_share(&mut self, input: &GuardInput<'_, N>) -> f64 {
        self.mean_qd += (input.qd - self.mean_qd) * (input.dt_s / STANDING_MEAN_S);
        let mut share = 1.0_f64;
        for j in 0..N {
            let standing_rad_s = STANDING_RAD_S.max(STANDING_NOISE * self.change_rad_s[j]);
            let stands = self.mean_qd[j].abs() < standing_rad_s;
            self.stands_s[j] = if stands { self.stands_s[j] + input.dt_s } else { 0.0 };
            if self.stands_s[j] > STUCK_S {
                share = share.min(standing_rad_s / input.nullspace_qd[j].abs());
            }
        }
        share
    }

    #[inline]
    fn reason(&self) -> Option<GuardTrip> {
        let settings = &self.settings;
        if let Some(joint) = (0..N).find(|&joint| self.swings[joint] > settings.swings) {
            Some(GuardTrip::LimitCycle { joint })
        } else if self.oscillation.surplus_j() > settings.oscillation_j
            && self.lately_compensated_j > PUT_IN * self.oscillation.gained_j()
        {
            Some(GuardTrip::Oscillation)
        } else if self.drift_rad.norm().min(self.free_drift_rad.norm()) > settings.drift_rad {
            Some(GuardTrip::NullSpaceDrift)
        } else {
            self.ratio().filter(|ratio| *ratio > settings.observed_ratio).map(|_| GuardTrip::EnergySurplus)
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector6;

    use super::*;

    const DT_S: f64 = 1e-3;

    /// One joint that moves a tool along x by 0.4 m/rad; friction `k` times compensated; seen for `duration_s`.
    fn watch(guard: &mut CompensationGuard<1>, k: f64, duration_s: f64, hz: f64) -> Option<f64> {
        watch_friction(guard, 0.8, k, duration_s, hz)
    }

    /// The same of a joint with other friction (Nm).
    fn watch_friction(
        guard: &mut CompensationGuard<1>,
        friction_nm: f64,
        k: f64,
        duration_s: f64,
        hz: f64,
    ) -> Option<f64> {
        for tick in 0..(duration_s / DT_S) as usize {
            let t = tick as f64 * DT_S;
            let qd = SVector::<f64, 1>::new(0.3 * (2.0 * std::f64::consts::PI * hz * t).sin());
            let friction = friction_nm * qd[0].signum();
            let mut twist = Vector6::zeros();
            twist[3] = 0.4 * qd[0];
            let mut wrench = Vector6::zeros();
            wrench[3] = (1.0 - k) * friction / 0.4;
            let zero = SVector::zeros();
            let seen = guard.observe(&GuardInput {
                qd: &qd,
                qd_reference: &qd,
                nullspace_qd: &zero,
                compensation: &SVector::<f64, 1>::new(k * friction),
                task_torque: &SVector::<f64, 1>::new(0.4 * wrench[3]),
                nullspace_torque: &zero,
                twist: &twist,
                wrench: &wrench,
                dt_s: DT_S,
            });
            if seen.is_some() {
                return Some(t);
            }
        }
        None
    }

    /// Five times the friction, moved alike, trips at the same time with settings for it, and earlier with those of the lighter arm.
    #[test]
    fn energies_go_with_the_friction_of_the_arm() {
        let trip = |settings, friction_nm| {
            let mut guard = CompensationGuard::new(settings);
            watch_friction(&mut guard, friction_nm, 1.6, 20.0, 0.05).unwrap()
        };
        let (light, heavy) = (GuardSettings::default(), GuardSettings::default().for_friction(5.0));
        assert!((trip(light, 0.8) - trip(heavy, 4.0)).abs() < 1e-9, "{} {}", trip(light, 0.8), trip(heavy, 4.0));
        assert!(trip(light, 4.0) < trip(light, 0.8) - 0.05, "{} {}", trip(light, 4.0), trip(light, 0.8));
    }

    /// Closed form: compensator and friction work on the same path, so the ratio of their energies is k, whatever the motion.
    #[test]
    fn the_ratio_is_that_of_the_torques() {
        for k in [1.1, 1.3, 1.45] {
            let mut guard = CompensationGuard::new(GuardSettings { surplus_j: 0.01, ..GuardSettings::default() });
            assert_eq!(watch(&mut guard, k, 20.0, 0.1), None, "{k}");
            assert!((guard.ratio().unwrap() - k).abs() < 1e-9, "{k}: {:?}", guard.ratio());
            assert_eq!(guard.share(), 1.0);
        }
        for k in [0.0, 0.5, 1.0] {
            let mut guard = CompensationGuard::new(GuardSettings::default());
            assert_eq!(watch(&mut guard, k, 20.0, 0.1), None);
            assert_eq!(guard.ratio(), None);
        }
    }

    #[test]
    fn too_much_is_withdrawn_for_good() {
        let mut guard = CompensationGuard::new(GuardSettings::default());
        assert!(watch(&mut guard, 1.6, 20.0, 0.05).is_some());
        assert_eq!(guard.trip, Some(GuardTrip::EnergySurplus));
        // Linear over 0.1 s, and the reason stays although the compensation is right now.
        for tick in 1..=200 {
            watch(&mut guard, 1.0, DT_S, 0.05);
            let expected = (1.0 - f64::from(tick) * DT_S / WITHDRAWAL_S).max(0.0);
            assert!((guard.share() - expected).abs() < 1e-9);
        }
        assert_eq!(guard.trip, Some(GuardTrip::EnergySurplus));
        // The same surplus in an oscillation is seen within half a second.
        let mut guard = CompensationGuard::new(GuardSettings::default());
        assert!(watch(&mut guard, 1.6, 20.0, 5.0).unwrap() < 0.5);
        assert_eq!(guard.trip, Some(GuardTrip::Oscillation));
    }

    /// A weight of 0.2 kg that nobody knows, lifted and lowered by 10 cm under exact compensation (0.196 J), is no over-compensation.
    #[test]
    fn a_wrong_weight_trips_nothing() {
        let mut guard = CompensationGuard::<1>::new(GuardSettings::default());
        for tick in 0..60_000 {
            let speed = 0.025 * (0.5 * f64::from(tick) * DT_S).sin();
            let (mut twist, mut wrench) = (Vector6::zeros(), Vector6::zeros());
            (twist[5], wrench[5]) = (speed, -0.2 * 9.81);
            let qd = SVector::<f64, 1>::new(speed / 0.4);
            let zero = SVector::zeros();
            let compensation = &SVector::<f64, 1>::new(0.8 * qd[0].signum());
            let input = GuardInput {
                qd: &qd,
                qd_reference: &qd,
                nullspace_qd: &zero,
                compensation,
                task_torque: &SVector::<f64, 1>::new(0.4 * wrench[5]),
                nullspace_torque: &zero,
                twist: &twist,
                wrench: &wrench,
                dt_s: DT_S,
            };
            assert_eq!(guard.observe(&input), None, "tick {tick}");
        }
    }

    fn standing<'a>(qd: &'a SVector<f64, 2>, nullspace_qd: &'a SVector<f64, 2>) -> GuardInput<'a, 2> {
        static ZERO: SVector<f64, 2> = SVector::<f64, 2>::new(0.0, 0.0);
        static ZERO6: Vector6<f64> = Vector6::<f64>::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        GuardInput {
            qd,
            qd_reference: &ZERO,
            nullspace_qd,
            compensation: &ZERO,
            task_torque: &ZERO,
            nullspace_torque: &ZERO,
            twist: &ZERO6,
            wrench: &ZERO6,
            dt_s: DT_S,
        }
    }

    /// Closed form of the leaky integral of a constant speed: x(t) = v T (1 − exp(−t/T)).
    #[test]
    fn a_slow_slide_is_seen_when_it_has_gone_far_enough() {
        let slide = SVector::<f64, 2>::new(0.024, -0.018);
        let mut guard = CompensationGuard::new(GuardSettings::default());
        let mut ticks = 0;
        while guard.observe(&standing(&slide, &slide)).is_none() {
            ticks += 1;
        }
        let expected_s = -MOTION_MEMORY_S * (1.0 - 0.1 / (0.03 * MOTION_MEMORY_S)).ln();
        assert!((f64::from(ticks) * DT_S - expected_s).abs() < 0.01, "{ticks} {expected_s}");
        assert_eq!(guard.trip, Some(GuardTrip::NullSpaceDrift));
    }

    /// A stuck joint keeps the arm from sliding: what the others do round it is no drift, once it is surely stuck.
    #[test]
    fn an_arm_with_a_stuck_joint_does_not_slide() {
        let (round_it, slide) = (SVector::<f64, 2>::new(0.024, 0.0), SVector::<f64, 2>::new(0.024, -0.018));
        let mut guard = CompensationGuard::new(GuardSettings::default());
        for _ in 0..60_000 {
            assert_eq!(guard.observe(&standing(&round_it, &slide)), None);
        }
        // What it would have been: x(t) = v T (1 − exp(−t/T)).
        assert!((guard.drift_rad.norm() - 0.03 * MOTION_MEMORY_S).abs() < 0.01, "{}", guard.drift_rad.norm());
        let left_rad = MOTION_MEMORY_S * 0.03 * STANDING_RAD_S / 0.018;
        assert!((guard.free_drift_rad.norm() - left_rad).abs() < 0.01, "{}", guard.free_drift_rad.norm());
    }

    #[test]
    fn swings_count_and_noise_does_not() {
        let zero = SVector::zeros();
        let swinging = |amplitude: f64, hz: f64| {
            let mut guard = CompensationGuard::<2>::new(GuardSettings::default());
            for tick in 0..5000 {
                let swing = amplitude * (2.0 * std::f64::consts::PI * hz * f64::from(tick) * DT_S).sin();
                let qd = SVector::<f64, 2>::new(0.0, swing);
                guard.observe(&standing(&qd, &zero));
            }
            guard.trip
        };
        assert_eq!(swinging(0.05, 8.0), Some(GuardTrip::LimitCycle { joint: 1 }));
        // Slower than four in a second is what friction itself does, and below the threshold is noise.
        assert_eq!(swinging(0.05, 3.0), None);
        assert_eq!(swinging(0.029, 30.0), None);
    }

    #[test]
    fn what_is_not_finite_trips_nothing() {
        let broken = SVector::<f64, 2>::repeat(f64::NAN);
        let mut guard = CompensationGuard::new(GuardSettings::default());
        for _ in 0..1000 {
            assert_eq!(guard.observe(&standing(&broken, &broken)), None);
        }
    }
}
