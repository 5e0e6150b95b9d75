//! The room a motion may use.

use nalgebra::SVector;
use tribo_robot::Arm;

/// Farthest excursion from the centre (rad) unless asked otherwise: half the workspace of a table-top arm.
const HALF_RANGE_RAD: f64 = 0.8;
/// Share of half the joint range that a motion may use [-].
const RANGE_SHARE: f64 = 0.6;
/// Share of the joint speed limit that a motion may use [-].
const SPEED_SHARE: f64 = 0.7;
/// Fastest joint speed [rad/s] where the arm states no limit.
const SPEED_RAD_S: f64 = 2.0;
/// Largest joint acceleration [rad/s²]: below the 7.5 rad/s² of the Panda's slowest joint.
const ACCELERATION_RAD_S2: f64 = 5.0;

/// Bounds of a motion, joint by joint:
///
/// ```text
/// |q − centre| ≤ half range,   |q̇| ≤ speed,   |q̈| ≤ acceleration
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope<const N: usize> {
    /// Where motions start and end (rad).
    pub centre_rad: SVector<f64, N>,
    /// Farthest excursion from the centre (rad).
    pub half_range_rad: SVector<f64, N>,
    /// Highest speed [rad/s].
    pub speed_rad_s: SVector<f64, N>,
    /// Highest acceleration [rad/s²].
    pub acceleration_rad_s2: SVector<f64, N>,
}

impl<const N: usize> Envelope<N> {
    /// Around the middle of the joint ranges.
    pub fn of(arm: &Arm<N>) -> Self {
        let middle = 0.5 * (arm.limits.q_min_rad + arm.limits.q_max_rad);
        Self::around(arm, middle.map(|q| if q.is_finite() { q } else { 0.0 }))
    }

    /// Around a pose (rad) inside the joint limits.
    pub fn around(arm: &Arm<N>, centre_rad: SVector<f64, N>) -> Self {
        let limits = &arm.limits;
        Self {
            centre_rad,
            half_range_rad: SVector::from_fn(|j, _| {
                let half = 0.5 * (limits.q_max_rad[j] - limits.q_min_rad[j]);
                let room = (limits.q_max_rad[j] - centre_rad[j]).min(centre_rad[j] - limits.q_min_rad[j]);
                HALF_RANGE_RAD.min(RANGE_SHARE * half).min(0.95 * room).max(0.0)
            }),
            speed_rad_s: limits.qd_max_rad_s.map(|v| if v.is_finite() { SPEED_SHARE * v } else { SPEED_RAD_S }),
            acceleration_rad_s2: SVector::repeat(ACCELERATION_RAD_S2),
        }
    }

    /// The same envelope with ranges of at most `half_range_rad` (rad).
    pub fn within(self, half_range_rad: f64) -> Self {
        Self { half_range_rad: self.half_range_rad.map(|range| range.min(half_range_rad)), ..self }
    }

    /// The same envelope with speeds of at most `speed_rad_s` [rad/s].
    pub fn slower_than(self, speed_rad_s: f64) -> Self {
        Self { speed_rad_s: self.speed_rad_s.map(|speed| speed.min(speed_rad_s)), ..self }
    }
}
