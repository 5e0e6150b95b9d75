//! How long something took, a million times.

use hdrhistogram::{CreationError, Histogram};

/// Longest time told apart from longer ones (ns): a minute.
const LONGEST_NS: u64 = 60_000_000_000;
/// Significant decimal digits of a bucket.
const DIGITS: u8 = 3;

/// Histogram of durations in fixed buckets (HDR: equal in relative width, 0.1 %, from 1 ns to a minute). Recording
/// allocates nothing. Mean and maximum are exact.
#[derive(Clone, Debug)]
pub struct LatencyHistogram {
    buckets: Histogram<u64>,
    sum_ns: u64,
    max_ns: u64,
}

impl LatencyHistogram {
    /// An empty histogram; this is where its memory comes from.
    ///
    /// # Errors
    /// None with bounds as they are.
    pub fn new() -> Result<Self, CreationError> {
        Ok(Self { buckets: Histogram::new_with_bounds(1, LONGEST_NS, DIGITS)?, sum_ns: 0, max_ns: 0 })
    }

    /// Counts one duration (ns).
    #[inline]
    pub fn record(&mut self, duration_ns: u64) {
        self.buckets.saturating_record(duration_ns);
        self.sum_ns = self.sum_ns.saturating_add(duration_ns);
        self.max_ns = self.max_ns.max(duration_ns);
    }

    /// Durations counted.
    pub fn count(&self) -> u64 {
        self.buckets.len()
    }

    /// Durations of `limit_us` (µs) and longer, to the width of a bucket.
    pub fn count_from(&self, limit_us: f64) -> u64 {
        self.buckets.count_between((limit_us * 1e3) as u64, LONGEST_NS)
    }

    /// Mean (µs); 0 without durations.
    pub fn mean_us(&self) -> f64 {
        self.sum_ns as f64 * 1e-3 / self.count().max(1) as f64
    }

    /// Longest (µs).
    pub fn max_us(&self) -> f64 {
        self.max_ns as f64 * 1e-3
    }

    /// The least time (µs) that a share `p` (0 to 1) of all durations does not exceed, to the width of a bucket.
    pub fn quantile_us(&self, p: f64) -> f64 {
        self.buckets.value_at_quantile(p).min(self.max_ns) as f64 * 1e-3
    }

    /// Number of durations below each of `edges_us` (µs, ascending) and not below the one before; last, the rest.
    pub fn counts_between(&self, edges_us: &[f64]) -> Vec<u64> {
        let below: Vec<u64> = edges_us.iter().map(|edge| self.count() - self.count_from(*edge)).collect();
        let firsts = std::iter::once(0).chain(below.iter().copied());
        let lasts = below.iter().copied().chain(std::iter::once(self.count()));
        firsts.zip(lasts).map(|(first, last)| last - first).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: 1 … 1000 µs, each once.
    #[test]
    fn quantiles_of_a_ramp() {
        let mut histogram = LatencyHistogram::new().expect("valid bounds");
        (1..=1000).for_each(|k| histogram.record(k * 1000));
        for p in [0.5, 0.99, 0.999, 1.0] {
            let (found, expected) = (histogram.quantile_us(p), 1000.0 * p);
            assert!((found / expected - 1.0).abs() < 2e-3, "{p}: {found}");
        }
        assert_eq!((histogram.mean_us(), histogram.max_us()), (500.5, 1000.0));
        assert_eq!(histogram.count_from(901.0), 100);
        assert_eq!(histogram.counts_between(&[11.0, 901.0]), [10, 890, 100]);
    }

    /// Beyond the last bucket a duration still counts, and the longest is told truthfully.
    #[test]
    fn an_hour_is_not_lost() {
        let mut histogram = LatencyHistogram::new().expect("valid bounds");
        histogram.record(3_600_000_000_000);
        assert_eq!((histogram.count(), histogram.count_from(100.0)), (1, 1));
        assert_eq!(histogram.max_us(), 3.6e9);
    }
}
