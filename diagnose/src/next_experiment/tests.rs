//! A log, its finding, its rival: which motion is proposed, and what it promises.

use nalgebra::SVector;
use tribo_logs::RobotLog;
use tribo_regression::Nominal;
use tribo_robot::{presets, rnea};
use tribo_sim::excitation::{Envelope, Excitation, JointTrajectory, Path};
use tribo_sim::{Recorder, Recording, Session, Truth, record};

use super::*;
use crate::diagnosis::Alternative;

const SMOOTHING_RAD_S: f64 = 0.01;

fn truth(effects: &[Effect]) -> Truth<7> {
    Truth { effects: effects.to_vec(), ..Truth::panda_coulomb_viscous() }
}

fn nominal() -> Nominal<7> {
    let Truth { arm, friction, .. } = truth(&[]);
    let torque_side = Recording::default().torque_side;
    Nominal { smoothing_rad_s: SMOOTHING_RAD_S, ..Nominal::new(arm, friction, torque_side) }
}

fn log(motion: &dyn JointTrajectory<7>, effects: &[Effect]) -> RobotLog {
    record(&truth(effects), SMOOTHING_RAD_S, motion, &Recording::default(), 1).unwrap()
}

fn data(log: RobotLog) -> RegressionData<7> {
    RegressionData::of_logs(&[log], &nominal(), None).unwrap()
}

/// From the ready pose to one side, rest to rest, once.
fn one_way() -> ViaPoints<7> {
    let start = presets::panda_ready_pose();
    ViaPoints { time_s: vec![0.0, 12.0], q_rad: vec![start, start + SVector::repeat(0.6)], resting: true }
}

fn drawn(kind: Excitation, seconds: f64) -> Box<dyn JointTrajectory<7>> {
    let arm = presets::panda();
    kind.draw(&Envelope::around(&arm, presets::panda_ready_pose()), seconds, 5)
}

fn finding(effect: &Effect, location: Location, rivals: &[(CauseLabel, Location)]) -> Finding {
    let rival = |(label, location): &(CauseLabel, Location)| Alternative {
        label: *label,
        location: *location,
        evidence_gap: 1.0,
        why: String::new(),
    };
    Finding {
        label: CauseLabel::of(effect),
        location,
        joints: location.places().0,
        links: location.places().1,
        effect: Some(effect.clone()),
        parameters: Vec::new(),
        signature: None,
        p_value: 1e-3,
        held_out_gain: 0.3,
        held_out_gain_ci95: [0.2, 0.4],
        explained_rms_nm: 0.1,
        evidence: 100.0,
        alternatives: rivals.iter().map(rival).collect(),
        plots: Vec::new(),
    }
}

/// The proposal for a log of the motion with the effect, against one rival; limits are checked on the way.
fn proposed(
    motion: &dyn JointTrajectory<7>,
    effect: &Effect,
    at: Location,
    rival: (CauseLabel, Location),
) -> NextExperiment {
    let data = data(log(motion, std::slice::from_ref(effect)));
    let next = next_experiment(&data, &[finding(effect, at, &[rival])], &[]).unwrap();
    assert_eq!(next.separates, [(CauseLabel::of(effect), at), rival]);
    assert!(next.instruction.ends_with('.') && next.expected_evidence.is_finite());
    stays_safe(&next);
    next
}

/// Joint limits at every point, speed and torque limits on the way, times increase, home at the end.
fn stays_safe(next: &NextExperiment) {
    let arm = presets::panda();
    let limits = &arm.limits;
    if !next.via_points.is_empty() {
        let path = path(next);
        for k in 0..(50.0 * path.duration_s()) as usize {
            let state = path.at(0.02 * k as f64);
            let tau = rnea(&arm, &state.q, &state.qd, &state.qdd);
            assert!((tau.abs() - limits.tau_max_nm).max() < 0.0, "{}: {tau:?}", next.motion);
        }
    }
    for (_, q) in &next.via_points {
        for j in 0..7 {
            assert!(q[j] > limits.q_min_rad[j] && q[j] < limits.q_max_rad[j], "{}: joint {j}", next.motion);
        }
    }
    for pair in next.via_points.windows(2) {
        let dt_s = pair[1].0 - pair[0].0;
        assert!(dt_s > 0.05);
        for j in 0..7 {
            let peak = 1.875 * (pair[1].1[j] - pair[0].1[j]).abs() / dt_s;
            assert!(peak <= 0.6 * limits.qd_max_rad_s[j], "{}: joint {j} at {peak} rad/s", next.motion);
        }
    }
    assert_eq!(next.via_points.first().map(|point| &point.1), next.via_points.last().map(|point| &point.1));
}

