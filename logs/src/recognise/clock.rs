//! Time stamps in another unit than seconds.

use super::{Fault, Remark};
use crate::bursts::median_period_s;

/// Longest median period (s) of a log that says something about an arm: five rows a second, where logs have 30 to 1000.
const LONGEST_PERIOD_S: f64 = 0.2;
/// Units of stamps: name and how many make a second.
const UNITS: [(&str, f64); 3] = [("milliseconds", 1e3), ("microseconds", 1e6), ("nanoseconds", 1e9)];
/// Rates at which robots log (Hz), with room.
const PLAUSIBLE_HZ: [f64; 2] = [20.0, 20_000.0];

/// Refuses stamps so far apart that they cannot be seconds: the first unit in which the rate is a robot's is named.
pub(super) fn too_slow(time_s: &[f64]) -> Option<Remark> {
    let period = median_period_s(time_s).filter(|period| *period > LONGEST_PERIOD_S)?;
    let plausible = |per_second: &f64| (PLAUSIBLE_HZ[0]..=PLAUSIBLE_HZ[1]).contains(&(per_second / period));
    let (evidence, remedy) = match UNITS.iter().find(|(_, per_second)| plausible(per_second)) {
        Some((unit, per_second)) => (
            format!(
                "the stamps are {period} apart: as seconds that is no robot, as {unit} it is {:.0} Hz",
                per_second / period
            ),
            format!("divide column time by {per_second:e}"),
        ),
        None => (
            format!("the stamps are {period} s apart, which is too slow for the motion of an arm"),
            format!("log at least one row every {LONGEST_PERIOD_S} s, with time in seconds"),
        ),
    };
    Some(Remark::refuse(Fault::Clock, Vec::new(), evidence, remedy))
}

/// The unit of which so many make a second, within 15 %.
pub(super) fn unit_of(per_second: f64) -> Option<(&'static str, f64)> {
    UNITS.into_iter().find(|(_, expected)| (per_second / expected).ln().abs() < 0.15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_named_and_slow_logs_refused() {
        let stamps = |period: f64| (0..50).map(|k| f64::from(k) * period).collect::<Vec<f64>>();
        for (period, expected) in [(1.0, "1e3"), (8.0, "1e3"), (1e3, "1e6"), (1e6, "1e9"), (2e6, "1e9")] {
            let remark = too_slow(&stamps(period)).expect("refused");
            assert!(remark.remedy.ends_with(expected), "{period}: {remark}");
        }
        assert!(too_slow(&stamps(0.01)).is_none() && too_slow(&[]).is_none());
        assert!(too_slow(&stamps(1e30)).is_some_and(|remark| remark.remedy.starts_with("log at least")));
    }
}
