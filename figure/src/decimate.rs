//! Fewer points that look the same.

/// Most points drawn of one series.
pub const MOST_POINTS: usize = 2000;

/// Indices of at most [`MOST_POINTS`] of `y`, ascending.
///
/// Of a curve every bucket keeps its first, lowest, highest and last point, so that no peak is lost; of a cloud every
/// k-th point stays.
pub fn decimated(y: &[f64], joined: bool) -> Vec<usize> {
    if y.len() <= MOST_POINTS {
        return (0..y.len()).collect();
    }
    if !joined {
        return (0..MOST_POINTS).map(|k| k * y.len() / MOST_POINTS).collect();
    }
    let buckets = MOST_POINTS / 4;
    let mut kept = Vec::with_capacity(MOST_POINTS);
    for bucket in 0..buckets {
        let (first, last) = (bucket * y.len() / buckets, (bucket + 1) * y.len() / buckets - 1);
        let by_value = |a: &usize, b: &usize| y[*a].total_cmp(&y[*b]);
        let lowest = (first..=last).min_by(by_value).unwrap_or(first);
        let highest = (first..=last).max_by(by_value).unwrap_or(last);
        let mut four = [first, lowest, highest, last];
        four.sort_unstable();
        kept.extend(four);
    }
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_survive_and_order_stays() {
        let mut y: Vec<f64> = (0..30_000).map(|k| (f64::from(k) * 1e-3).sin()).collect();
        y[12_345] = 9.0;
        y[23_456] = -9.0;
        let kept = decimated(&y, true);
        assert!(kept.len() <= MOST_POINTS && kept.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(kept.contains(&12_345) && kept.contains(&23_456));
        let cloud = decimated(&y, false);
        assert!(cloud.len() == MOST_POINTS && cloud.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(decimated(&[1.0, 2.0], true), [0, 1]);
        assert!(decimated(&[], false).is_empty());
    }
}