/// What a trajectory file makes of the via points.
fn path(next: &NextExperiment) -> Path<7> {
    let time_s = next.via_points.iter().map(|(time_s, _)| *time_s).collect();
    let q_rad = next.via_points.iter().map(|(_, q)| SVector::from_column_slice(q)).collect();
    ViaPoints { time_s, q_rad, resting: true }.path()
}

/// How often the joint turns around, and how often it rests.
fn turns_and_holds(next: &NextExperiment, joint: usize) -> (usize, usize) {
    let steps: Vec<f64> = next.via_points.windows(2).map(|pair| pair[1].1[joint] - pair[0].1[joint]).collect();
    let turns = steps.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    (turns, steps.iter().filter(|step| **step == 0.0).count())
}

#[test]
fn one_way_motion_asks_for_both_ways() {
    let joint = Location::Joint(2);
    let effect = Effect::Coulomb { joint: 2, delta_coulomb_nm: 0.2 };
    let next = proposed(&one_way().path(), &effect, joint, (CauseLabel::TorqueOffset, joint));
    assert!(turns_and_holds(&next, 2).0 >= 5, "{next:?}");
    assert!(next.expected_evidence > 100.0 && next.expected_evidence > 20.0 * next.evidence_of_this_log, "{next:?}");
    assert!(next.instruction.contains("panda_joint3 (2)"));
    for (_, q) in &next.via_points {
        assert_eq!(q[3], next.via_points[0].1[3], "the other joints rest");
    }
}

#[test]
fn a_clean_one_way_log_asks_for_both_ways_too() {
    let data = data(log(&one_way().path(), &[]));
    let next = next_experiment(&data, &[], &[]).unwrap();
    assert_eq!(next.separates.map(|(label, _)| label), [CauseLabel::Coulomb, CauseLabel::TorqueOffset]);
    assert!(next.expected_evidence > 10.0 && turns_and_holds(&next, 0).0 > 5, "{next:?}");
}

#[test]
fn nothing_is_proposed_where_nothing_is_doubtful() {
    let effect = Effect::TorqueOffset { joint: 1, offset_nm: 0.3 };
    let data = data(log(drawn(Excitation::Cruise, 20.0).as_ref(), std::slice::from_ref(&effect)));
    assert_eq!(next_experiment(&data, &[finding(&effect, Location::Joint(1), &[])], &[]), None);
}

#[test]
fn what_physics_confuses_needs_no_motion() {
    let effect = Effect::Payload { mass_kg: 0.8, com_m: [0.0, 0.0, 0.05], inertia_kg_m2: [0.0; 6] };
    let motion = drawn(Excitation::Multisine, 15.0);
    let next = proposed(motion.as_ref(), &effect, Location::Arm, (CauseLabel::LinkInertial, Location::Link(6)));
    assert_eq!((next.motion, next.expected_evidence), ("no_motion", 0.0));
    assert!(next.via_points.is_empty() && next.instruction.contains("no motion can"));
}

#[test]
fn an_offset_and_an_asymmetry_differ_in_holds() {
    let joint = Location::Joint(4);
    let effect = Effect::TorqueOffset { joint: 4, offset_nm: 0.15 };
    let next = proposed(&one_way().path(), &effect, joint, (CauseLabel::CoulombAsymmetry, joint));
    assert!(turns_and_holds(&next, 4).1 >= 4, "{next:?}");
    assert!(next.expected_evidence > 10.0, "{next:?}");
}

#[test]
fn thermal_rivals_ask_for_a_warm_up() {
    let joint = Location::Joint(1);
    let effect = Effect::ThermalFriction { joint: 1, drop_fraction: 0.25, time_constant_s: 900.0 };
    let motion = drawn(Excitation::Cruise, 20.0);
    let truth = truth(std::slice::from_ref(&effect));
    let recording = Recording::default();
    let recorder = Recorder { truth: &truth, smoothing_rad_s: SMOOTHING_RAD_S, recording, extra: None };
    // Two cycles a minute apart.
    let log = recorder.record_session(motion.as_ref(), &Session { every_s: 60.0, duration_s: 60.0 }, 1).unwrap();
    let data = data(log);
    let next = next_experiment(&data, &[finding(&effect, joint, &[(CauseLabel::Viscous, joint)])], &[]).unwrap();
    assert_eq!(next.motion, "warm_up_cycles");
    assert!(next.expected_evidence > 10.0 * next.evidence_of_this_log.max(1.0), "{next:?}");
    stays_safe(&next);
}

