//! Recorded logs against closed forms, finite differences and second algorithms.

use nalgebra::{SVector, Vector3};
use tribo_friction::law::CoulombViscous;
use tribo_friction::{Bristles, Compensator, CompensatorInput, VelocitySource};
use tribo_logs::{GAP_TOLERANCE, RobotLog, bursts, row};
use tribo_robot::{Arm, Kinematics, Payload, gravity_torque, presets, rnea};

use super::internal_motion::InternalMotion;
use super::{Recorder, Recording, Session, record};
use crate::excitation::{Envelope, Excitation, JointProfile, JointTrajectory, Path, ViaPoints};
use crate::hidden::JointBristles;
use crate::{Effect, TorqueSide, Truth};

const SMOOTHING: f64 = 0.005;
type Vector = SVector<f64, 7>;

fn motion() -> Box<dyn JointTrajectory<7>> {
    Excitation::Multisine.draw(&Envelope::of(&presets::panda()), 12.0, 3)
}

fn clean() -> Recording {
    Recording { rate_hz: 100.0, ..Recording::default() }.noise_free()
}

fn truth(effects: Vec<Effect>) -> Truth<7> {
    Truth { effects, ..Truth::panda_coulomb_viscous() }
}

fn log_of(effects: Vec<Effect>) -> RobotLog {
    record(&truth(effects), SMOOTHING, motion().as_ref(), &clean(), 1).unwrap()
}

fn tau(log: &RobotLog, k: usize) -> Vector {
    Vector::from(row::<7>(&log.tau_j_nm, k))
}

/// Second algorithm: the nominal model line by line.
fn rigid_and_friction(arm: &Arm<7>, motion: &dyn JointTrajectory<7>, t: f64) -> Vector {
    let s = motion.at(t);
    rnea(arm, &s.q, &s.qd, &s.qdd) + Truth::panda_coulomb_viscous().friction.torque(&s.qd, SMOOTHING)
}

#[test]
fn without_effects_and_noise_the_log_is_the_nominal_model() {
    let (log, motion, arm) = (log_of(vec![]), motion(), presets::panda());
    assert_eq!(log.rows(), 1201);
    for (k, &t) in log.time_s.iter().enumerate() {
        assert!((tau(&log, k) - rigid_and_friction(&arm, motion.as_ref(), t)).amax() < 1e-12);
        assert_eq!(row::<7>(&log.q_rad, k), <[f64; 7]>::from(motion.at(t).q));
    }
}

/// Closed form of every additive effect of one joint; the other joints do not notice.
#[test]
fn additive_effects_add_what_they_say() {
    type Law = fn(f64, f64, f64, f64) -> f64; // q, qd, s, load
    let j = 3;
    let cases: [(Effect, Law); 9] = [
        (Effect::Coulomb { joint: j, delta_coulomb_nm: 0.2 }, |_, _, s, _| 0.2 * s),
        (Effect::Viscous { joint: j, delta_viscous_nm_s_per_rad: -0.3 }, |_, qd, _, _| -0.3 * qd),
        (
            Effect::Stribeck { joint: j, breakaway_minus_coulomb_nm: 0.4, stribeck_velocity_rad_s: 0.05 },
            |_, qd, s, _| 0.4 * (-(qd / 0.05).powi(2)).exp() * s,
        ),
        (Effect::FrictionCurve { joint: j, amplitude_nm: -0.3, width_rad_s: 0.2 }, |_, qd, _, _| {
            -0.3 * (5.0 * qd).tanh()
        }),
        (Effect::CoulombAsymmetry { joint: j, asymmetry_nm: 0.1 }, |_, _, s, _| 0.1 * s.abs()),
        (Effect::TorqueOffset { joint: j, offset_nm: -0.25 }, |_, _, _, _| -0.25),
        (Effect::LoadFriction { joint: j, load_coefficient: 0.04 }, |_, _, s, load| 0.04 * load.abs() * s),
        (Effect::TorqueRipple { joint: j, cycles_per_rev: 100.0, amplitude_nm: 0.15, phase_rad: 0.7 }, |q, _, _, _| {
            0.15 * (100.0 * q + 0.7).sin()
        }),
        (Effect::PositionSpring { joint: j, stiffness_nm_per_rad: 1.5, rest_rad: -1.2 }, |q, _, _, _| 1.5 * (q + 1.2)),
    ];
    let (plain, motion, link) = (log_of(vec![]), motion(), presets::panda().link_side());
    for (effect, law) in cases {
        let log = log_of(vec![effect.clone()]);
        for (k, &t) in log.time_s.iter().enumerate() {
            let s = motion.at(t);
            let load = rnea(&link, &s.q, &s.qd, &s.qdd)[j];
            let mut expected = Vector::zeros();
            expected[j] = law(s.q[j], s.qd[j], (s.qd[j] / SMOOTHING).tanh(), load);
            assert!((tau(&log, k) - tau(&plain, k) - expected).amax() < 1e-12, "{effect:?} at {t}");
        }
    }
}

