//! Bursts: the stretches of a log without a gap.
//!
//! ```text
//! a burst ends after row k  where  t_{k+1} − t_k > tolerance · median(t_{j+1} − t_j)
//! ```
//!
//! The default tolerance 1.5 is the contract for logs of a regular clock: one lost sample is a gap. A log with
//! irregular stamps needs more: on the Panda log of gaz2019 (nominal 1 ms, repeats dropped) 1.5 gives 1360 bursts,
//! 3 gives 49, 5 gives 9 and 10 gives 2. Choose it so that interpolation across a gap is still believable.

use std::ops::Range;

/// Default gap tolerance in median periods: the first lost sample of a regular clock splits.
pub const GAP_TOLERANCE: f64 = 1.5;

/// Median of the differences of neighbouring stamps (s); `None` for fewer than two stamps.
#[must_use]
pub fn median_period_s(time_s: &[f64]) -> Option<f64> {
    let mut periods_s: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = periods_s.len() / 2;
    if periods_s.is_empty() {
        return None;
    }
    let (below, &mut upper, _) = periods_s.select_nth_unstable_by(middle, f64::total_cmp);
    let lower = below.iter().copied().max_by(f64::total_cmp);
    match lower {
        Some(lower) if time_s.len() % 2 == 1 => Some(0.5 * (lower + upper)),
        _ => Some(upper),
    }
}

/// Row ranges of the bursts of strictly increasing stamps; together they cover every row.
#[must_use]
pub fn bursts(time_s: &[f64], tolerance: f64) -> Vec<Range<usize>> {
    let longest_s = tolerance * median_period_s(time_s).unwrap_or(0.0);
    let mut bursts = Vec::new();
    let mut start = 0;
    for (k, pair) in time_s.windows(2).enumerate() {
        if pair[1] - pair[0] > longest_s {
            bursts.push(start..k + 1);
            start = k + 1;
        }
    }
    if start < time_s.len() {
        bursts.push(start..time_s.len());
    }
    bursts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splits_at_gaps_only() {
        assert_eq!(bursts(&[0.0, 1.0, 2.0, 4.0, 5.0, 6.0, 7.4], GAP_TOLERANCE), [0..3, 3..7]);
        assert_eq!(bursts(&[0.0, 1.0, 2.0, 4.0, 5.0, 6.0, 7.4], 2.0).len(), 1);
        assert_eq!(bursts(&[3.0], GAP_TOLERANCE).first(), Some(&(0..1)));
        assert!(bursts(&[], GAP_TOLERANCE).is_empty());
    }

    #[test]
    fn median_of_even_and_odd_counts() {
        assert_eq!(median_period_s(&[0.0, 1.0, 3.0]), Some(1.5));
        assert_eq!(median_period_s(&[0.0, 1.0, 3.0, 9.0]), Some(2.0));
        assert_eq!(median_period_s(&[0.0]), None);
    }
}
