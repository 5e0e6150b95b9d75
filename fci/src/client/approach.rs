//! The way to the start.

use nalgebra::SVector;

/// Share of the speed limits that an approach uses.
const SPEED_SHARE: f64 = 0.2;
/// Peak speed of a minimum-jerk motion over its mean speed.
const PEAK_OVER_MEAN: f64 = 1.875;
/// Shortest approach (s).
const SHORTEST_S: f64 = 1.0;

/// `q(t) = from + (to − from)(10 s³ − 15 s⁴ + 6 s⁵)`, s = t/T.
#[derive(Clone, Copy, Debug)]
pub(super) struct MinimumJerk {
    pub(super) from: SVector<f64, 7>,
    pub(super) to: SVector<f64, 7>,
    pub(super) duration_s: f64,
}

impl MinimumJerk {
    /// Position (rad) at a time (s).
    pub(super) fn at(&self, time_s: f64) -> SVector<f64, 7> {
        let s = (time_s / self.duration_s).clamp(0.0, 1.0);
        self.from + (self.to - self.from) * (s * s * s * (10.0 - 15.0 * s + 6.0 * s * s))
    }
}

/// Time (s) in which no joint exceeds its share of the speed limits (rad/s).
pub(super) fn duration_s(from: &SVector<f64, 7>, to: &SVector<f64, 7>, limits: &SVector<f64, 7>) -> f64 {
    let per_joint = (to - from).abs().component_div(limits) * (PEAK_OVER_MEAN / SPEED_SHARE);
    per_joint.max().max(SHORTEST_S)
}
