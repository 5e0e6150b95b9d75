//! Whether the log of a trial can be what it says.

use nalgebra::SVector;
use tribo_diagnose::{Diagnosable, recognise::recognise};
use tribo_friction::FrictionModel;
use tribo_logs::recognise::{Fault, Reach, Remark, Use, joints_named, travel};
use tribo_logs::{LogColumns, RobotLog, row};
use tribo_regression::Nominal;
use tribo_robot::{Arm, gravity_torque};
use tribo_sim::TorqueSide;

use super::friction_work::turned_signs;
use super::{SentTorque, UserTrials};
use crate::ValidTune;

/// Least that every joint moves each way in the judged part (rad): beneath it the gears wind up and friction is not met.
const LEAST_TRAVEL_RAD: f64 = 5e-3;

/// What the arm of the campaign says about the log of a trial, of which `torque` acted; and, of one that did not fail, whether
/// the joints moved both ways, since friction that is not met costs nothing.
///
/// A joint that its friction holds may stand in a good trial, and costs; where more than half of the joints do, it is none.
pub fn trial_remarks<const N: usize>(
    tune: &ValidTune<N>,
    user_trials: &UserTrials,
    log: &RobotLog,
    failed: bool,
) -> Vec<Remark>
where
    Nominal<N>: Diagnosable,
{
    let arm = &tune.trial.model;
    let mut remarks = Vec::new();
    if log.joints() != N {
        return remarks;
    }
    let nominal = Nominal::new(arm.clone(), FrictionModel::none(), TorqueSide::Motor);
    let acted = acted(log, user_trials.torque, |q| gravity_torque(arm, q));
    remarks.extend(acted.as_ref().map(|log| recognise(log, &nominal)).unwrap_or_default());
    // A log that ends early is refused for that.
    if failed || log.duration_s() < user_trials.judged_from_s + 0.9 * user_trials.judged_s {
        return remarks;
    }
    let start_s = log.time_s[0] + user_trials.judged_from_s;
    let from = log.time_s.partition_point(|t| *t < start_s);
    // Where something else is wrong, the work is not that of friction.
    if !remarks.iter().any(|remark| remark.refuses(Use::Trial)) {
        remarks.extend(acted.and_then(|log| turned_signs(arm, &log, from)));
    }
    let stiff: Vec<usize> = (0..N)
        .filter(|&j| {
            let moved = travel(log.q_rad[j].get(from..).unwrap_or_default());
            moved.forward_rad.min(moved.backward_rad) < LEAST_TRAVEL_RAD
        })
        .collect();
    if !stiff.is_empty() {
        let [verb, whose] = if stiff.len() == 1 { ["moves", "its"] } else { ["move", "their"] };
        let evidence = format!(
            "{} {verb} less than {LEAST_TRAVEL_RAD} rad one way or the other after {} s: {whose} friction costs nothing",
            joints_named(&stiff),
            user_trials.judged_from_s
        );
        let remedy = "a trial is a motion of all joints, the same in every trial".to_owned();
        let make = if 2 * stiff.len() > N { Remark::refuse } else { Remark::warn };
        remarks.push(make(Fault::Standstill, stiff, evidence, remedy));
    }
    remarks
}

/// The log with the torque that acted in the place of the measured one; `None` where it lacks that.
fn acted<const N: usize>(
    log: &RobotLog,
    torque: SentTorque,
    gravity_nm: impl Fn(&SVector<f64, N>) -> SVector<f64, N>,
) -> Option<RobotLog> {
    let mut columns: LogColumns = log.clone().into_columns();
    match torque {
        SentTorque::Measured => {}
        SentTorque::Commanded => columns.tau_j_nm = columns.tau_j_d_nm.clone()?,
        SentTorque::CommandedWithoutGravity => {
            let mut tau = columns.tau_j_d_nm.clone()?;
            for k in 0..log.rows() {
                let gravity = gravity_nm(&row(&log.q_rad, k).into());
                tau.iter_mut().zip(gravity.iter()).for_each(|(column, gravity)| column[k] += gravity);
            }
            columns.tau_j_nm = tau;
        }
    }
    columns.tau_link_nm = None;
    columns.validate().ok()
}

/// Torque and speed that no joint of an arm reaches: far beyond its limits, of a joint that has some.
const BEYOND_LIMITS: f64 = 5.0;
/// Angle beyond the range of a joint that it does not reach (rad), whatever the zero of its encoder.
const BEYOND_RANGE_RAD: f64 = 2.0 * std::f64::consts::PI;
/// The same of joints that have none (Nm, rad/s).
const UNLIMITED: [f64; 2] = [1e4, 50.0];

/// What no joint of this arm does, for the first `joints` of them.
pub fn reach<const N: usize>(arm: &Arm<N>, joints: usize) -> Reach {
    let of = |limits: &SVector<f64, N>, unlimited: f64| {
        let usable = |limit: f64| limit.is_finite() && limit > 0.0;
        (0..joints)
            .map(|j| limits.get(j).filter(|limit| usable(**limit)).map_or(unlimited, |limit| BEYOND_LIMITS * limit))
            .collect()
    };
    let [torque_nm, speed_rad_s] = UNLIMITED;
    let angle = |j: usize| {
        let (least, most) = (arm.limits.q_min_rad.get(j)?, arm.limits.q_max_rad.get(j)?);
        (least.is_finite() && most.is_finite() && least < most)
            .then_some([least - BEYOND_RANGE_RAD, most + BEYOND_RANGE_RAD])
    };
    Reach {
        torque_nm: of(&arm.limits.tau_max_nm, torque_nm),
        speed_rad_s: of(&arm.limits.qd_max_rad_s, speed_rad_s),
        angle_rad: (0..joints).map(|j| angle(j).unwrap_or([f64::NEG_INFINITY, f64::INFINITY])).collect(),
    }
}
