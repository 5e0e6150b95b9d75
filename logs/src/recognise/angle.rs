//! Positions in degrees.

use super::remark::joints_named;
use super::{Fault, Remark};
use crate::LogColumns;

/// Angle (rad) that joints of arms do not leave: two turns; continuous joints that go on turning do, one at a time.
const FARTHEST_RAD: f64 = 4.0 * std::f64::consts::PI;
/// Speed (rad/s) that no joint of an arm reaches for long.
const FASTEST_RAD_S: f64 = 10.0;
/// Share of the rows faster than that.
const FAST_SHARE: f64 = 0.05;
/// Rows that are looked at.
const MOST_ROWS: usize = 5000;

/// Positions too far out for radians: refused where several joints are, or one is also too fast.
pub(super) fn degrees(log: &LogColumns) -> Option<Remark> {
    let farthest = |column: &[f64]| column.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
    let far: Vec<(usize, f64)> =
        log.q_rad.iter().map(|column| farthest(column)).enumerate().filter(|(_, q)| *q > FARTHEST_RAD).collect();
    let (_, worst) = *far.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let joints: Vec<usize> = far.iter().map(|(joint, _)| *joint).collect();
    let fast = joints.iter().any(|&joint| too_fast(&log.time_s, &log.q_rad[joint]));
    let evidence = format!(
        "the position of {} reaches {worst:.4}: as radians that is {:.1} turns, as degrees {:.2} of one",
        joints_named(&joints),
        worst / std::f64::consts::TAU,
        worst / 360.0
    );
    Some(if far.len() > 1 || fast {
        let remedy = "multiply the columns q_i and dq_i that are in degrees by pi/180, or say so: --map 'q=COLUMNS[deg],dq=COLUMNS[deg/s]'"
            .to_owned();
        Remark::refuse(Fault::Degrees, joints, evidence, remedy)
    } else {
        let remedy = "nothing to do if the joint turns without end; else multiply q_i and dq_i by pi/180".to_owned();
        Remark::warn(Fault::Degrees, joints, evidence, remedy)
    })
}

/// Whether a position changes faster than any arm does, for a good part of the log.
fn too_fast(time_s: &[f64], q: &[f64]) -> bool {
    let step = q.len().div_ceil(MOST_ROWS).max(1);
    let rows: Vec<usize> = (0..q.len().min(time_s.len())).step_by(step).collect();
    let fast = rows.windows(2).filter(|w| ((q[w[1]] - q[w[0]]) / (time_s[w[1]] - time_s[w[0]])).abs() > FASTEST_RAD_S);
    fast.count() as f64 > FAST_SHARE * rows.len() as f64
}