#[test]
fn arm_effects_are_inverse_dynamics_of_another_arm() {
    let payload = Payload { mass_kg: 0.7, com_m: Vector3::new(0.02, 0.0, 0.06), inertia_kg_m2: Default::default() };
    let loaded = presets::panda().with_payload(&payload);
    let mut tilted = presets::panda();
    let (s, c) = 0.03_f64.sin_cos();
    // A base turned about y by a: gravity leans towards +x.
    tilted.gravity_m_s2 = Vector3::new(9.81 * s, 0.0, -9.81 * c);
    let mut geared = presets::panda();
    geared.rotor_inertia_kg_m2[4] += 0.05;
    let heavy = presets::panda().altered(|mechanism| mechanism.links[3].mass_kg += 0.2);
    let d = heavy.links[3].com_m * 0.2;
    let o = heavy.links[3].com_m.cross_matrix();
    let i = o * o * -0.2; // a point mass at the centre of mass, about the link origin
    let cases = [
        (Effect::Payload { mass_kg: 0.7, com_m: [0.02, 0.0, 0.06], inertia_kg_m2: [0.0; 6] }, loaded),
        (Effect::BaseTilt { angle_rad: 0.03, axis: [0.0, 1.0, 0.0] }, tilted),
        (Effect::RotorInertia { joint: 4, delta_rotor_inertia_kg_m2: 0.05 }, geared),
        (
            Effect::LinkInertial {
                link: 3,
                delta_mass_kg: 0.2,
                delta_first_moment_kg_m: d.into(),
                delta_inertia_kg_m2: [i[(0, 0)], i[(0, 1)], i[(0, 2)], i[(1, 1)], i[(1, 2)], i[(2, 2)]],
            },
            heavy,
        ),
    ];
    let motion = motion();
    for (effect, arm) in cases {
        let log = log_of(vec![effect.clone()]);
        for (k, &t) in log.time_s.iter().enumerate() {
            let difference = tau(&log, k) - rigid_and_friction(&arm, motion.as_ref(), t);
            assert!(difference.amax() < 1e-11, "{effect:?} at {t}: {difference:?}");
        }
    }
}

/// Virtual power by finite differences: what the hand puts in, the motors need not: Δtau · q̇ = −(F · v + M · ω).
#[test]
fn a_contact_relieves_the_motors_of_its_power() {
    let (force, moment) = (Vector3::new(4.0, -7.0, 11.0), Vector3::new(0.5, -0.8, 0.3));
    let push = Effect::ExternalContact { force_n: force.into(), moment_nm: moment.into(), start_s: 4.0, end_s: 6.0 };
    let (plain, log, motion, arm) = (log_of(vec![]), log_of(vec![push]), motion(), presets::panda());
    for (k, &t) in log.time_s.iter().enumerate() {
        let change = tau(&log, k) - tau(&plain, k);
        if !(4.0..=6.0).contains(&t) {
            assert_eq!(change.amax(), 0.0);
        } else if t > 4.03 && t < 5.97 {
            let h = 1e-5;
            let (a, b) = (Kinematics::at(&arm, &motion.at(t - h).q), Kinematics::at(&arm, &motion.at(t + h).q));
            let v = (b.flange_origin - a.flange_origin) / (2.0 * h);
            let w = tribo_robot::so3::log(&(b.flange_rotation * a.flange_rotation.transpose())) / (2.0 * h);
            let power = change.dot(&motion.at(t).qd) + force.dot(&v) + moment.dot(&w);
            assert!(power.abs() < 1e-5, "{power} at {t}");
        }
    }
}

