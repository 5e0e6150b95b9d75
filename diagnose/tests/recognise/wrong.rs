//! Good logs, each mutilated in one way.

use tribo_diagnose::Diagnosable;
use tribo_logs::recognise::{Fault, Severity};
use tribo_logs::{LogColumns, RobotLog};
use tribo_regression::Nominal;
use tribo_robot::presets;
use tribo_sim::TorqueSide;

use super::good::{Good, lively};
use super::remarks;

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// One way to spoil a log at a joint, and what has to be said.
struct Way {
    name: &'static str,
    spoil: fn(&mut LogColumns, usize),
    expected: &'static [Fault],
    severity: Severity,
}

fn scale(columns: &mut [Vec<f64>], factor: f64) {
    columns.iter_mut().flatten().for_each(|x| *x *= factor);
}

fn one(columns: &mut [Vec<f64>], joint: usize, factor: f64) {
    scale(&mut columns[joint..=joint], factor);
}

/// Adds white noise, uniform within so much either way.
fn jitter(column: &mut [f64], within: f64) {
    // A hash of the row: any generator that is white over five rows will do.
    let uniform = |k: usize| (((k as f64 * 12.9898).sin() * 43758.5453).fract() * 2.0).rem_euclid(2.0) - 1.0;
    column.iter_mut().enumerate().for_each(|(k, x)| *x += within * uniform(k));
}

/// Rows of so many seconds.
fn rows(log: &LogColumns, time_s: f64) -> usize {
    log.time_s.partition_point(|t| *t < log.time_s[0] + time_s)
}

/// Moves the columns of joints 1, 3 and 5 each to the next of them.
fn moved_on(columns: &mut [Vec<f64>]) {
    columns.swap(1, 3);
    columns.swap(1, 5);
}

const fn refused(name: &'static str, spoil: fn(&mut LogColumns, usize), expected: &'static [Fault]) -> Way {
    Way { name, spoil, expected, severity: Severity::Refuse }
}

