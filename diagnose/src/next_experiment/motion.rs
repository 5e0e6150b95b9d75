//! The library of motions.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use tribo_regression::CauseLabel;
use tribo_sim::excitation::{Envelope, ViaPoints};

use super::pair::Pair;

/// A motion of minimum-jerk moves that rest at every via point, as a trajectory file plays it:
///
/// ```text
/// q(t) = q_k + Δq (10 s³ − 15 s⁴ + 6 s⁵),   max |q̇| = 1.875 Δq/Δt,   max |q̈| = 5.774 Δq/Δt²
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// Short strokes at 0.02–0.15 rad/s: reversals, low speed.
    SlowBackAndForth,
    /// Strokes both ways at six speeds, with holds: friction against speed.
    MultiSpeedStrokes,
    /// Poses held for 1 s.
    StaticPoses,
    /// Poses held for 1 s, turned as far as the joints allow: gravity from many directions.
    TiltedPoses,
    /// Large moves without a rest: dynamics.
    FastMoves,
    /// Moves within 0.12 rad as fast as allowed: delay, elasticity, inertia.
    SmallAndFast,
    /// One cycle logged every five minutes from cold.
    WarmUpCycles,
    /// Large moves, without and with a known body at the flange.
    KnownPayload,
}

/// Peak speed of a minimum-jerk move over its mean speed.
pub(super) const PEAK_SPEED: f64 = 1.875;
/// Peak acceleration of a minimum-jerk move times its time squared over its length.
const PEAK_ACCELERATION: f64 = 5.773_502_691_896_258;
/// Length of a motion (s).
const DURATION_S: f64 = 26.0;
/// Length of a cycle of a warm-up (s).
const CYCLE_S: f64 = 12.0;
/// Speeds of strokes, slowest over fastest.
const SPEED_SHARES: [f64; 6] = [0.04, 0.08, 0.15, 0.3, 0.6, 1.0];
/// Slow speeds [rad/s].
const SLOW_RAD_S: [f64; 2] = [0.02, 0.15];
/// Time that poses are held (s).
const HOLD_S: f64 = 1.0;
/// Shortest move (s).
const SHORTEST_S: f64 = 0.1;
/// Part of speed and acceleration limits that a move uses at most.
const USED: f64 = 0.98;
const SEED: u64 = 20;

impl Motion {
    /// Every motion, least effort first.
    pub const ALL: [Self; 8] = [
        Self::MultiSpeedStrokes,
        Self::SlowBackAndForth,
        Self::StaticPoses,
        Self::SmallAndFast,
        Self::FastMoves,
        Self::TiltedPoses,
        Self::KnownPayload,
        Self::WarmUpCycles,
    ];

    /// Name in files: `slow_back_and_forth`.
    pub fn name(self) -> &'static str {
        match self {
            Self::SlowBackAndForth => "slow_back_and_forth",
            Self::MultiSpeedStrokes => "multi_speed_strokes",
            Self::StaticPoses => "static_poses",
            Self::TiltedPoses => "tilted_poses",
            Self::FastMoves => "fast_moves",
            Self::SmallAndFast => "small_fast_motion",
            Self::WarmUpCycles => "warm_up_cycles",
            Self::KnownPayload => "known_payload",
        }
    }

    /// Whether the motion has a point for this pair.
    pub fn suits(self, pair: &Pair) -> bool {
        use CauseLabel::{LinkInertial, LoadFriction, Payload, ThermalFriction, TorqueGain};
        match self {
            Self::WarmUpCycles => pair.names(ThermalFriction),
            Self::KnownPayload => {
                [TorqueGain, LinkInertial, Payload, LoadFriction].into_iter().any(|label| pair.names(label))
            }
            _ => !pair.names(ThermalFriction),
        }
    }

    /// Evidence that must make up for the trouble, over that of a gentle motion.
    pub fn effort(self) -> f64 {
        match self {
            Self::KnownPayload => 10.0,
            Self::FastMoves | Self::SmallAndFast | Self::TiltedPoses => 2.0,
            _ => 1.0,
        }
    }

    /// The via points inside the envelope, starting and ending at its centre; always the same.
    pub fn draw<const N: usize>(self, envelope: &Envelope<N>) -> ViaPoints<N> {
        let mut moves = Moves::new(envelope);
        let until_s = if self == Self::WarmUpCycles { CYCLE_S } else { DURATION_S };
        match self {
            Self::SlowBackAndForth => moves.slow(until_s),
            Self::MultiSpeedStrokes | Self::WarmUpCycles => moves.strokes(until_s),
            Self::StaticPoses | Self::TiltedPoses => moves.poses(until_s, HOLD_S),
            Self::FastMoves | Self::KnownPayload | Self::SmallAndFast => moves.poses(until_s, 0.0),
        }
        let home = envelope.centre_rad;
        let home_s = match self {
            Self::SlowBackAndForth => PEAK_SPEED * (home - moves.end_rad).amax() / SLOW_RAD_S[1],
            _ => SHORTEST_S,
        };
        moves.go(home, home_s);
        ViaPoints { time_s: moves.time_s, q_rad: moves.q_rad, resting: true }
    }
}