#[test]
fn gain_and_delay_belong_to_the_sensor() {
    let plain = log_of(vec![]);
    let gained = log_of(vec![Effect::TorqueGain { joint: 1, gain_error: 0.05 }]);
    // Two periods late, two rows late.
    let late = log_of(vec![Effect::TimeDelay { delay_s: 0.02 }]);
    let early = log_of(vec![Effect::TimeDelay { delay_s: -0.02 }]);
    for k in 2..plain.rows() - 2 {
        let mut expected = tau(&plain, k);
        expected[1] *= 1.05;
        assert!((tau(&gained, k) - expected).amax() < 1e-12);
        assert!((tau(&late, k) - tau(&plain, k - 2)).amax() < 1e-9);
        assert!((tau(&early, k) - tau(&plain, k + 2)).amax() < 1e-9);
    }
    assert_eq!(late.q_rad, plain.q_rad);
}

fn stroke() -> Path<7> {
    let (a, mut b) = (presets::panda_ready_pose(), presets::panda_ready_pose());
    b[2] += 0.02;
    ViaPoints { time_s: vec![0.0, 1.0, 2.0], q_rad: vec![a, b, a], resting: true }.path()
}

/// Closed form: moving from rest by x the bristle holds z = 1 − exp(−x/distance); back from z0, z = −1 + (1 + z0) exp(…).
#[test]
fn presliding_follows_the_way() {
    let (j, distance, path) = (2, 2e-3, stroke());
    let effect = Effect::Presliding { joint: j, presliding_distance_rad: distance, amplitude_nm: None };
    let with = record(&truth(vec![effect]), SMOOTHING, &path, &clean(), 1).unwrap();
    let without = record(&truth(vec![]), SMOOTHING, &path, &clean(), 1).unwrap();
    let coulomb = 0.55;
    let start = path.at(0.0).q[j];
    for (k, &t) in with.time_s.iter().enumerate() {
        let state = path.at(t);
        let way = state.q[j] - start;
        let there = 1.0 - (-way / distance).exp();
        let turned = 1.0 - (-0.02_f64 / distance).exp();
        let back = -1.0 + (1.0 + turned) * (-(0.02 - way) / distance).exp();
        let z = if t <= 1.0 { there } else { back };
        let expected = coulomb * (z - (state.qd[j] / SMOOTHING).tanh());
        let change = tau(&with, k) - tau(&without, k);
        assert!((change[j] - expected).abs() < 1e-4, "{} for {expected} at {t}", change[j]);
        assert!(change[j].abs() <= 2.0 * coulomb + 1e-12);
    }
}

/// Closed form: parts of dry friction add up, each `a (z − s)` with the z of its own distance; what is left at the end of a
/// cycle is there when the next begins.
#[test]
fn parts_of_dry_friction_follow_the_way() {
    let (j, parts, path) = (2, [(0.3, 2e-3), (-0.1, 1e-2), (0.2, 5e-4)], stroke());
    let bristle = |(amplitude, presliding_distance_rad)| Effect::Presliding {
        joint: j,
        presliding_distance_rad,
        amplitude_nm: Some(amplitude),
    };
    let warm = Effect::ThermalFriction { joint: j, drop_fraction: 0.3, time_constant_s: 1.0 };
    let truths = [vec![warm.clone()], [&parts.map(bristle)[..], &[warm]].concat()].map(truth);
    let [without, with] = truths.each_ref().map(|truth| {
        let recorder = Recorder { truth, smoothing_rad_s: SMOOTHING, recording: clean(), extra: None };
        recorder.record_session(&path, &Session { every_s: 3.0, duration_s: 3.0 }, 1).unwrap()
    });
    let (start, far) = (path.at(0.0).q[j], 0.02_f64);
    for (k, &log_s) in with.time_s.iter().enumerate() {
        let (t, second) = if log_s < 3.0 { (log_s, false) } else { (log_s - 3.0, true) };
        let state = path.at(t);
        let way = state.q[j] - start;
        let s = (state.qd[j] / SMOOTHING).tanh();
        let z = |distance: f64| {
            let there = |z0: f64| 1.0 + (z0 - 1.0) * (-way / distance).exp();
            let turned = |z0: f64| 1.0 + (z0 - 1.0) * (-far / distance).exp();
            let back = |z0: f64| -1.0 + (1.0 + turned(z0)) * (-(far - way) / distance).exp();
            let z0 = if second { -1.0 + (1.0 + turned(0.0)) * (-far / distance).exp() } else { 0.0 };
            if t <= 1.0 { there(z0) } else { back(z0) }
        };
        // Warmth has nothing to do with parts.
        let expected: f64 = parts.iter().map(|&(amplitude, distance)| amplitude * (z(distance) - s)).sum();
        let change = tau(&with, k) - tau(&without, k);
        assert!((change[j] - expected).abs() < 2e-4, "{} for {expected} at {log_s}", change[j]);
        assert!((change - Vector::ith(j, change[j])).amax() == 0.0);
    }
}

