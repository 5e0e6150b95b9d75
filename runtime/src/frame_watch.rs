//! Faults of the sensors that one frame does not show.

use nalgebra::SVector;
use tribo_robot::{Arm, SensorFrame};

use crate::TickFault;

/// Steps of a position beyond this multiple of the speed limit are none of the arm [-].
const JUMP: f64 = 4.0;
/// Way that a joint is meant to go (rad) while its sensor shows not the least change, after which the sensor counts as frozen. A stiff
/// loop pushes with tens of Nm by then: more than stiction holds.
const FROZEN_RAD: f64 = 0.05;
/// Frames without one repetition after which a sensor counts as one that never repeats, as noise makes it.
const NEVER_REPEATS: u32 = 100;
/// Repetitions in a row after which such a sensor counts as frozen: one that is silent for 20 ms and comes back is borne.
const FROZEN_FRAMES: u32 = 25;
/// Longest gap between two frames (s).
const LONGEST_GAP_S: f64 = 0.1;

/// Compares each frame with the one before:
///
/// ```text
/// clock    t < t_last, or t > t_last + 0.1 s
/// jump     |q − q_last| > 4 qd_max max(t − t_last, dt)
/// frozen   25 frames that repeat q to the last bit, of a sensor that has not repeated once in 100 frames before;
///          of any sensor, ∫ |qd_reference| dt > 0.05 rad meanwhile
/// ```
///
/// A frame that comes twice (same stamp) is no fault, nor one that is late: what they do to the control shows elsewhere. A jump of less
/// is within what the arm could have done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameWatch<const N: usize> {
    last: Option<(f64, SVector<f64, N>)>,
    /// Way each joint was meant to go since its sensor last changed (rad).
    unanswered_rad: SVector<f64, N>,
    /// Frames since each sensor last repeated, and repetitions in a row.
    changing: [u32; N],
    repeated: [u32; N],
}

impl<const N: usize> FrameWatch<N> {
    /// A watch that has seen nothing.
    pub(crate) fn new() -> Self {
        Self { last: None, unanswered_rad: SVector::zeros(), changing: [0; N], repeated: [0; N] }
    }

    /// The first thing wrong with this frame after the ones before; `dt_s` is the control period (s).
    #[inline]
    pub(crate) fn check(&mut self, arm: &Arm<N>, frame: &SensorFrame<N>, dt_s: f64) -> Option<TickFault> {
        let (last_s, last_q) = self.last.replace((frame.time_s, frame.q))?;
        let step_s = frame.time_s - last_s;
        if !(0.0..=LONGEST_GAP_S).contains(&step_s) {
            return Some(TickFault::ClockJumped);
        }
        for j in 0..N {
            let reach_rad = JUMP * arm.limits.qd_max_rad_s[j] * step_s.max(dt_s);
            if (frame.q[j] - last_q[j]).abs() > reach_rad {
                return Some(TickFault::SensorJumped { joint: j });
            }
            if frame.q[j] != last_q[j] {
                self.unanswered_rad[j] = 0.0;
                // A sensor that came back from a silence must show again that it never repeats.
                self.changing[j] = if self.repeated[j] > 0 { 0 } else { self.changing[j].saturating_add(1) };
                self.repeated[j] = 0;
                continue;
            }
            // The same frame twice says nothing of its sensors.
            self.repeated[j] = self.repeated[j].saturating_add(u32::from(step_s > 0.0));
            let never_repeats = self.changing[j] >= NEVER_REPEATS;
            if self.unanswered_rad[j] > FROZEN_RAD || (never_repeats && self.repeated[j] >= FROZEN_FRAMES) {
                return Some(TickFault::SensorFrozen { joint: j });
            }
        }
        None
    }

