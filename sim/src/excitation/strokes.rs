//! Strokes back and forth at several speeds.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{Envelope, JointProfile, Path};

/// Which strokes to draw.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strokes {
    /// Slowest speed as a share of the fastest.
    pub slowest_share: f64,
    /// Number of speeds, evenly spaced in their logarithm.
    pub speeds: usize,
    /// Longest time of one stroke (s).
    pub longest_s: f64,
    /// Longest pause between strokes (s).
    pub pause_s: f64,
}

impl Strokes {
    /// Every joint strokes out and back at its own speeds, in its own order, and ends where it began.
    pub fn draw<const N: usize>(&self, envelope: &Envelope<N>, duration_s: f64, seed: u64) -> Path<N> {
        let mut rng = Pcg64::seed_from_u64(seed);
        let joints = std::array::from_fn(|j| {
            let mut profile = JointProfile::resting_at(envelope.centre_rad[j]);
            profile.hold(rng.random_range(0.0..0.5_f64.min(0.1 * duration_s)));
            self.extend(&mut profile, envelope, j, duration_s, &mut rng);
            profile
        });
        Path::new(joints).lasting(duration_s)
    }

    /// One joint moves at a time, in random order.
    pub fn draw_joint_by_joint<const N: usize>(&self, envelope: &Envelope<N>, duration_s: f64, seed: u64) -> Path<N> {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut order: [usize; N] = std::array::from_fn(|j| j);
        shuffle(&mut order, &mut rng);
        let mut joints = std::array::from_fn(|j| JointProfile::resting_at(envelope.centre_rad[j]));
        for (turn, &j) in order.iter().enumerate() {
            let share_s = duration_s / N as f64;
            joints[j].hold(turn as f64 * share_s);
            self.extend(&mut joints[j], envelope, j, (turn + 1) as f64 * share_s, &mut rng);
        }
        Path::new(joints).lasting(duration_s)
    }

    /// Adds pairs of strokes until no further one fits before `until_s` (s), then the way home.
    fn extend<const N: usize>(
        &self,
        profile: &mut JointProfile,
        envelope: &Envelope<N>,
        joint: usize,
        until_s: f64,
        rng: &mut Pcg64,
    ) {
        let (centre, range) = (envelope.centre_rad[joint], envelope.half_range_rad[joint]);
        let (top, acceleration) = (envelope.speed_rad_s[joint], envelope.acceleration_rad_s2[joint]);
        if range <= 0.0 {
            return;
        }
        let fastest = top * rng.random_range(0.85..1.0);
        let ratio = self.slowest_share.powf(1.0 / (self.speeds.max(2) - 1) as f64);
        let mut speeds: Vec<f64> = (0..self.speeds).map(|k| fastest * ratio.powi(k as i32)).collect();
        shuffle(&mut speeds, rng);
        let longest_s = self.longest_s.min(0.2 * (until_s - profile.duration_s()));
        let home_s = |q: f64| JointProfile::cruise_time_s(q - centre, 0.5 * top, acceleration);
        let mut skipped = 0;
        for k in 0.. {
            // Out from here, back beyond it, both at the same speed; sides and lengths at random.
            let speed = speeds[k % speeds.len()];
            let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            let length = (speed * longest_s).min(2.0 * range) * rng.random_range(0.7..1.0);
            let out = (profile.end_rad() + side * length).clamp(centre - range, centre + range);
            let back = (out - side * length * rng.random_range(0.8..1.2)).clamp(centre - range, centre + range);
            let pauses = [0.0; 2].map(|_: f64| rng.random_range(0.3..1.0) * self.pause_s);
            let time = |way: f64| JointProfile::cruise_time_s(way, speed, acceleration);
            let pair_s = time(out - profile.end_rad()) + time(back - out) + pauses[0] + pauses[1];
            if profile.duration_s() + pair_s + home_s(back) > until_s {
                skipped += 1;
                if skipped > speeds.len() {
                    break;
                }
                continue;
            }
            for (target, pause_s) in [out, back].into_iter().zip(pauses) {
                profile.cruise_to(target, speed, acceleration);
                profile.hold(pause_s);
            }
        }
        profile.cruise_to(centre, 0.5 * top, acceleration);
    }
}

/// Fisher and Yates.
fn shuffle<T>(items: &mut [T], rng: &mut Pcg64) {
    for k in (1..items.len()).rev() {
        items.swap(k, rng.random_range(0..=k));
    }
}