/// Closed form, with the acceleration by central differences of the motion's velocity; only its own joint notices.
#[test]
fn dry_friction_that_leads_turns_round_before_its_joint() {
    let (joint, amplitude_nm, width_rad_s, lead_s) = (3, 0.6, 0.05, 0.02);
    let lead = Effect::FrictionLead { joint, amplitude_nm, width_rad_s, lead_s };
    let (with, without, motion) = (log_of(vec![lead]), log_of(vec![]), motion());
    let (mut early, h) = (0, 1e-5);
    for (k, &t) in with.time_s.iter().enumerate() {
        let qd = motion.at(t).qd[joint];
        let qdd = (motion.at(t + h).qd[joint] - motion.at(t - h).qd[joint]) / (2.0 * h);
        let sign = |v: f64| (v / width_rad_s).clamp(-1.0, 1.0);
        let expected = Vector::ith(joint, amplitude_nm * (sign(qd + lead_s * qdd) - (qd / SMOOTHING).tanh()));
        assert!((tau(&with, k) - tau(&without, k) - expected).amax() < 1e-5, "at {t}");
        early += usize::from(expected.amax() > 0.1);
    }
    assert!(early > 10, "{early}");
}

/// Second algorithm: a compensator that believes the truth and is shown the motion every 50 µs gives the friction of the
/// recording, curves and bristles included.
#[test]
fn a_compensator_along_the_motion_is_the_recorded_friction() {
    let bristle = |joint, presliding_distance_rad, amplitude_nm| Effect::Presliding {
        joint,
        presliding_distance_rad,
        amplitude_nm,
    };
    let effects = vec![
        Effect::FrictionCurve { joint: 1, amplitude_nm: 0.5, width_rad_s: 0.05 },
        Effect::FrictionCurve { joint: 1, amplitude_nm: -0.2, width_rad_s: 0.4 },
        Effect::Coulomb { joint: 2, delta_coulomb_nm: 0.1 },
        bristle(2, 3e-3, Some(0.3)),
        bristle(2, 3e-2, Some(-0.1)),
        bristle(3, 5e-3, None),
        bristle(3, 2e-2, Some(0.2)),
    ];
    let (truth, motion) = (truth(effects), motion());
    let recorder = Recorder { truth: &truth, smoothing_rad_s: SMOOTHING, recording: clean(), extra: None };
    let torque = recorder.true_torque(motion.as_ref(), 0.0);
    let internal = InternalMotion::integrate(&torque, 0.0, 12.0, &[JointBristles::default(); 7]);
    let mut compensator =
        Compensator::new(truth.friction, VelocitySource::Reference).with_effects(torque.hidden.joints);
    compensator.smoothing_rad_s = SMOOTHING;
    let (dt_s, mut bristles, mut worst) = (5e-5, Bristles::default(), Vector::zeros());
    for tick in 0..240_000 {
        let t = f64::from(tick) * dt_s;
        let s = motion.at(t);
        let input = CompensatorInput { q: s.q, qd_measured: s.qd, qd_reference: s.qd, load_nm: Vector::zeros(), dt_s };
        let believed = compensator.tick(&mut bristles, &input).total();
        if tick % 50 == 0 {
            let friction = torque.at(t, &internal.at(t)) - rnea(&presets::panda(), &s.q, &s.qd, &s.qdd);
            worst = worst.sup(&(friction - believed).abs());
        }
    }
    println!("off by at most {worst:?}");
    // A travel of 50 µs at 1 rad/s over 3 mrad, of 0.4 Nm.
    assert!(worst.amax() < 7e-3, "{worst:?}");
    assert!(worst[1] < 1e-12 && worst[6] < 1e-12, "{worst:?}");
}