    /// Makes a frame say nothing (NaN) of what this fault has shown to be wrong in it.
    #[inline]
    pub(crate) fn disbelieve(&self, fault: TickFault, frame: &mut SensorFrame<N>) {
        for j in 0..N {
            // Where one sensor is frozen others are too, long before they have been silent for as long.
            let frozen = matches!(fault, TickFault::SensorFrozen { .. }) && self.repeated[j] > FROZEN_FRAMES / 2;
            if frozen || matches!(fault, TickFault::SensorJumped { joint } if joint == j) {
                (frame.q[j], frame.qd[j]) = (f64::NAN, f64::NAN);
            }
        }
    }

    /// What the joints were meant to do in this tick [rad/s].
    #[inline]
    pub(crate) fn meant(&mut self, qd_reference: &SVector<f64, N>, dt_s: f64) {
        self.unanswered_rad += qd_reference.abs() * dt_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;

    fn frame(time_s: f64, q: f64) -> SensorFrame<7> {
        let zero = SVector::zeros();
        SensorFrame { time_s, q: SVector::repeat(q), qd: zero, tau: zero, theta: None }
    }

    /// Frames at 1 kHz with these positions; the index of the first that is a fault.
    fn first_fault(positions: impl Iterator<Item = f64>, meant_rad_s: f64) -> Option<(usize, TickFault)> {
        let arm = presets::panda();
        let mut watch = FrameWatch::new();
        for (tick, q) in positions.enumerate() {
            if let Some(fault) = watch.check(&arm, &frame(tick as f64 * 1e-3, q), 1e-3) {
                return Some((tick, fault));
            }
            watch.meant(&SVector::repeat(meant_rad_s), 1e-3);
        }
        None
    }

    #[test]
    fn a_sensor_that_never_repeats_may_be_silent_for_24_frames() {
        let noisy = |tick: usize| 1e-5 * (1.7 * tick as f64).sin();
        let silent = |from: usize, frames: usize| {
            move |tick: usize| if (from..from + frames).contains(&tick) { noisy(from) } else { noisy(tick) }
        };
        assert_eq!(first_fault((0..2000).map(silent(500, 25)), 0.0), None);
        let frozen = first_fault((0..2000).map(silent(500, 26)), 0.0);
        assert_eq!(frozen, Some((525, TickFault::SensorFrozen { joint: 0 })));
    }

    /// An encoder of 0.1 mrad repeats by nature: only a way that is not gone tells.
    #[test]
    fn a_coarse_sensor_is_frozen_when_its_joint_should_have_gone_far() {
        let coarse = |tick: usize| (0.1 * tick as f64 * 1e-3 / 1e-4).floor() * 1e-4;
        assert_eq!(first_fault((0..5000).map(coarse), 0.1), None);
        let stuck = first_fault((0..5000).map(|tick| coarse(tick.min(1000))), 0.1);
        let (tick, fault) = stuck.unwrap();
        assert_eq!(fault, TickFault::SensorFrozen { joint: 0 });
        assert!((1500..1510).contains(&tick), "{tick}");
        // At rest it may repeat for ever.
        assert_eq!(first_fault(std::iter::repeat_n(0.3, 5000), 0.0), None);
    }

    #[test]
    fn the_same_frame_twice_is_no_fault_and_a_gap_is_one() {
        let arm = presets::panda();
        let mut watch = FrameWatch::new();
        for tick in 0..500 {
            for _ in 0..3 {
                assert_eq!(watch.check(&arm, &frame(f64::from(tick) * 1e-3, 1e-5 * f64::from(tick % 7)), 1e-3), None);
            }
        }
        assert_eq!(watch.check(&arm, &frame(0.499 + 0.101, 0.0), 1e-3), Some(TickFault::ClockJumped));
        assert_eq!(watch.check(&arm, &frame(0.4, 0.0), 1e-3), Some(TickFault::ClockJumped));
        let mut watch = FrameWatch::new();
        assert_eq!(watch.check(&arm, &frame(0.0, 0.0), 1e-3), None);
        assert_eq!(watch.check(&arm, &frame(0.05, 0.3), 1e-3), None, "50 ms at the speed limit");
        assert_eq!(watch.check(&arm, &frame(0.051, 0.31), 1e-3), Some(TickFault::SensorJumped { joint: 0 }));
    }
}
