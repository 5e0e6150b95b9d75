//! Joints that stick: friction of a joint that stops for a moment is a straight line in time from the motion before to the motion after.
//!
//! ```text
//! stop:   q moves less than its noise within 40 ms, for 0.4 s at most;   a, b = 20 ms before and after
//! f(t) = f(a) + (t − a)/(b − a) (f(b) − f(a)),     f = Fc tanh(qd/ε) + …
//! ```
//!
//! A joint that turns back under a controller sticks until the controller asks for more than its friction. Meanwhile friction is whatever the arm
//! leaves of the controller's torque, anything within ± Fc, and ends at the bound at which the joint breaks away. The sign of a velocity that is
//! nothing but noise is 0 instead. Bullet's joints stick so, and those of other physics engines that hold friction by a constraint
//! (`experiments/13_bullet`). At the beginning of a stop friction jumps by what decelerated the joint; that jump is not in the line.

use std::ops::Range;

use crate::logged_motion::LoggedMotion;
use crate::regression_data::RegressionData;

/// Time within which a resting joint has not moved (s).
const WINDOW_S: f64 = 0.04;
/// Time before and after a rest in which the smoother of positions still sees it (s).
const AROUND_S: f64 = 0.02;
/// Longest stop with this law (s): in longer ones the controller pauses, too.
const LONGEST_S: f64 = 0.4;

/// Range of a resting joint's smoothed positions over their noise.
const STILL_SD: f64 = 5.0;

impl<const N: usize> LoggedMotion<N> {
    /// Finds the stops of all joints.
    pub(crate) fn find_short_rests(&mut self) {
        for burst in &self.bursts {
            for j in 0..N {
                let q_rad: Vec<f64> = self.motion[burst.fine.clone()].iter().map(|at| at.q[j]).collect();
                let still_rad = STILL_SD * self.position_sd_rad[j].max(self.lattice_sd_rad[j]);
                let rests = short_rests(&q_rad, self.period_s(burst), still_rad).into_iter();
                let start = burst.fine.start;
                self.short_rests[j].extend(rests.map(|rest| start + rest.start..start + rest.end));
            }
        }
    }
}

impl<const N: usize> RegressionData<N> {
    /// Friction of the nominal model where a joint that sticks stops for a moment.
    pub(crate) fn bridge_short_rests(&mut self) {
        for j in 0..N {
            let mut friction_nm: Vec<f64> = self.of_model.iter().map(|at| at.friction_nm[j]).collect();
            let mut sign: Vec<f64> = self.of_model.iter().map(|at| at.sign[j]).collect();
            bridge(&mut friction_nm, &self.logged.short_rests[j]);
            bridge(&mut sign, &self.logged.short_rests[j]);
            for (k, at) in self.of_model.iter_mut().enumerate() {
                at.model_nm[j] += friction_nm[k] - at.friction_nm[j];
                (at.friction_nm[j], at.sign[j]) = (friction_nm[k], sign[k]);
            }
        }
    }
}

/// The stretches of a burst in which a joint rests for a moment between two motions, with the moments before and after; `still_rad` is the most that
/// positions move by their noise.
fn short_rests(q_rad: &[f64], period_s: f64, still_rad: f64) -> Vec<Range<usize>> {
    let samples = |time_s: f64| (time_s / period_s).round() as usize;
    let (half, around, longest) = (samples(0.5 * WINDOW_S).max(1), samples(AROUND_S).max(1), samples(LONGEST_S));
    let still = |k: &usize| {
        let window = &q_rad[k - half..=k + half];
        // Of most samples the ends say enough.
        let moved = (window[0] - window[2 * half]).abs() >= still_rad;
        let most = || window.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = || window.iter().copied().fold(f64::INFINITY, f64::min);
        !moved && most() - least() < still_rad
    };
    let mut rests: Vec<Range<usize>> = Vec::new();
    for k in (half..q_rad.len().saturating_sub(half)).filter(still) {
        let seen = k - half..k + half + 1;
        match rests.last_mut() {
            Some(last) if seen.start <= last.end => last.end = seen.end,
            _ => rests.push(seen),
        }
    }
    let with_ends = |rest: Range<usize>| Some(rest.start.checked_sub(around)?..rest.end + around);
    let short = rests.into_iter().filter(|rest| rest.len() <= longest).filter_map(with_ends);
    short.filter(|rest| rest.end < q_rad.len()).collect()
}

/// Puts a straight line between the ends of each rest.
pub fn bridge(values: &mut [f64], rests: &[Range<usize>]) {
    for rest in rests {
        let (begin, end) = (values[rest.start], values[rest.end]);
        let slope = (end - begin) / rest.len() as f64;
        for (k, value) in values[rest.clone()].iter_mut().enumerate() {
            *value = begin + slope * k as f64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a joint that swings, stops for 0.2 s and swings back, the stop is bridged, with 20 ms on either side; a turn without a stop, a pause of two
    /// seconds and a rest at the end of the log are not.
    #[test]
    fn bridges_stops_between_two_motions() {
        let q = |t: f64| match t {
            t if t < 1.0 => (std::f64::consts::PI * t).sin(),
            t if t < 1.5 => (std::f64::consts::PI * t).sin().max(-0.5),
            t if t < 2.0 => -0.5 + (t - 1.5),
            t if t < 4.0 => 0.0,
            t if t < 5.0 => t - 4.0,
            _ => 1.0,
        };
        let positions: Vec<f64> = (0..5500).map(|k| q(f64::from(k) * 1e-3)).collect();
        let rests = short_rests(&positions, 1e-3, 1e-4);
        let stop_s = 1.0 + (0.5f64).asin() / std::f64::consts::PI;
        assert_eq!(rests.len(), 1, "{rests:?}");
        let [from_s, to_s] = [rests[0].start, rests[0].end].map(|k| k as f64 * 1e-3);
        assert!((from_s - (stop_s - 0.02)).abs() < 3e-3 && (to_s - 1.52).abs() < 3e-3, "{from_s} {to_s}");

        let mut values: Vec<f64> = (0..10).map(|k| f64::from(k * k)).collect();
        bridge(&mut values, &[2..5, 7..9]);
        assert_eq!(values, [0.0, 1.0, 4.0, 11.0, 18.0, 25.0, 36.0, 49.0, 65.0, 81.0]);
    }
}