/// Via points as they are drawn.
struct Moves<'e, const N: usize> {
    envelope: &'e Envelope<N>,
    rng: Pcg64,
    time_s: Vec<f64>,
    q_rad: Vec<SVector<f64, N>>,
    end_s: f64,
    end_rad: SVector<f64, N>,
}

impl<'e, const N: usize> Moves<'e, N> {
    fn new(envelope: &'e Envelope<N>) -> Self {
        let (rng, start) = (Pcg64::seed_from_u64(SEED), envelope.centre_rad);
        Self { envelope, rng, time_s: vec![0.0], q_rad: vec![start], end_s: 0.0, end_rad: start }
    }

    /// To q (rad) in `time_s` (s), or as long as the limits ask for.
    fn go(&mut self, q: SVector<f64, N>, time_s: f64) {
        let needed_s = (0..N).map(|j| {
            let way = (q[j] - self.end_rad[j]).abs();
            let by_speed = PEAK_SPEED * way / (USED * self.envelope.speed_rad_s[j]);
            let by_acceleration = (PEAK_ACCELERATION * way / (USED * self.envelope.acceleration_rad_s2[j])).sqrt();
            by_speed.max(by_acceleration)
        });
        self.end_s += needed_s.fold(time_s.max(SHORTEST_S), f64::max);
        self.end_rad = q;
        self.time_s.push(self.end_s);
        self.q_rad.push(q);
    }

    fn hold(&mut self, time_s: f64) {
        self.go(self.end_rad, time_s);
    }

    /// Random poses of the envelope, each reached as fast as allowed or a little slower.
    fn poses(&mut self, until_s: f64, hold_s: f64) {
        while self.end_s < until_s - hold_s {
            let envelope = self.envelope;
            let pose = SVector::from_fn(|j, _| {
                envelope.centre_rad[j] + envelope.half_range_rad[j] * self.rng.random_range(-1.0..1.0)
            });
            self.go(pose, SHORTEST_S);
            if hold_s > 0.0 {
                self.hold(hold_s);
            }
        }
    }

    /// Strokes out and back, each joint at its own slow speed.
    fn slow(&mut self, until_s: f64) {
        while self.end_s < until_s {
            let time_s = self.rng.random_range(0.8..2.0);
            let ratio: f64 = SLOW_RAD_S[1] / SLOW_RAD_S[0];
            let speeds = SVector::from_fn(|_, _| SLOW_RAD_S[0] * ratio.powf(self.rng.random_range(0.0..1.0)));
            self.out_and_back(&speeds, time_s);
        }
    }

    /// Strokes out and back at every speed in turn, each joint at another, and a hold after each pair.
    fn strokes(&mut self, until_s: f64) {
        let mut turn = 0;
        while self.end_s < until_s {
            let time_s = self.rng.random_range(0.7..1.6);
            let top = self.envelope.speed_rad_s;
            let speeds = SVector::from_fn(|j, _| {
                let share = SPEED_SHARES[(5 * turn + (2 * j + turn / SPEED_SHARES.len())) % SPEED_SHARES.len()];
                USED * share * top[j]
            });
            self.out_and_back(&speeds, time_s);
            self.hold(HOLD_S);
            turn += 1;
        }
    }

    /// Each joint `Δq = q̇_peak Δt/1.875` to a random side, and back a little past its start.
    fn out_and_back(&mut self, speeds: &SVector<f64, N>, time_s: f64) {
        let (from, envelope) = (self.end_rad, self.envelope);
        let inside = |j: usize, q: f64| {
            let (centre, range) = (envelope.centre_rad[j], envelope.half_range_rad[j]);
            q.clamp(centre - range, centre + range)
        };
        let way = speeds * (time_s / PEAK_SPEED);
        let out = SVector::from_fn(|j, _| {
            let side = if self.rng.random_bool(0.5) { 1.0 } else { -1.0 };
            let (one, other) = (inside(j, from[j] + side * way[j]), inside(j, from[j] - side * way[j]));
            if (one - from[j]).abs() >= (other - from[j]).abs() { one } else { other }
        });
        self.go(out, time_s);
        let back = SVector::from_fn(|j, _| inside(j, out[j] + (from[j] - out[j]) * self.rng.random_range(0.9..1.2)));
        self.go(back, time_s);
    }
}
