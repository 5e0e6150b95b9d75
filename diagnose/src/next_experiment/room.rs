//! Where and how fast the arm may move.

use nalgebra::SVector;
use tribo_regression::RegressionData;
use tribo_sim::excitation::Envelope;

use super::motion::Motion;
use super::pair::Pair;

/// Part of the way from the posture to the nearer joint limit that is used [-].
const ROOM_SHARE: f64 = 0.8;
/// Part of the speed limit that is used [-].
const SPEED_SHARE: f64 = 0.6;
/// Fastest speed [rad/s] where the arm states no limit.
const SPEED_RAD_S: f64 = 1.0;
/// Part of a joint's range that the posture keeps from either limit [-].
const MARGIN: f64 = 0.15;
/// Farthest excursion (rad) of poses that tilt the arm.
const TILT_RAD: f64 = 1.2;
/// Excursion (rad) of small fast motions.
const SMALL_RAD: f64 = 0.12;

/// Around the mean posture of the log:
///
/// ```text
/// |q − mean| ≤ 0.8 (way to the nearer limit), at most 0.8 rad (1.2 rad to tilt);   |q̇| ≤ 0.6 q̇_max
/// ```
///
/// A joint that need not move has no room.
pub(super) fn of<const N: usize>(data: &RegressionData<N>, pair: &Pair, motion: Motion) -> Envelope<N> {
    let arm = &data.nominal.arm;
    let limits = &arm.limits;
    let sum = data.motion.iter().fold(SVector::<f64, N>::zeros(), |sum, at| sum + at.q);
    let mean = sum / data.motion.len().max(1) as f64;
    let centre_rad = SVector::from_fn(|j, _| {
        let (low, high) = (limits.q_min_rad[j], limits.q_max_rad[j]);
        let margin = MARGIN * (high - low);
        if margin.is_finite() && margin > 0.0 { mean[j].clamp(low + margin, high - margin) } else { mean[j] }
    });
    let usual = Envelope::around(arm, centre_rad);
    let half_range_rad = SVector::from_fn(|j, _| {
        let room = (limits.q_max_rad[j] - centre_rad[j]).min(centre_rad[j] - limits.q_min_rad[j]).max(0.0);
        let wanted = match motion {
            Motion::TiltedPoses => TILT_RAD,
            Motion::SmallAndFast => SMALL_RAD,
            _ => usual.half_range_rad[j],
        };
        let moves = pair.own_joint().is_none_or(|own| own == j);
        if moves { wanted.min(ROOM_SHARE * room) } else { 0.0 }
    });
    let speed_rad_s = limits.qd_max_rad_s.map(|v| if v.is_finite() { SPEED_SHARE * v } else { SPEED_RAD_S });
    Envelope { half_range_rad, speed_rad_s, ..usual }
}