/// A LuGre law and a Coulomb-viscous law with the presliding effect are one truth.
#[test]
fn a_lugre_law_is_presliding() {
    let effects =
        (0..7).map(|joint| Effect::Presliding { joint, presliding_distance_rad: 5e-4, amplitude_nm: None }).collect();
    let a = record(&truth(effects), SMOOTHING, &stroke(), &clean(), 1).unwrap();
    let b = record(&Truth::panda_lugre(), SMOOTHING, &stroke(), &clean(), 1).unwrap();
    assert_eq!(a, b);
}

/// Closed form: in a held pose the link hangs by tau/K below the motor, and the torque is that of the hanging link.
#[test]
fn an_elastic_joint_hangs() {
    let (j, stiffness) = (1, 3e3);
    let mut q = presets::panda_ready_pose();
    q[1] = 0.9;
    let mut profile = q.map(JointProfile::resting_at).data.0[0].clone();
    profile[0].hold(1.0);
    let path = Path::new(profile);
    let effect = Effect::JointElasticity { joint: j, stiffness_nm_per_rad: stiffness, damping_nm_s_per_rad: 5.0 };
    let log = record(&truth(vec![effect]), SMOOTHING, &path, &clean(), 1).unwrap();
    let mut hanging = q;
    hanging[j] -= gravity_torque(&presets::panda(), &q)[j] / stiffness;
    assert!((hanging[j] - q[j]).abs() > 5e-3);
    for k in 0..log.rows() {
        assert!((tau(&log, k) - gravity_torque(&presets::panda(), &hanging)).amax() < 1e-9);
    }
}

/// Second algorithm: the torque through the spring, K δ + D δ̇, is what Newton and Euler ask for at the deflected link. They
/// differ by the stiffness of gravity over K (a part in 10³ of δ K) alone, since the load is taken at the motor angles.
#[test]
fn an_elastic_joint_transmits_what_the_link_needs() {
    let (j, stiffness, damping) = (3, 3e3, 4.0);
    let motion = Excitation::SmallFast.draw(&Envelope::of(&presets::panda()), 8.0, 2);
    let elastic = |stiffness_nm_per_rad| {
        truth(vec![Effect::JointElasticity { joint: j, stiffness_nm_per_rad, damping_nm_s_per_rad: damping }])
    };
    let (soft, stiff, rigid) = (elastic(stiffness), elastic(1e8), truth(vec![]));
    let take = |truth: &Truth<7>| record(truth, SMOOTHING, motion.as_ref(), &clean(), 1).unwrap();
    let (rigid, stiff_log) = (take(&rigid), take(&stiff));

    let recorder = Recorder { truth: &soft, smoothing_rad_s: SMOOTHING, recording: clean(), extra: None };
    let torque = recorder.true_torque(motion.as_ref(), 0.0);
    let internal = InternalMotion::integrate(&torque, 0.0, 8.0, &[JointBristles::default(); 7]);
    let (mut worst, mut moved) = (0.0_f64, 0.0_f64);
    for (k, &t) in rigid.time_s.iter().enumerate() {
        assert!((tau(&stiff_log, k) - tau(&rigid, k)).amax() < 1e-4, "a very stiff joint is rigid");
        let state = internal.at(t);
        let through_spring = stiffness * state.deflection[j] + damping * state.deflection_rate[j];
        let (motor, link) = torque.both_sides(t, &state);
        assert_eq!(motor.q, motion.at(t).q);
        let needed = rnea(&torque.link_arm, &link.q, &link.qd, &link.qdd)[j];
        worst = worst.max((through_spring - needed).abs());
        moved = moved.max((tau(&rigid, k) - torque.at(t, &internal.at(t)))[j].abs());
    }
    assert!(moved > 0.1, "elasticity shows: {moved}");
    assert!(worst < 0.1 * moved, "{worst} of {moved}");
}