const WAYS: [Way; 34] = [
    refused(
        "degrees, all",
        |l, _| {
            scale(&mut l.q_rad, DEGREES);
            scale(&mut l.dq_rad_s, DEGREES);
        },
        &[Fault::Degrees],
    ),
    refused("degrees, positions alone", |l, _| scale(&mut l.q_rad, DEGREES), &[Fault::Degrees]),
    refused("degrees, speeds alone", |l, _| scale(&mut l.dq_rad_s, DEGREES), &[Fault::VelocityScale]),
    refused("milliseconds", |l, _| l.time_s.iter_mut().for_each(|t| *t *= 1e3), &[Fault::Clock]),
    refused("nanoseconds", |l, _| l.time_s.iter_mut().for_each(|t| *t *= 1e9), &[Fault::Clock]),
    refused("microseconds", |l, _| l.time_s.iter_mut().for_each(|t| *t *= 1e6), &[Fault::Clock]),
    refused("mNm", |l, _| scale(&mut l.tau_j_nm, 1e3), &[Fault::TorqueUnit]),
    refused("kNm", |l, _| scale(&mut l.tau_j_nm, 1e-3), &[Fault::TorqueUnit]),
    refused("torque gain of 4", |l, _| scale(&mut l.tau_j_nm, 4.0), &[Fault::TorqueUnit]),
    refused("torque gain of 4 at one joint", |l, j| one(&mut l.tau_j_nm, j, 4.0), &[Fault::TorqueUnit]),
    refused("all torques turned", |l, _| scale(&mut l.tau_j_nm, -1.0), &[Fault::TorqueSign]),
    refused("torque turned", |l, j| one(&mut l.tau_j_nm, j, -1.0), &[Fault::TorqueSign]),
    refused(
        "torque of the first joint turned",
        |l, _| one(&mut l.tau_j_nm, 0, -1.0),
        &[Fault::TorqueSign, Fault::TorqueOrPositionSign],
    ),
    refused(
        "position turned",
        |l, j| {
            one(&mut l.q_rad, j, -1.0);
            one(&mut l.dq_rad_s, j, -1.0);
        },
        &[Fault::PositionSign],
    ),
    refused(
        "axis turned",
        |l, j| {
            one(&mut l.q_rad, j, -1.0);
            one(&mut l.dq_rad_s, j, -1.0);
            one(&mut l.tau_j_nm, j, -1.0);
        },
        &[Fault::AxisSign],
    ),
    refused("torques swapped", |l, j| l.tau_j_nm.swap(j, j + 1), &[Fault::JointOrder]),
    refused(
        "positions swapped",
        |l, j| {
            l.q_rad.swap(j, j + 1);
            l.dq_rad_s.swap(j, j + 1);
        },
        &[Fault::JointOrder],
    ),
    refused(
        "joints swapped",
        |l, j| {
            l.q_rad.swap(j, j + 1);
            l.dq_rad_s.swap(j, j + 1);
            l.tau_j_nm.swap(j, j + 1);
        },
        &[Fault::JointOrder],
    ),
    refused("torques of three joints moved on", |l, _| moved_on(&mut l.tau_j_nm), &[Fault::JointOrder]),
    refused(
        "positions of three joints moved on",
        |l, _| {
            moved_on(&mut l.q_rad);
            moved_on(&mut l.dq_rad_s);
        },
        &[Fault::JointOrder],
    ),
    refused(
        "three joints moved on",
        |l, _| {
            moved_on(&mut l.q_rad);
            moved_on(&mut l.dq_rad_s);
            moved_on(&mut l.tau_j_nm);
        },
        &[Fault::JointOrder],
    ),
    refused(
        "torques of one value",
        |l, _| l.tau_j_nm.iter_mut().for_each(|tau| tau.fill(1.5)),
        &[Fault::TorqueUnexplained],
    ),
    refused(
        "torques of another motion",
        |l, _| {
            // Each joint's own values in an order that the motion does not have: a permutation by a stride prime to the length.
            let rows = l.time_s.len();
            let stride = (rows / 7..).find(|stride| (2..=*stride).all(|d| rows % d != 0 || stride % d != 0)).unwrap();
            for tau in &mut l.tau_j_nm {
                *tau = (0..rows).map(|k| tau[k * stride % rows]).collect();
            }
        },
        &[Fault::TorqueUnexplained],
    ),
    refused(
        "joints in the opposite order",
        |l, _| {
            l.q_rad.reverse();
            l.dq_rad_s.reverse();
            l.tau_j_nm.reverse();
        },
        &[Fault::JointOrder],
    ),
    refused(
        "encoder frozen throughout",
        |l, j| {
            let value = l.q_rad[j][0];
            l.q_rad[j].fill(value);
        },
        &[Fault::FrozenEncoder],
    ),
    refused(
        "encoder frozen for two seconds",
        |l, j| {
            let (from, to) = (rows(l, 3.0), rows(l, 5.0));
            let value = l.q_rad[j][from];
            l.q_rad[j][from..to].fill(value);
        },
        &[Fault::FrozenEncoder],
    ),
    refused("speeds turned", |l, _| scale(&mut l.dq_rad_s, -1.0), &[Fault::VelocitySign]),
    refused("speeds of zero", |l, _| scale(&mut l.dq_rad_s, 0.0), &[Fault::VelocityOther]),
    refused("speed of a joint doubled", |l, j| one(&mut l.dq_rad_s, j, 2.0), &[Fault::VelocityScale]),
    Way {
        name: "speeds 5 % too large",
        spoil: |l, _| scale(&mut l.dq_rad_s, 1.05),
        expected: &[Fault::VelocityScale],
        severity: Severity::Warn,
    },
    Way {
        name: "stamps 5 % too fast",
        spoil: |l, _| l.time_s.iter_mut().for_each(|t| *t *= 0.95),
        expected: &[Fault::VelocityScale],
        severity: Severity::Warn,
    },
    Way {
        name: "speeds 60 ms late",
        spoil: |l, _| {
            let late = rows(l, 0.06);
            l.dq_rad_s.iter_mut().for_each(|dq| dq.rotate_right(late));
        },
        expected: &[Fault::VelocityDelay],
        severity: Severity::Warn,
    },
    refused("a position that jitters", |l, j| jitter(&mut l.q_rad[j], 0.2), &[Fault::Noise]),
    Way {
        name: "a torque of noise",
        spoil: |l, j| jitter(&mut l.tau_j_nm[j], 200.0),
        expected: &[Fault::Noise],
        severity: Severity::Warn,
    },
];

fn spoiled(log: &RobotLog, way: &Way, joint: usize) -> RobotLog {
    let mut columns = log.clone().into_columns();
    (way.spoil)(&mut columns, joint);
    columns.validate().unwrap()
}

/// What is wrong with the judgement of one mutilation; nothing if it is right.
fn judged<const N: usize>(good: &Good<N>, way: &Way, joint: usize) -> Option<String>
where
    Nominal<N>: Diagnosable,
{
    let found = remarks(&spoiled(&good.log, way, joint), &good.nominal);
    let right =
        found.first().is_some_and(|first| way.expected.contains(&first.fault) && first.severity == way.severity)
            && found
                .iter()
                .any(|remark| remark.joints.is_empty() || remark.joints.contains(&joint) || way.name.contains("first"));
    let said: Vec<String> = found.iter().map(ToString::to_string).collect();
    (!right).then(|| format!("{} of joint {joint} ({}): {said:?}", way.name, good.description))
}

