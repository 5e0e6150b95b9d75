//! The energy of an oscillation of the arm.

use nalgebra::{SVector, Vector6};

use crate::GuardInput;

/// Time constant with which the energy of an oscillation is forgotten (s).
pub(crate) const OSCILLATION_MEMORY_S: f64 = 1.0;
/// What is slower than this is motion, what is faster oscillation (Hz).
const OSCILLATION_HZ: f64 = 1.0;
/// Part of the work done on the motion that stick and slip may turn into oscillation [-].
const STICK_SLIP: f64 = 0.1;

/// What an oscillation gains, by the estimated wrench and the damping of the null space, with what is older than about a second forgotten:
///
/// ```text
/// gained    E = −∫ (hᵀ v_fast + qd_fastᵀ tau_null) dt          v_fast, qd_fast = v, qd above 1 Hz
/// surplus   E − 0.1 ∫ |hᵀ v_slow + qd_slowᵀ tau_null| dt       v_slow = v − v_fast
/// ```
///
/// What damping takes of a slow motion in the null space, as of an elbow that makes up for a stuck wrist, is work on the motion.
/// Friction takes energy from it; whoever pushes the arm, or a compensator, gives it. Friction that takes hold and lets go turns a part of
/// the work done on the motion into oscillation: a tenth of that is no surplus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OscillationEnergy<const N: usize> {
    slow_twist: Vector6<f64>,
    slow_qd: SVector<f64, N>,
    gained_j: f64,
    motion_j: f64,
}

impl<const N: usize> OscillationEnergy<N> {
    /// Of an arm that stands.
    pub fn new() -> Self {
        Self { slow_twist: Vector6::zeros(), slow_qd: SVector::zeros(), gained_j: 0.0, motion_j: 0.0 }
    }

    /// What one tick shows. No heap, no panic.
    #[inline]
    pub fn observe(&mut self, input: &GuardInput<'_, N>) {
        let GuardInput { qd, twist, wrench, nullspace_torque, dt_s, .. } = *input;
        let keep = 1.0 - dt_s / OSCILLATION_MEMORY_S;
        let weight = 2.0 * std::f64::consts::PI * OSCILLATION_HZ * dt_s;
        self.slow_twist += (twist - self.slow_twist) * weight;
        self.slow_qd += (qd - self.slow_qd) * weight;
        let slow_w = wrench.dot(&self.slow_twist) + nullspace_torque.dot(&self.slow_qd);
        let fast_w = wrench.dot(twist) + nullspace_torque.dot(qd) - slow_w;
        self.motion_j = keep * self.motion_j + slow_w.abs() * dt_s;
        self.gained_j = keep * self.gained_j - fast_w * dt_s;
    }

    /// What the oscillation gained (J).
    #[inline]
    pub fn gained_j(&self) -> f64 {
        self.gained_j
    }

    /// What it gained beyond what stick and slip explain (J).
    #[inline]
    pub fn surplus_j(&self) -> f64 {
        self.gained_j - STICK_SLIP * self.motion_j
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One tick of one joint that moves the tool at `speed` along x [m/s], against `force` (N) there and `damping` (Nm) in the null space.
    fn tick(energy: &mut OscillationEnergy<1>, speed: f64, force: f64, damping: f64) {
        let (mut twist, mut wrench, zero) = (Vector6::zeros(), Vector6::zeros(), SVector::zeros());
        (twist[3], wrench[3]) = (speed, force);
        energy.observe(&GuardInput {
            qd: &SVector::<f64, 1>::new(speed),
            qd_reference: &zero,
            nullspace_qd: &zero,
            compensation: &zero,
            task_torque: &zero,
            nullspace_torque: &SVector::<f64, 1>::new(damping),
            twist: &twist,
            wrench: &wrench,
            dt_s: 1e-3,
        });
    }

    fn phase(hz: f64, tick: i32) -> f64 {
        (2.0 * std::f64::consts::PI * hz * f64::from(tick) * 1e-3).sin()
    }

    /// Closed form: what pushes in phase with an oscillation of amplitude a, the wrench f and the null space n together, puts in (f + n) a/2
    /// per second, and the leaky integral of one second holds as many joules.
    #[test]
    fn what_pushes_in_phase_is_gained() {
        let (mut energy, mut largest_j) = (OscillationEnergy::new(), f64::MIN);
        for k in 0..10_000 {
            let oscillation = phase(20.0, k);
            tick(&mut energy, 0.02 * oscillation, -3.0 * oscillation, -oscillation);
            largest_j = energy.surplus_j().max(largest_j);
        }
        let expected_j = 4.0 * 0.02 / 2.0;
        assert!((energy.gained_j() - expected_j).abs() < 0.05 * expected_j, "{energy:?} {expected_j}");
        assert!(largest_j < 1.1 * expected_j, "{largest_j}");
    }

    /// A compensator that feeds the damping of a slow motion, half a watt at most, hardly gives anything to an oscillation.
    #[test]
    fn what_feeds_the_damping_of_a_slow_motion_is_no_gain() {
        let mut energy = OscillationEnergy::new();
        for k in 0..60_000 {
            let speed = 0.1 * phase(0.05, k);
            tick(&mut energy, speed, 0.0, -50.0 * speed);
            assert!(energy.surplus_j() < 5e-3, "tick {k}: {energy:?}");
        }
    }
}
