//! Rows that were sent twice.

use std::borrow::Cow;

use tribo_logs::{LogColumns, RobotLog};

/// The log without rows that say the same as the row before (positions and torques of all joints alike), and whether
/// there were any: such a row was sent twice under a new stamp, and its velocity is a lie.
pub fn without_repeats(log: &RobotLog) -> (Cow<'_, RobotLog>, bool) {
    let same = |k: usize| log.q_rad.iter().chain(&log.tau_j_nm).all(|column| column[k] == column[k - 1]);
    let kept: Vec<usize> = (0..log.rows()).filter(|k| *k == 0 || !same(*k)).collect();
    if kept.len() == log.rows() || kept.len() < log.rows() / 2 {
        return (Cow::Borrowed(log), false);
    }
    let pick = |column: &Vec<f64>| kept.iter().map(|k| column[*k]).collect::<Vec<f64>>();
    let all = |columns: &Vec<Vec<f64>>| columns.iter().map(pick).collect::<Vec<_>>();
    let fresh = LogColumns {
        time_s: pick(&log.time_s),
        q_rad: all(&log.q_rad),
        dq_rad_s: all(&log.dq_rad_s),
        tau_j_nm: all(&log.tau_j_nm),
        theta_rad: log.theta_rad.as_ref().map(all),
        tau_link_nm: log.tau_link_nm.as_ref().map(all),
        ..LogColumns::default()
    };
    fresh.validate().map_or((Cow::Borrowed(log), false), |fresh| (Cow::Owned(fresh), true))
}
