//! What else happens on a core while the loop runs.

use std::time::{Duration, Instant};

use serde::Serialize;
use tribo_runtime::LatencyHistogram;

use super::BenchError;

/// What is longer than this (µs) is no part of a tick.
pub const DISTURBANCE_US: f64 = 100.0;

/// Ticks that were disturbed, beside a loop that does nothing on the same core.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interference {
    /// Ticks of 100 µs and longer.
    pub ticks_above_100_us: u64,
    /// Ticks per second of measurement that they are, so that they can be held against the next.
    pub ticks_above_100_us_per_s: f64,
    /// The same of a loop that only reads the clock: what no program of ours can help.
    pub idle_gaps_above_100_us_per_s: f64,
    /// Longest gap of that loop (µs).
    pub idle_gap_max_us: f64,
    /// How often the system gave the core to somebody else during the ticks; none where it does not say.
    pub preempted: Option<u64>,
}

/// Gaps between readings of the clock by a loop that does nothing else.
///
/// # Errors
/// A histogram that cannot be.
pub fn idle_gaps(length: Duration) -> Result<LatencyHistogram, BenchError> {
    let mut gaps = LatencyHistogram::new()?;
    let started = Instant::now();
    let mut last = started;
    while last.duration_since(started) < length {
        let now = Instant::now();
        gaps.record(u64::try_from(now.duration_since(last).as_nanos()).unwrap_or(u64::MAX));
        last = now;
    }
    Ok(gaps)
}

/// Involuntary context switches of the calling thread since its start, of Linux.
pub fn preemptions() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/thread-self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("nonvoluntary_ctxt_switches:"))?;
    line.trim().parse().ok()
}
