//! The kinds of excitation.

use serde::{Deserialize, Serialize};

use super::poses::static_poses;
use super::strokes::Strokes;
use super::{Envelope, JointTrajectory, Multisine};

/// What a motion is good at showing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Excitation {
    /// Fourier series 0.1–0.8 Hz on all joints: inertial parameters.
    Multisine,
    /// Strokes at six speeds in both directions, each joint at its own: friction against speed.
    Cruise,
    /// Short strokes at 0.015–0.15 rad/s: reversals, Stribeck, presliding, ripple.
    BackAndForth,
    /// Poses held for 1 s, joined by quintic moves: gravity.
    StaticPoses,
    /// Fourier series 0.5–4 Hz within 0.12 rad: inertia and elasticity, and little else.
    SmallFast,
    /// Strokes of one joint at a time, the others at rest.
    JointByJoint,
}

/// Range of small motions (rad).
const SMALL_RAD: f64 = 0.12;
/// Fastest speed of slow motions [rad/s].
const SLOW_RAD_S: f64 = 0.15;

impl Excitation {
    /// Every kind.
    pub const ALL: [Self; 6] =
        [Self::Multisine, Self::Cruise, Self::BackAndForth, Self::StaticPoses, Self::SmallFast, Self::JointByJoint];

    /// One motion of this kind inside the envelope, `duration_s` (s) long; the same seed draws the same motion.
    pub fn draw<const N: usize>(
        self,
        envelope: &Envelope<N>,
        duration_s: f64,
        seed: u64,
    ) -> Box<dyn JointTrajectory<N>> {
        let strokes = Strokes { slowest_share: 0.05, speeds: 6, longest_s: 3.0, pause_s: 0.2 };
        match self {
            Self::Multisine => Box::new(Multisine::drawn(envelope, 0.1, 8, 2.0, duration_s, seed)),
            Self::Cruise => Box::new(strokes.draw(envelope, duration_s, seed)),
            Self::BackAndForth => {
                let strokes = Strokes { slowest_share: 0.1, longest_s: 1.5, pause_s: 0.1, ..strokes };
                Box::new(strokes.draw(&envelope.slower_than(SLOW_RAD_S), duration_s, seed))
            }
            Self::StaticPoses => Box::new(static_poses(envelope, 1.0, duration_s, seed)),
            Self::SmallFast => Box::new(Multisine::drawn(&envelope.within(SMALL_RAD), 0.5, 8, 1.0, duration_s, seed)),
            Self::JointByJoint => {
                let strokes = Strokes { speeds: 3, slowest_share: 0.15, longest_s: 1.5, ..strokes };
                Box::new(strokes.draw_joint_by_joint(envelope, duration_s, seed))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;
    use tribo_robot::{presets, rnea};

    /// Limits of the robot and of the envelope hold at every instant; derivatives agree; both ends rest at the centre.
    #[test]
    fn every_kind_is_smooth_and_safe() {
        let arm = presets::panda();
        let envelope = Envelope::of(&arm);
        for kind in Excitation::ALL {
            for seed in 0..4 {
                let duration_s = 20.0 + 10.0 * seed as f64;
                let motion = kind.draw(&envelope, duration_s, seed);
                assert!((motion.duration_s() - duration_s).abs() < 1e-9, "{kind:?} lasts {}", motion.duration_s());
                for end in [0.0, duration_s] {
                    let state = motion.at(end);
                    assert!((state.q - envelope.centre_rad).amax() < 1e-9 && state.qd.amax() < 1e-9, "{kind:?}");
                }
                let (h, n) = (1e-5, (duration_s / 7.3e-3) as usize);
                for k in 1..n {
                    let t = k as f64 * 7.3e-3;
                    let (a, s, b) = (motion.at(t - h), motion.at(t), motion.at(t + h));
                    assert!((s.q - envelope.centre_rad - envelope.half_range_rad).max() < 1e-9, "{kind:?} at {t}");
                    assert!((envelope.centre_rad - s.q - envelope.half_range_rad).max() < 1e-9, "{kind:?} at {t}");
                    assert!((s.qd.abs() - envelope.speed_rad_s).max() < 1e-6, "{kind:?} at {t}");
                    assert!((s.qdd.abs() - envelope.acceleration_rad_s2).max() < 0.05, "{kind:?} at {t}");
                    assert!(((b.q - a.q) / (2.0 * h) - s.qd).amax() < 1e-6, "{kind:?} at {t}");
                    assert!(((b.qd - a.qd) / (2.0 * h) - s.qdd).amax() < 1e-2, "{kind:?} at {t}");
                    let tau = rnea(&arm, &s.q, &s.qd, &s.qdd);
                    assert!((tau.abs() - arm.limits.tau_max_nm).max() < 0.0, "{kind:?}: {tau:?}");
                }
            }
        }
    }

    /// Every joint moves at speed in both directions, and no two speed profiles are copies of one another.
    #[test]
    fn joints_move_both_ways_and_out_of_step() {
        let envelope = Envelope::of(&presets::panda());
        for kind in Excitation::ALL {
            let motion = kind.draw(&envelope, 60.0, 3);
            let speeds: Vec<SVector<f64, 7>> = (0..6000).map(|k| motion.at(k as f64 * 0.01).qd).collect();
            for a in 0..7 {
                let (most, least) = speeds.iter().fold((0.0_f64, 0.0_f64), |m, v| (m.0.max(v[a]), m.1.min(v[a])));
                assert!(most > 0.05 && least < -0.05, "{kind:?}, joint {a}: {least} to {most}");
                for b in 0..a {
                    let dot = |x: usize, y: usize| speeds.iter().map(|v| v[x] * v[y]).sum::<f64>();
                    let correlation = dot(a, b) / (dot(a, a) * dot(b, b)).sqrt();
                    assert!(correlation.abs() < 0.8, "{kind:?}, joints {a} and {b}: {correlation}");
                }
            }
        }
    }

    #[test]
    fn the_seed_decides() {
        let envelope = Envelope::of(&presets::panda());
        let q = |seed| Excitation::Cruise.draw(&envelope, 20.0, seed).at(7.0).q;
        assert_eq!(q(1), q(1));
        assert_ne!(q(1), q(2));
    }
}
