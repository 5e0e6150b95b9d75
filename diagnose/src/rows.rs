//! The rows of a log that a residual is made of: none twice, and no more in a second than its band needs.

use std::borrow::Cow;

use tribo_logs::{GAP_TOLERANCE, LogColumns, RobotLog, bursts};

/// Rows in a second below which none are averaged (Hz): between two of them an arm hardly reverses.
const LEAST_HZ: f64 = 500.0;
/// Least rate over the band, eight rows per period of the position smoother: the difference of 8th order then errs by 1e-5.
const LEAST_RATE_OVER_BAND: f64 = 24.0;
/// Jitter of the stamps in a rate [-].
const JITTER: f64 = 0.01;

/// How many rows of a log at `rate_hz` may be averaged into one, for a band of `band_hz`.
pub(crate) fn rows_per_average(rate_hz: f64, band_hz: f64) -> usize {
    let most = rate_hz / LEAST_HZ.max(LEAST_RATE_OVER_BAND * band_hz);
    if most.is_finite() { (most * (1.0 + JITTER)).floor().max(1.0) as usize } else { 1 }
}

/// The log with every `rows` rows averaged into one, of the columns that a residual is made of; none across a gap, and none of a log
/// with rows that were sent twice, whose rate is not that of its stamps.
///
/// Stamps, positions and torques are averaged alike: where the dynamics are linear both sides of the residual keep seeing the same filter.
///
/// With it, how many rows that makes.
pub(crate) fn averaged(log: &RobotLog, rows: usize) -> (Cow<'_, RobotLog>, usize) {
    if rows < 2 || without_repeats(log).1 {
        return (Cow::Borrowed(log), 1);
    }
    let stretches = bursts(&log.time_s, GAP_TOLERANCE);
    let average = |column: &Vec<f64>| -> Vec<f64> {
        let parts = stretches.iter().flat_map(|stretch| column[stretch.clone()].chunks_exact(rows));
        parts.map(|part| part.iter().sum::<f64>() / rows as f64).collect()
    };
    reduced(log, average).map_or((Cow::Borrowed(log), 1), |log| (Cow::Owned(log), rows))
}

/// The log without rows that say the same as the row before (positions and torques of all joints alike), and whether
/// there were any: such a row was sent twice under a new stamp, and its velocity is a lie.
pub(crate) fn without_repeats(log: &RobotLog) -> (Cow<'_, RobotLog>, bool) {
    let same = |k: usize| log.q_rad.iter().chain(&log.tau_j_nm).all(|column| column[k] == column[k - 1]);
    let kept: Vec<usize> = (0..log.rows()).filter(|k| *k == 0 || !same(*k)).collect();
    if kept.len() == log.rows() || kept.len() < log.rows() / 2 {
        return (Cow::Borrowed(log), false);
    }
    let fresh = reduced(log, |column| kept.iter().map(|k| column[*k]).collect());
    fresh.map_or((Cow::Borrowed(log), false), |fresh| (Cow::Owned(fresh), true))
}

/// The columns that a residual is made of, each made shorter.
fn reduced(log: &RobotLog, shorter: impl Fn(&Vec<f64>) -> Vec<f64>) -> Option<RobotLog> {
    let all = |columns: &Vec<Vec<f64>>| columns.iter().map(&shorter).collect::<Vec<_>>();
    let columns = LogColumns {
        time_s: shorter(&log.time_s),
        q_rad: all(&log.q_rad),
        dq_rad_s: all(&log.dq_rad_s),
        tau_j_nm: all(&log.tau_j_nm),
        theta_rad: log.theta_rad.as_ref().map(all),
        tau_link_nm: log.tau_link_nm.as_ref().map(all),
        ..LogColumns::default()
    };
    columns.validate().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fast_logs_keep_what_the_band_needs() {
        let cases = [(1000.0, 10.0, 2), (999.0, 10.0, 2), (1000.0, 20.0, 2), (1000.0, 25.0, 1), (4000.0, 60.0, 2)];
        for (rate_hz, band_hz, expected) in cases {
            assert_eq!(rows_per_average(rate_hz, band_hz), expected, "{rate_hz} Hz, band {band_hz} Hz");
        }
        assert_eq!([rows_per_average(125.0, 10.0), rows_per_average(f64::INFINITY, 10.0)], [1, 1]);
    }

    #[test]
    fn rows_are_averaged_but_not_across_a_gap() {
        let time_s = vec![0.0, 0.001, 0.002, 0.003, 0.004, 1.0, 1.001, 1.002];
        let column: Vec<f64> = (0..8).map(f64::from).collect();
        let log = LogColumns {
            q_rad: vec![column.clone()],
            dq_rad_s: vec![column.clone()],
            tau_j_nm: vec![column],
            time_s,
            ..LogColumns::default()
        };
        let log = log.validate().unwrap();
        let (halved, rows) = averaged(&log, 2);
        assert_eq!((&halved.q_rad[0][..], rows), (&[0.5, 2.5, 5.5][..], 2));
        assert_eq!(halved.time_s, [0.0005, 0.0025, 1.0005]);
        assert!(matches!(averaged(&log, 1), (Cow::Borrowed(_), 1)));
        // Its second row sent twice.
        let mut columns = log.into_columns();
        columns.q_rad[0][2] = 1.0;
        columns.tau_j_nm[0][2] = 1.0;
        assert!(matches!(averaged(&columns.validate().unwrap(), 2), (Cow::Borrowed(_), 1)));
    }
}
