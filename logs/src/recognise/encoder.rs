//! Encoders that stand still while the joint moves.

use super::remark::joints_named;
use super::{Fault, Remark};
use crate::LogColumns;
use crate::bursts::median_period_s;

/// Shortest standstill that counts (s), and in rows: rows are sent twice, and a hole of a few is bridged.
const SHORTEST_S: f64 = 0.1;
const SHORTEST_ROWS: usize = 10;
/// Jump at the end of a standstill (rad), and over the largest step between other rows.
const LEAST_JUMP_RAD: f64 = 2e-3;
const JUMP_OVER_STEP: f64 = 3.0;
/// Motion that the log's own `dq` claims meanwhile (rad).
const LEAST_CLAIMED_RAD: f64 = 0.02;

/// Refuses a log in which a position keeps one and the same value while `dq` goes on, or from which it then jumps.
pub(super) fn frozen(log: &LogColumns) -> Option<Remark> {
    let period_s = median_period_s(&log.time_s)?;
    let found: Vec<(usize, Stop)> =
        (0..log.joints()).filter_map(|joint| Some((joint, longest_stop(log, joint, period_s)?))).collect();
    let (_, worst) = found.iter().max_by(|a, b| a.1.duration_s.total_cmp(&b.1.duration_s))?;
    let joints: Vec<usize> = found.iter().map(|(joint, _)| *joint).collect();
    let evidence = format!(
        "the position of {} keeps one value for {:.3} s from time {:.3} s, while the joint moves by {:.3} rad",
        joints_named(&joints),
        worst.duration_s,
        worst.from_s,
        worst.moved_rad
    );
    let remedy = "look at the encoder or at what writes the log; a part without the standstill can be used".to_owned();
    Some(Remark::refuse(Fault::FrozenEncoder, joints, evidence, remedy))
}

/// A stretch of one value.
struct Stop {
    from_s: f64,
    duration_s: f64,
    /// By what the joint moved meanwhile, as `dq` or the jump says (rad).
    moved_rad: f64,
}

/// The longest standstill of a joint that is none.
fn longest_stop(log: &LogColumns, joint: usize, period_s: f64) -> Option<Stop> {
    let (t, q, dq) = (&log.time_s, &log.q_rad[joint], &log.dq_rad_s[joint]);
    let rows = q.len().min(t.len()).min(dq.len());
    // The 99 % quantile of the steps: how far the joint gets from row to row.
    let mut steps: Vec<f64> = q.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0).collect();
    let usual = match steps.len() {
        0 => 0.0,
        count => *steps.select_nth_unstable_by(count * 99 / 100, f64::total_cmp).1,
    };
    let mut longest: Option<Stop> = None;
    let mut start = 0;
    while start + 1 < rows {
        let mut end = start;
        let (mut sum, mut claimed): (f64, f64) = (0.0, 0.0);
        while end + 1 < rows && q[end + 1] == q[start] {
            sum += dq[end] * (t[end + 1] - t[end]);
            claimed = claimed.max(sum.abs());
            end += 1;
        }
        let duration_s = t[end] - t[start];
        if end - start >= SHORTEST_ROWS && duration_s >= SHORTEST_S {
            let hole = t.get(end + 1).is_none_or(|next| next - t[end] > 2.5 * period_s);
            let jump = if hole { 0.0 } else { q.get(end + 1).map_or(0.0, |next| (next - q[end]).abs()) };
            let jumps = start > 0 && usual > 0.0 && jump > LEAST_JUMP_RAD && jump > JUMP_OVER_STEP * usual;
            let goes_on = claimed > LEAST_CLAIMED_RAD;
            let longer = longest.as_ref().is_none_or(|stop| duration_s > stop.duration_s);
            if (jumps || goes_on) && longer {
                let moved_rad = if goes_on { claimed.max(jump) } else { jump };
                longest = Some(Stop { from_s: t[start], duration_s, moved_rad });
            }
        }
        start = end.max(start + 1);
    }
    longest
}
