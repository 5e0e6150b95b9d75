//! How long a wrench was on its way.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use tribo_runtime::LatencyHistogram;

/// Stamps further than this from the computer's clock are of another clock: a simulation, a bag, another computer.
const OTHER_CLOCK_NS: u64 = 10_000_000_000;

/// Times of the wrenches that went out.
#[derive(Clone, Debug)]
pub struct Ages {
    /// From the stamp of the joint state to when the wrench was handed to the network, by the computer's clock; empty where the stamps are of
    /// another clock.
    pub stamp_to_wrench: LatencyHistogram,
    /// From when the joint state was taken to when the wrench was handed over.
    pub taken_to_wrench: LatencyHistogram,
}

impl Ages {
    /// None yet; none at all where there is no memory for the buckets.
    pub fn new() -> Option<Self> {
        Some(Self { stamp_to_wrench: LatencyHistogram::new().ok()?, taken_to_wrench: LatencyHistogram::new().ok()? })
    }

    /// Counts a wrench that has just gone out.
    pub fn record(&mut self, stamp_ns: u64, took: Duration) {
        self.taken_to_wrench.record(u64::try_from(took.as_nanos()).unwrap_or(u64::MAX));
        if let Some(age_ns) = now_ns().checked_sub(stamp_ns).filter(|age_ns| *age_ns < OTHER_CLOCK_NS) {
            self.stamp_to_wrench.record(age_ns);
        }
    }
}

/// The computer's clock, since 1970 (ns).
pub(crate) fn now_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}
