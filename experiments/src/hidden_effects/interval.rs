//! Interval of a share.

/// 95 % interval of a share from `hits` of `trials` (wilson1927); 0..1 without trials.
///
/// ```text
/// (p + z²/2n ± z √(p(1−p)/n + z²/4n²)) / (1 + z²/n),   z = 1.96
/// ```
pub fn wilson95(hits: usize, trials: usize) -> [f64; 2] {
    if trials == 0 {
        return [0.0, 1.0];
    }
    const Z: f64 = 1.959_964;
    let n = trials as f64;
    let p = hits as f64 / n;
    let centre = p + Z * Z / (2.0 * n);
    let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + Z * Z / n;
    [((centre - half) / scale).max(0.0), ((centre + half) / scale).min(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// newcombe1998, table I: 81 of 263, and 0 of 20.
    #[test]
    fn published_values() {
        let close = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 5e-5 && (a[1] - b[1]).abs() < 5e-5;
        assert!(close(wilson95(81, 263), [0.2553, 0.3662]));
        assert!(close(wilson95(0, 20), [0.0, 0.1611]));
    }
}
