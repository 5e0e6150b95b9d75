//! The filters between a log and the residual equation, with every number they were given.

use std::fmt;

use tribo_logs::{GAP_TOLERANCE, RobotLog, median_period_s};

use crate::ResidualError;
use crate::filter::ZeroPhaseLowPass;

/// What the caller chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualSettings {
    /// Cut-off of the band filter (Hz), at most 0.35 of the sample rate. 10 Hz holds the motion of an arm and leaves
    /// out most of the noise of its acceleration, which grows with the square of frequency.
    pub band_hz: f64,
    /// Longest step between stamps to interpolate across (s); a longer one splits bursts. `None` takes the larger of
    /// 1.5 median periods and a tenth of 1/band: a hole that the band cannot see is no gap.
    pub longest_gap_s: Option<f64>,
    /// Samples averaged into one after filtering; 1 keeps the rate of the log. Columns are averaged likewise.
    pub average_samples: usize,
    /// Cut-off of the position smoother over the band. 3 leaves 99.9 % of an amplitude at the band, and velocities that follow
    /// a sharp reversal; 1 makes velocities as smooth as the torques.
    pub smoothing_over_band: f64,
}

impl Default for ResidualSettings {
    fn default() -> Self {
        Self { band_hz: 10.0, longest_gap_s: None, average_samples: 1, smoothing_over_band: SMOOTHING_OVER_BAND }
    }
}

/// Order of each pass of both filters: the roll-off of both passes is then that of order six.
const ORDER: usize = 3;
/// Cut-off of the position smoother over the band: the smoother leaves 99.9 % of an amplitude at the band.
const SMOOTHING_OVER_BAND: f64 = 3.0;
/// Highest cut-off over the sample rate. The 8th-order difference errs by 0.6 % at 0.2 and by 23 % here.
const HIGHEST_CUTOFF: f64 = 0.35;
/// Time after which the smoother has forgotten the end of a burst (but for 1e-4), in periods of its cut-off.
const SETTLE_PERIODS: f64 = 3.0;
/// Time dropped at each end after the band filter, in periods of the band: there it still follows single samples.
const TRIM_PERIODS: f64 = 0.5;
/// Least time dropped at each end after the band filter (s).
const LEAST_TRIM_S: f64 = 0.05;
/// Longest default gap, in periods of the band.
pub(crate) const GAP_PERIODS: f64 = 0.1;
/// Knots per period of the smoother's cut-off, see [`crate::filter`]: regressors are then right to 2e-5 up to there.
const KNOTS_PER_PERIOD: f64 = 16.0;
/// Distance at which a filtered sample has forgotten another, in periods of the band.
const MEMORY_PERIODS: f64 = 2.0;

/// The resolved signal chain.
///
/// ```text
/// q_s = S q,   qd = D q_s,   qdd = D qd,   model = B rnea(q_s, qd, qdd),   measured = B S tau,   column = B φ(q_s, qd, qdd)
/// ```
///
/// S and B are zero-phase Butterworth filters of third order per pass, at `smoothing_hz` and `band_hz` (each at half
/// amplitude there), D the central difference of 8th order. tau passes S as well, so where the dynamics are linear both
/// sides see one and the same filter. What S and D guess at the ends of a burst (`settle_s`) is dropped before B, which
/// then treats equal signals equally up to its own ends (`trim_s`).
#[derive(Clone, Debug, PartialEq)]
pub struct SignalChain {
    /// Cut-off of the band filter B (Hz).
    pub band_hz: f64,
    /// Cut-off of the smoother S (Hz): three bands, or 0.35 of the sample rate if that is less.
    pub smoothing_hz: f64,
    /// Rate of the uniform grid before averaging (Hz): one over the median period of the log.
    pub rate_hz: f64,
    /// Longest step between stamps that was interpolated across (s).
    pub longest_gap_s: f64,
    /// Time dropped at each end of a burst before the band filter (s): three periods of the smoother.
    pub settle_s: f64,
    /// Time dropped at each end of a burst after the band filter (s): half a period of the band, at least 50 ms.
    pub trim_s: f64,
    /// Samples averaged into one.
    pub average_samples: usize,
    smoother: ZeroPhaseLowPass,
    band: ZeroPhaseLowPass,
}

