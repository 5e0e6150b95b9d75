//! A robot that is watched, at one moment.

use nalgebra::Vector3;
use tribo_figure::Signals;
use tribo_watch::quantile;

use crate::live_feed::LiveTitle;
use crate::live_sample::LiveSample;

/// The last seconds of a robot, ready to be drawn.
#[derive(Debug)]
pub struct LiveSnapshot {
    /// What robot and watcher say of themselves.
    pub title: LiveTitle,
    /// The robot's mode and its errors.
    pub status: String,
    /// Why no more states come.
    pub ended: Option<String>,
    /// States that came.
    pub heard: u64,
    /// States that did not, by the robot's clock.
    pub lost: u64,
    /// The newest.
    pub newest: Option<LiveSample>,
    /// The arm at that moment: points (m) from base to flange.
    pub skeleton: Vec<Vector3<f64>>,
    /// Six components, each with the lower and the upper end of its 95 % band and the robot's own estimate behind it.
    pub wrench: Signals,
    /// Torques, velocities, positions.
    pub joints: Signals,
    /// Time between two states (ms), time of the estimator (µs).
    pub loop_times: Signals,
}

impl LiveSnapshot {
    /// Quantiles of a channel of the loop times: half, 99.9 %, all.
    pub fn quantiles(&self, channel: usize) -> Option<[f64; 3]> {
        let samples = self.loop_times.channels().get(channel)?.samples().iter();
        let mut times: Vec<f64> = samples.map(|time| f64::from(*time)).filter(|time| time.is_finite()).collect();
        times.sort_by(f64::total_cmp);
        Some([quantile(&times, 0.5)?, quantile(&times, 0.999)?, quantile(&times, 1.0)?])
    }
}