/// Two encoders see the spring: K (theta − q) is the link torque when motion is slow.
#[test]
fn two_encoders_see_spring_gap_and_skew() {
    let recording = Recording { dual_encoder: true, ..clean() };
    let motion = Excitation::Multisine.draw(&Envelope::of(&presets::panda()).slower_than(0.3), 12.0, 3);
    let link = presets::panda().link_side();
    let with = |effects: Vec<Effect>, recording: &Recording| {
        record(&truth(effects), SMOOTHING, motion.as_ref(), recording, 1).unwrap()
    };
    let spring = Effect::JointElasticity { joint: 3, stiffness_nm_per_rad: 5e3, damping_nm_s_per_rad: 0.0 };
    let gap = Effect::Backlash { joint: 6, half_gap_rad: 1e-3 };
    let log = with(vec![spring, gap], &recording);
    let theta = log.theta_rad.as_ref().unwrap();
    let (mut sides, mut settled) = ([0, 0], 0);
    for (k, &t) in log.time_s.iter().enumerate() {
        let load = |t: f64| {
            let s = motion.at(t);
            rnea(&link, &s.q, &s.qd, &s.qdd)
        };
        assert!((theta[3][k] - log.q_rad[3][k] - load(t)[3] / 5e3).abs() < 1e-6);
        assert_eq!(theta[2][k], log.q_rad[2][k]);
        let lead = theta[6][k] - log.q_rad[6][k];
        assert!(lead.abs() <= 1e-3 + 1e-9);
        if t > 0.1 && (0..20).all(|i| load(t)[6].signum() == load(t - 0.005 * i as f64)[6].signum()) {
            assert!((lead - 1e-3 * load(t)[6].signum()).abs() < 1e-6, "{lead} at {t}");
            sides[usize::from(lead > 0.0)] += 1;
            settled += 1;
        }
    }
    assert!(settled > 600 && sides.iter().all(|&n| n > 50), "{sides:?}");

    let skewed = with(vec![], &Recording { encoder_skew_s: 0.003, ..recording });
    for (k, &t) in skewed.time_s.iter().enumerate() {
        let late = motion.at(t - 0.003).q;
        assert!((late[0] - skewed.theta_rad.as_ref().unwrap()[0][k]).abs() < 1e-12);
    }
}

/// Closed form: in a session of equal cycles the friction of the joint follows 1 − drop (1 − exp(−t/τ)).
#[test]
fn a_session_warms_up() {
    let effect = Effect::ThermalFriction { joint: 1, drop_fraction: 0.3, time_constant_s: 900.0 };
    let (truth, motion) = (truth(vec![effect]), motion());
    let recording = Recording { temperatures: true, ..clean() };
    let recorder = Recorder { truth: &truth, smoothing_rad_s: SMOOTHING, recording, extra: None };
    let session = Session { every_s: 300.0, duration_s: 1800.0 };
    let log = recorder.record_session(motion.as_ref(), &session, 1).unwrap();
    let parts = bursts(&log.time_s, GAP_TOLERANCE);
    assert_eq!(parts.len(), 7);
    let law = CoulombViscous { coulomb_nm: 0.9, viscous_nm_s_per_rad: 1.4 };
    for part in parts {
        for k in part {
            let t = log.time_s[k];
            let s = motion.at(t.rem_euclid(300.0));
            let scale = 1.0 - 0.3 * (1.0 - (-t / 900.0).exp());
            let rigid = rnea(&presets::panda(), &s.q, &s.qd, &s.qdd)[1];
            let friction = law.torque(s.qd[1], (s.qd[1] / SMOOTHING).tanh());
            assert!((log.tau_j_nm[1][k] - rigid - scale * friction).abs() < 1e-6, "at {t}");
        }
    }
    let temperature = log.temperature_c.as_ref().unwrap();
    let rise = temperature[1].last().unwrap() - temperature[1][0];
    assert!((rise - 12.0 * (1.0 - (-1812.0_f64 / 900.0).exp())).abs() < 0.5, "{rise}");
    assert!(recorder.record_session(motion.as_ref(), &Session { every_s: 12.0, duration_s: 60.0 }, 1).is_err());
}

#[test]
fn extra_torque_and_torque_side() {
    let (truth, motion) = (truth(vec![]), motion());
    let extra = |t: f64, q: &Vector, qd: &Vector, _: &Vector| Vector::from_fn(|j, _| t * q[j] + qd[j].powi(3));
    let recorder = Recorder { truth: &truth, smoothing_rad_s: SMOOTHING, recording: clean(), extra: Some(&extra) };
    let log = recorder.record(motion.as_ref(), 1).unwrap();
    let link =
        record(&truth, SMOOTHING, motion.as_ref(), &Recording { torque_side: TorqueSide::Link, ..clean() }, 1).unwrap();
    let plain = log_of(vec![]);
    for (k, &t) in log.time_s.iter().enumerate() {
        let s = motion.at(t);
        assert!((tau(&log, k) - tau(&plain, k) - extra(t, &s.q, &s.qd, &s.qdd)).amax() < 1e-12);
        let rotor = presets::panda().rotor_inertia_kg_m2.component_mul(&s.qdd);
        assert!((tau(&plain, k) - tau(&link, k) - rotor).amax() < 1e-12);
    }
}