impl SignalChain {
    /// Resolves the settings against the rate of a log.
    pub fn resolve(log: &RobotLog, settings: &ResidualSettings) -> Result<Self, ResidualError> {
        let period_s = median_period_s(&log.time_s).unwrap_or(0.0);
        let rate_hz = period_s.recip();
        let ResidualSettings { band_hz, longest_gap_s, average_samples, smoothing_over_band } = *settings;
        let highest_hz = HIGHEST_CUTOFF * rate_hz;
        if !(band_hz > 0.0 && band_hz <= highest_hz) {
            return Err(ResidualError::Band { band_hz, highest_hz, rate_hz });
        }
        let longest_gap_s = longest_gap_s.unwrap_or(f64::max(GAP_TOLERANCE * period_s, GAP_PERIODS / band_hz));
        if !(longest_gap_s >= period_s && longest_gap_s.is_finite()) {
            return Err(ResidualError::LongestGap { longest_gap_s, period_s });
        }
        if average_samples == 0 {
            return Err(ResidualError::NothingAveraged);
        }
        let smoothing_hz = f64::min(smoothing_over_band * band_hz, highest_hz);
        Ok(Self {
            band_hz,
            smoothing_hz,
            rate_hz,
            longest_gap_s,
            settle_s: SETTLE_PERIODS / smoothing_hz,
            trim_s: f64::max(LEAST_TRIM_S, TRIM_PERIODS / band_hz),
            average_samples,
            smoother: ZeroPhaseLowPass::butterworth(ORDER, smoothing_hz, rate_hz)?,
            band: ZeroPhaseLowPass::butterworth(ORDER, band_hz, rate_hz)?,
        })
    }

    /// Rate of the samples that come out (Hz).
    pub fn output_rate_hz(&self) -> f64 {
        self.rate_hz / self.average_samples as f64
    }

    /// Time after which an output no longer feels an input (s): below 0.2 %.
    pub fn memory_s(&self) -> f64 {
        MEMORY_PERIODS / self.band_hz + self.average_samples as f64 / self.rate_hz
    }

    /// Gain of the whole chain on a measured torque at `frequency_hz`, averaging aside.
    pub fn gain(&self, frequency_hz: f64) -> f64 {
        self.smoother.gain(frequency_hz) * self.band.gain(frequency_hz)
    }

    /// Gain of the smoother alone, which velocities pass, at `frequency_hz`.
    pub fn smoothing_gain(&self, frequency_hz: f64) -> f64 {
        self.smoother.gain(frequency_hz)
    }

    /// Shortest burst that leaves something (s): what both ends lose, and one period of the band or one average.
    pub fn shortest_burst_s(&self) -> f64 {
        2.0 * (self.settle_s + self.trim_s) + f64::max(self.band_hz.recip(), self.average_samples as f64 / self.rate_hz)
    }

    /// S x for several x of one burst.
    pub(crate) fn smooth_all(&self, signals: &[Vec<f64>]) -> Vec<Vec<f64>> {
        self.smoother.filter_all(signals)
    }

    /// Samples from one knot of a smooth function of the smoothed motion to the next.
    pub(crate) fn knot_stride(&self) -> usize {
        (self.rate_hz / (KNOTS_PER_PERIOD * self.smoothing_hz)).floor().max(1.0) as usize
    }

    /// x without what the smoother guessed at the ends.
    pub(crate) fn settled<'a, T>(&self, x: &'a [T]) -> &'a [T] {
        self.without_ends(x, self.settle_s)
    }

    /// B x for settled x, ends trimmed, averaged: one burst of a column.
    pub(crate) fn finish(&self, x: &[f64]) -> Vec<f64> {
        self.trim_and_average(&self.band.filter(x))
    }

    /// B x for several settled x of one burst, ends trimmed, averaged.
    pub(crate) fn finish_all<S: AsRef<[f64]>>(
        &self,
        signals: impl IntoIterator<Item = S, IntoIter: ExactSizeIterator>,
    ) -> Vec<Vec<f64>> {
        self.band.filter_each(signals, |x| self.trim_and_average(x))
    }

    /// B x for settled x, as long as x.
    pub(crate) fn in_band(&self, x: &[f64]) -> Vec<f64> {
        self.band.filter(x)
    }

    /// Settled x without its ends, averaged.
    pub(crate) fn trim_and_average(&self, x: &[f64]) -> Vec<f64> {
        let parts = self.without_ends(x, self.trim_s).chunks_exact(self.average_samples);
        parts.map(|part| part.iter().sum::<f64>() / part.len() as f64).collect()
    }

    fn without_ends<'a, T>(&self, x: &'a [T], end_s: f64) -> &'a [T] {
        let end = (end_s * self.rate_hz).round() as usize;
        x.get(end..x.len().saturating_sub(end)).unwrap_or_default()
    }
}

impl fmt::Display for SignalChain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "zero-phase Butterworth (order {ORDER} forward and backward, half amplitude at {:.4} Hz; positions smoothed \
             at {:.4} Hz), grid {:.1} Hz, gaps up to {:.1} ms interpolated, {:.0} ms trimmed at burst ends",
            self.band_hz,
            self.smoothing_hz,
            self.rate_hz,
            1e3 * self.longest_gap_s,
            1e3 * (self.settle_s + self.trim_s)
        )?;
        match self.average_samples {
            1 => Ok(()),
            count => write!(f, ", {count} samples averaged to {:.1} Hz", self.output_rate_hz()),
        }
    }
}