/// The proposal promises more than the log at hand, whatever the pair.
#[test]
fn every_confusable_pair_gets_a_sentence() {
    use CauseLabel as C;
    let (joint, load) = (Location::Joint(3), drawn(Excitation::StaticPoses, 20.0));
    let cases: [(Effect, Location, (CauseLabel, Location)); 12] = [
        (Effect::TorqueGain { joint: 1, gain_error: 0.02 }, Location::Joint(1), (C::LinkInertial, Location::Link(2))),
        (Effect::TorqueGain { joint: 3, gain_error: 0.02 }, joint, (C::Payload, Location::Arm)),
        (Effect::TimeDelay { delay_s: 0.003 }, Location::Arm, (C::JointElasticity, joint)),
        (Effect::TimeDelay { delay_s: 0.003 }, Location::Arm, (C::Viscous, joint)),
        (Effect::Coulomb { joint: 3, delta_coulomb_nm: 0.1 }, joint, (C::LoadFriction, joint)),
        (
            Effect::Stribeck { joint: 3, breakaway_minus_coulomb_nm: 0.3, stribeck_velocity_rad_s: 0.05 },
            joint,
            (C::Presliding, joint),
        ),
        (
            Effect::Stribeck { joint: 3, breakaway_minus_coulomb_nm: 0.3, stribeck_velocity_rad_s: 0.05 },
            joint,
            (C::Coulomb, joint),
        ),
        (
            Effect::BaseTilt { angle_rad: 0.03, axis: [1.0, 0.0, 0.0] },
            Location::Arm,
            (C::LinkInertial, Location::Link(1)),
        ),
        (
            Effect::RotorInertia { joint: 0, delta_rotor_inertia_kg_m2: 0.2 },
            Location::Joint(0),
            (C::LinkInertial, Location::Link(0)),
        ),
        (
            Effect::RotorInertia { joint: 5, delta_rotor_inertia_kg_m2: 0.05 },
            Location::Joint(5),
            (C::LinkInertial, Location::Link(5)),
        ),
        (
            Effect::PositionSpring { joint: 3, stiffness_nm_per_rad: 1.0, rest_rad: -2.0 },
            joint,
            (C::TorqueOffset, joint),
        ),
        (
            Effect::ExternalContact { force_n: [0.0, 0.0, 8.0], moment_nm: [0.0; 3], start_s: 2.0, end_s: 18.0 },
            Location::Arm,
            (C::Payload, Location::Arm),
        ),
    ];
    for (effect, at, rival) in cases {
        let next = proposed(load.as_ref(), &effect, at, rival);
        // Beyond ten thousand units either decides.
        assert!(next.expected_evidence >= next.evidence_of_this_log.min(1e4), "{next:?}");
    }
}

/// Statistics: of noise alone a column explains one unit, so the units are those of twice the log likelihood.
#[test]
fn the_noise_is_the_unit() {
    let data = data(log(drawn(Excitation::Cruise, 20.0).as_ref(), &[]));
    let noise = SensorNoise::of(&data, &[]).unwrap();
    let run = [Run::of_residual(&data)];
    let explained: Vec<f64> = (0..7)
        .flat_map(|joint| {
            [
                Effect::Coulomb { joint, delta_coulomb_nm: 1.0 },
                Effect::Viscous { joint, delta_viscous_nm_s_per_rad: 1.0 },
                Effect::TorqueOffset { joint, offset_nm: 1.0 },
            ]
        })
        .map(|effect| expectation::explained_alone(&run, &effect, &noise).unwrap())
        .collect();
    let mean = explained.iter().sum::<f64>() / explained.len() as f64;
    assert!((0.3..2.0).contains(&mean), "{mean}: {explained:?}");
}

/// Every motion of the library, of one joint and of all, keeps the limits, and stays the same.
#[test]
fn the_whole_library_is_safe() {
    let data = data(log(&one_way().path(), &[]));
    let pair = |joint, rival| Pair {
        found: (CauseLabel::Coulomb, Location::Joint(joint)),
        rival: (rival, Location::Joint(joint)),
        effect: Effect::Coulomb { joint, delta_coulomb_nm: 0.1 },
    };
    for motion in Motion::ALL {
        for pair in [pair(1, CauseLabel::TorqueOffset), pair(6, CauseLabel::Viscous), pair(0, CauseLabel::LoadFriction)]
        {
            let points = motion.draw(&room::of(&data, &pair, motion));
            assert_eq!(points, motion.draw(&room::of(&data, &pair, motion)));
            assert!(points.time_s.last().is_some_and(|end_s| (10.0..40.0).contains(end_s)), "{motion:?}");
            let via_points =
                points.time_s.iter().zip(&points.q_rad).map(|(t, q)| (*t, q.as_slice().to_vec())).collect();
            stays_safe(&NextExperiment {
                motion: motion.name(),
                instruction: String::new(),
                separates: [pair.found, pair.rival],
                expected_evidence: 0.0,
                evidence_of_this_log: 0.0,
                via_points,
            });
        }
    }
}
