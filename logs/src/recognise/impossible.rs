//! Samples that no arm gives: one wrong number between good ones.

use super::{Fault, Remark};
use crate::{LogColumns, RobotLog};

/// What each joint of an arm never does.
#[derive(Clone, Debug, PartialEq)]
pub struct Reach {
    /// Torque (Nm).
    pub torque_nm: Vec<f64>,
    /// Speed (rad/s).
    pub speed_rad_s: Vec<f64>,
    /// Angle, least and most (rad).
    pub angle_rad: Vec<[f64; 2]>,
}

/// Step (rad) that an encoder may make beside the motion.
const STEP_RAD: f64 = 0.02;
/// Rows in a row, and share of all, that are left out: more of them are no accident.
const MOST_IN_A_ROW: usize = 3;
const MOST_SHARE: f64 = 1e-3;

/// One sample that cannot be.
struct Impossible {
    row: usize,
    joint: usize,
    column: String,
    value: f64,
    allowed: String,
}

/// The log without single rows that hold what no joint of the arm does, and a warning that names the first of them.
///
/// ```text
/// |tau| > τ_reach,   |dq| > ω_reach,   q outside of its range,   |q_k − q_l| > ω_reach (t_k − t_l) + 0.02 rad      l: the last row that can be
/// ```
///
/// One such number in a whole trial would be the largest wrench of it, and the friction that least squares finds. Where there are many, or
/// several in a row, nothing is left out and the remark refuses: the columns are something else than they say.
#[must_use]
pub fn without_impossible_rows(log: &RobotLog, reach: &Reach) -> (RobotLog, Option<Remark>) {
    let (mut found, mut in_a_row, mut longest): (Vec<Impossible>, usize, usize) = (Vec::new(), 0, 0);
    let mut good = 0;
    for row in 0..log.rows() {
        match impossible(log, reach, row, good) {
            Some(sample) => {
                found.push(sample);
                in_a_row += 1;
                longest = longest.max(in_a_row);
            }
            None => (good, in_a_row) = (row, 0),
        }
    }
    let Some(first) = found.first() else { return (log.clone(), None) };
    let evidence = format!(
        "{} of {} rows hold what no joint of this arm does, the first at time {:.3} s: {} is {:.4}; allowed: {}",
        found.len(),
        log.rows(),
        log.time_s[first.row],
        first.column,
        first.value,
        first.allowed
    );
    let joints = vec![first.joint];
    let few = longest <= MOST_IN_A_ROW && found.len() as f64 <= (MOST_SHARE * log.rows() as f64).max(1.0);
    let kept = few.then(|| log.without_rows(&found.iter().map(|sample| sample.row).collect::<Vec<_>>()).ok()).flatten();
    match kept {
        Some(kept) => {
            let remedy = "they are left out; look at what writes the log".to_owned();
            (kept, Some(Remark::warn(Fault::Impossible, joints, evidence, remedy)))
        }
        None => {
            let remedy = "look at the units of the columns and at what writes the log".to_owned();
            (log.clone(), Some(Remark::refuse(Fault::Impossible, joints, evidence, remedy)))
        }
    }
}

/// The first thing in a row that cannot be, given the last row that can.
fn impossible(log: &LogColumns, reach: &Reach, row: usize, good: usize) -> Option<Impossible> {
    let of = |column: String, joint: usize, value: f64, allowed: String| {
        Some(Impossible { row, joint, column, value, allowed })
    };
    for joint in 0..log.joints() {
        let (torque_nm, speed_rad_s) = (reach.torque_nm[joint], reach.speed_rad_s[joint]);
        let torques = [
            ("tau_J", Some(&log.tau_j_nm)),
            ("tau_J_d", log.tau_j_d_nm.as_ref()),
            ("tau_friction", log.tau_friction_nm.as_ref()),
            ("tau_link", log.tau_link_nm.as_ref()),
        ];
        for (name, columns) in torques {
            let value = columns.map_or(0.0, |columns| columns[joint][row]);
            if value.abs() > torque_nm {
                return of(format!("{name}_{joint}"), joint, value, format!("±{torque_nm:.0} Nm"));
            }
        }
        let value = log.dq_rad_s[joint][row];
        if value.abs() > speed_rad_s {
            return of(format!("dq_{joint}"), joint, value, format!("±{speed_rad_s:.1} rad/s"));
        }
        let (from, value) = (log.q_rad[joint][good], log.q_rad[joint][row]);
        let [least, most] = reach.angle_rad[joint];
        if !(least..=most).contains(&value) {
            return of(format!("q_{joint}"), joint, value, format!("{least:.2} to {most:.2} rad; is it in degrees?"));
        }
        let reached = speed_rad_s * (log.time_s[row] - log.time_s[good]) + STEP_RAD;
        if row > 0 && (value - from).abs() > reached {
            return of(format!("q_{joint}"), joint, value, format!("{reached:.3} rad about {from:.3} rad"));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: usize = 5000;

    fn swinging() -> LogColumns {
        let time_s: Vec<f64> = (0..ROWS).map(|k| 1e-3 * k as f64).collect();
        let of = |f: fn(f64) -> f64| vec![time_s.iter().map(|t| f(*t)).collect::<Vec<f64>>(); 2];
        LogColumns {
            q_rad: of(f64::sin),
            dq_rad_s: of(f64::cos),
            tau_j_nm: of(|t| 9.0 * t.cos()),
            time_s,
            ..LogColumns::default()
        }
    }

    fn reach() -> Reach {
        Reach { torque_nm: vec![30.0; 2], speed_rad_s: vec![20.0; 2], angle_rad: vec![[-2.0, 2.0]; 2] }
    }

    fn judged(spoil: impl Fn(&mut LogColumns)) -> (usize, Option<Remark>) {
        let mut columns = swinging();
        spoil(&mut columns);
        let (log, remark) = without_impossible_rows(&columns.validate().unwrap(), &reach());
        (ROWS - log.rows(), remark)
    }

    #[test]
    fn single_rows_are_left_out_and_named() {
        assert_eq!(judged(|_| {}), (0, None));
        let (left_out, remark) = judged(|log| log.tau_j_nm[1][700] = -1e9);
        let remark = remark.unwrap();
        assert!(left_out == 1 && remark.severity == super::super::Severity::Warn && remark.joints == [1], "{remark:?}");
        assert!(remark.evidence.contains("at time 0.700 s: tau_J_1 is -1000000000.0000; allowed: ±30 Nm"), "{remark}");
        let (left_out, remark) = judged(|log| log.q_rad[0][900] = 0.0);
        assert!(left_out == 1 && remark.unwrap().evidence.contains("q_0 is 0.0000"));
        let (left_out, _) = judged(|log| (1000..1003).for_each(|k| log.dq_rad_s[0][k] = 99.0));
        assert_eq!(left_out, 3);
    }

    #[test]
    fn what_is_no_accident_is_refused() {
        for spoil in [
            (|log: &mut LogColumns| log.tau_j_nm[0].iter_mut().for_each(|tau| *tau *= 1e3)) as fn(&mut LogColumns),
            |log| (1000..1004).for_each(|k| log.dq_rad_s[0][k] = 99.0),
            |log| log.q_rad[1][2000..].iter_mut().for_each(|q| *q += 0.9),
            |log| log.q_rad[1].iter_mut().for_each(|q| *q = 3.0),
        ] {
            let (left_out, remark) = judged(spoil);
            let remark = remark.unwrap();
            assert!(left_out == 0 && remark.severity == super::super::Severity::Refuse, "{remark:?}");
        }
    }
}