/// 34 ways on all arms, motions and truths drawn from seeds.
#[test]
fn every_mutilation_is_recognised() {
    let mut wrong = Vec::new();
    let mut tried = 0;
    for (k, way) in WAYS.iter().enumerate() {
        for (turn, name) in
            ["panda", "fr3", "kinova_gen3", "iiwa14", "ur10e"].into_iter().enumerate().skip(k % 2).step_by(2)
        {
            let seed = 1000 + 10 * k as u64 + turn as u64;
            // Joints that carry the arm.
            tried += 1;
            wrong.extend(match name {
                "ur10e" => judged(&lively::<6>(name, seed), way, 1 + k % 2),
                _ => judged(&lively::<7>(name, seed), way, 1 + 2 * (k % 2)),
            });
        }
    }
    assert!(wrong.is_empty(), "{} of {tried}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(tried >= 40, "{tried}");
}

/// The weight of the arm left out of the torques, as robots that compensate it themselves log them.
#[test]
fn torques_without_gravity_are_recognised() {
    for (seed, name) in [(1, "panda"), (2, "iiwa14"), (3, "kinova_gen3")] {
        let good = lively::<7>(name, seed);
        let mut columns = good.log.clone().into_columns();
        for k in 0..columns.rows() {
            let q = tribo_logs::row::<7>(&columns.q_rad, k).into();
            let gravity = tribo_robot::gravity_torque(&good.nominal.arm, &q);
            columns.tau_j_nm.iter_mut().zip(gravity.iter()).for_each(|(tau, g)| tau[k] -= g);
        }
        let found = remarks(&columns.validate().unwrap(), &good.nominal);
        assert_eq!(
            found.first().map(|remark| remark.fault),
            Some(Fault::GravityMissing),
            "{}: {found:?}",
            good.description
        );
    }
}

/// A base on a wall: the torques are those of an arm whose gravity points along its x axis.
#[test]
fn gravity_of_a_base_on_a_wall_is_recognised() {
    for (seed, name) in [(1, "panda"), (2, "iiwa14"), (3, "kinova_gen3")] {
        let good = lively::<7>(name, seed);
        let mut turned = good.nominal.arm.clone();
        turned.gravity_m_s2 = nalgebra::Vector3::new(9.81, 0.0, 0.0);
        let mut columns = good.log.clone().into_columns();
        for k in 0..columns.rows() {
            let q = tribo_logs::row::<7>(&columns.q_rad, k).into();
            let change = tribo_robot::gravity_torque(&turned, &q) - tribo_robot::gravity_torque(&good.nominal.arm, &q);
            columns.tau_j_nm.iter_mut().zip(change.iter()).for_each(|(tau, change)| tau[k] += change);
        }
        let found = remarks(&columns.validate().unwrap(), &good.nominal);
        assert_eq!(found.first().map(|remark| remark.fault), Some(Fault::GravityDirection), "{name}: {found:?}");
        assert!(found[0].evidence.contains("gravity along (9.8, "), "{found:?}");
        assert!(found[0].remedy.contains("gravity_m_s2"), "{found:?}");
    }
}

/// The log of one arm held against the model of another, and of one side of the gears against the other.
#[test]
fn other_arms_and_the_other_side_of_the_gears_are_recognised() {
    for (seed, name, other) in
        [(1, "panda", "iiwa14"), (2, "iiwa14", "kinova_gen3"), (3, "kinova_gen3", "panda"), (4, "fr3", "iiwa14")]
    {
        let good = lively::<7>(name, seed);
        let mut nominal = lively::<7>(other, seed).nominal;
        if good.nominal.torque_side == TorqueSide::Link {
            nominal.arm = nominal.arm.link_side();
        }
        let found = remarks(&good.log, &nominal);
        assert_eq!(found.first().map(|remark| remark.fault), Some(Fault::OtherRobot), "{name} as {other}: {found:?}");
        assert!(found[0].remedy.contains(name), "{found:?}");
    }
    for (seed, name) in [(1, "panda"), (2, "panda"), (3, "fr3"), (4, "iiwa14")] {
        let mut good = lively::<7>(name, seed);
        let preset = presets::find(name).unwrap();
        let with_rotors = preset.with_joints::<7>().unwrap().arm.clone();
        (good.nominal.torque_side, good.nominal.arm) = match good.nominal.torque_side {
            TorqueSide::Motor => (TorqueSide::Link, with_rotors.link_side()),
            TorqueSide::Link => (TorqueSide::Motor, with_rotors),
        };
        let found = remarks(&good.log, &good.nominal);
        assert_eq!(
            found.first().map(|remark| remark.fault),
            Some(Fault::TorqueSide),
            "{}: {found:?}",
            good.description
        );
        assert_eq!(found[0].severity, Severity::Warn);
    }
}

/// An arm that stands is said to stand; whoever wants a wrench may have it.
#[test]
fn a_standing_arm_is_recognised() {
    let good = lively::<7>("panda", 1);
    let mut columns = good.log.clone().into_columns();
    for (q, dq) in columns.q_rad.iter_mut().zip(&mut columns.dq_rad_s) {
        let value = q[0];
        q.iter_mut().enumerate().for_each(|(k, q)| *q = value + 1e-5 * (k as f64 * 0.7).sin());
        dq.fill(0.0);
    }
    let found = tribo_logs::recognise::recognise(&columns);
    assert_eq!(found.iter().map(|remark| remark.fault).collect::<Vec<_>>(), [Fault::Standstill], "{found:?}");
}