/// Noise has its deviation, quantised values their lattice, and irregular clocks stay in order; a seed is a log.
#[test]
fn sensors_are_as_set() {
    let recording = Recording {
        rate_hz: 200.0,
        sampling_jitter_sd_s: 4e-4,
        stamp_jitter_sd_s: 4e-4,
        repeated_fraction: 0.1,
        encoder_sd_rad: 2e-5,
        encoder_resolution_rad: 1e-5,
        torque_sd_nm: 0.08,
        torque_resolution_nm: 0.01,
        ..Recording::default()
    };
    let (truth, motion) = (truth(vec![]), motion());
    let take = |recording: &Recording, seed| record(&truth, SMOOTHING, motion.as_ref(), recording, seed).unwrap();
    let log = take(&recording, 4);
    assert_eq!(log, take(&recording, 4));
    assert_ne!(log, take(&recording, 5));
    let repeats = (1..log.rows()).filter(|&k| tau(&log, k) == tau(&log, k - 1)).count() as f64;
    assert!((repeats / log.rows() as f64 - 0.1).abs() < 0.02, "{repeats}");
    for k in 0..log.rows() {
        let steps = log.tau_j_nm[0][k] / 0.01;
        assert!((steps - steps.round()).abs() < 1e-6);
        let steps = log.q_rad[0][k] / 1e-5;
        assert!((steps - steps.round()).abs() < 1e-6);
    }

    let noisy = take(&Recording { torque_sd_nm: 0.08, encoder_sd_rad: 2e-5, ..clean() }, 6);
    let plain = log_of(vec![]);
    let rms = |a: &[Vec<f64>], b: &[Vec<f64>]| {
        let squares: f64 = a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| (x - y).powi(2)).sum();
        (squares / (7 * plain.rows()) as f64).sqrt()
    };
    assert!((rms(&noisy.tau_j_nm, &plain.tau_j_nm) / 0.08 - 1.0).abs() < 0.03);
    assert!((rms(&noisy.q_rad, &plain.q_rad) / 2e-5 - 1.0).abs() < 0.03);
    // As the sensors of the plant: (σ/dt) a √(2/(2 − a)) at 1 kHz.
    let a = 1.0 - (-2.0 * std::f64::consts::PI * 50.0 * 1e-3_f64).exp();
    let expected = 2e-5 / 1e-3 * a * (2.0 / (2.0 - a)).sqrt();
    assert!((rms(&noisy.dq_rad_s, &plain.dq_rad_s) / expected - 1.0).abs() < 0.05);
}

/// The velocity lags by the filter: 1/(2π 50 Hz) and half a tick.
#[test]
fn velocity_is_filtered_and_late() {
    let (log, motion) = (log_of(vec![]), motion());
    let lag_s = 1.0 / (2.0 * std::f64::consts::PI * 50.0);
    for (k, &t) in log.time_s.iter().enumerate().filter(|(_, t)| **t > 0.2 && **t < 11.8) {
        let late = motion.at(t - lag_s).qd;
        assert!((Vector::from(row::<7>(&log.dq_rad_s, k)) - late).amax() < 4e-3, "at {t}");
    }
}

#[test]
fn bad_settings_and_effects_are_named() {
    let motion = motion();
    let attempt = |effects: Vec<Effect>, recording: Recording| {
        record(&truth(effects), SMOOTHING, motion.as_ref(), &recording, 1).unwrap_err().to_string()
    };
    assert_eq!(attempt(vec![], Recording { rate_hz: 0.0, ..clean() }), "rate_hz: 0 is outside 1..10000");
    let absent = Effect::Backlash { joint: 9, half_gap_rad: 1e-3 };
    assert_eq!(attempt(vec![absent], clean()), "backlash: 9 is outside 0..7: joints and links count from 0");
}
