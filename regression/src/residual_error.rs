//! Why a log has no torque residual.

use tribo_files::LogError;

use crate::filter::FilterError;

/// Why a log has no torque residual.
#[derive(Debug, thiserror::Error)]
pub enum ResidualError {
    /// The log and the arm disagree about the number of joints.
    #[error("the log has {log} joints, the model {arm}")]
    JointCount {
        /// Joints of the log.
        log: usize,
        /// Joints of the arm.
        arm: usize,
    },
    /// The band does not fit the sample rate.
    #[error("band {band_hz} Hz is outside (0, {highest_hz:.3}] Hz, 0.35 of the log's {rate_hz:.1} Hz")]
    Band {
        /// Band asked for (Hz).
        band_hz: f64,
        /// Highest possible (Hz).
        highest_hz: f64,
        /// Rate of the log (Hz).
        rate_hz: f64,
    },
    /// The gap tolerance is below the period of the log.
    #[error("longest gap {longest_gap_s} s is outside [{period_s}, inf) s: it must hold one period of the log")]
    LongestGap {
        /// Tolerance asked for (s).
        longest_gap_s: f64,
        /// Median period of the log (s).
        period_s: f64,
    },
    /// An average over no samples.
    #[error("average_samples: 0 is outside [1, inf)")]
    NothingAveraged,
    /// No stretch without a gap is long enough for the filter.
    #[error(
        "the longest of {bursts} bursts lasts {longest_burst_s:.3} s, a band of {band_hz:.1} Hz needs {need_s:.3} s"
    )]
    TooShort {
        /// Duration of the longest burst (s).
        longest_burst_s: f64,
        /// Duration needed (s).
        need_s: f64,
        /// Number of bursts.
        bursts: usize,
        /// Band asked for (Hz).
        band_hz: f64,
    },
    /// The model answers NaN or infinity.
    #[error("the model torque of joint {joint} at {time_s:.3} s is not finite")]
    ModelNotFinite {
        /// Joint, from 0.
        joint: usize,
        /// Time of the first such sample (s).
        time_s: f64,
    },
    /// The log could not be put on a uniform grid.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The filters could not be designed.
    #[error(transparent)]
    Filter(#[from] FilterError),
}
