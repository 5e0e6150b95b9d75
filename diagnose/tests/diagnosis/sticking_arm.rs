//! An arm whose joints stick where they turn back.

use nalgebra::SVector;
use tribo_diagnose::{DiagnoseSettings, Diagnosis, diagnose};
use tribo_friction::FrictionModel;
use tribo_regression::{CauseLabel, Nominal};
use tribo_robot::{Arm, presets};
use tribo_sim::excitation::{JointState, JointTrajectory};
use tribo_sim::{Effect, Recording, Truth, record};

const DURATION_S: f64 = 30.0;
const STOP_S: f64 = 0.15;
const SWING_RAD: f64 = 0.5;

/// Strokes from one end to the other that begin and end without acceleration, and a stop at each end.
struct WithStops;

/// Part of a stroke at either end in which the joint hardly moves, and sticks as in the stop.
const CREEPS: f64 = 0.06;

impl WithStops {
    /// Duration of a joint's stroke (s), without the stop.
    fn stroke_s(joint: usize) -> f64 {
        0.9 + 0.13 * joint as f64
    }

    /// The way of a stroke, 1 forwards and −1 backwards, and how much of it is done; more than 1 in the stop after it.
    fn stroke(joint: usize, time_s: f64) -> (f64, f64) {
        let strokes = time_s / (Self::stroke_s(joint) + STOP_S);
        let way = if strokes.floor() % 2.0 == 0.0 { 1.0 } else { -1.0 };
        (way, strokes.fract() * (1.0 + STOP_S / Self::stroke_s(joint)))
    }

    /// Friction of a joint over its dry friction: its way in motion, a straight line over a stop, or nothing.
    fn friction(joint: usize, time_s: f64, sticks: bool) -> f64 {
        let (way, done) = Self::stroke(joint, time_s);
        let stop = STOP_S / Self::stroke_s(joint);
        // Since the joint began to creep, over all the time that it sticks.
        let stopped = (if done < CREEPS { done + stop + CREEPS } else { done - 1.0 + CREEPS }) / (stop + 2.0 * CREEPS);
        match done < CREEPS {
            _ if stopped < 0.0 => way,
            _ if !sticks => 0.0,
            true => way * (2.0 * stopped - 1.0),
            false => way * (1.0 - 2.0 * stopped),
        }
    }
}

impl JointTrajectory<7> for WithStops {
    fn duration_s(&self) -> f64 {
        DURATION_S
    }

    fn at(&self, time_s: f64) -> JointState<7> {
        let of = |part: fn(f64) -> f64, rate: i32| {
            SVector::from_fn(|j, _| {
                let (way, done) = Self::stroke(j, time_s);
                way * SWING_RAD * part(done.min(1.0)) / Self::stroke_s(j).powi(rate)
            })
        };
        JointState {
            q: presets::panda_ready_pose() + of(|x| 2.0 * x.powi(3) * (10.0 - 15.0 * x + 6.0 * x * x) - 1.0, 0),
            qd: of(|x| 60.0 * x * x * (1.0 - x).powi(2), 1),
            qdd: of(|x| 120.0 * x * (1.0 - x) * (1.0 - 2.0 * x), 2),
        }
    }
}

fn dry_nm(arm: &Arm<7>, joint: usize) -> f64 {
    0.02 * arm.limits.tau_max_nm[joint]
}

fn diagnosed(sticks: bool) -> Diagnosis {
    let arm = presets::panda();
    let recording = Recording { rate_hz: 500.0, torque_sd_nm: 0.02, ..Recording::default() };
    let truth = Truth::new(arm.clone(), FrictionModel::none());
    let mut log = record(&truth, 0.005, &WithStops, &recording, 1).unwrap().into_columns();
    for (joint, torque_nm) in log.tau_j_nm.iter_mut().enumerate() {
        for (torque_nm, time_s) in torque_nm.iter_mut().zip(&log.time_s) {
            *torque_nm += dry_nm(&arm, joint) * WithStops::friction(joint, *time_s, sticks);
        }
    }
    let (friction, torque_side) = (FrictionModel::none(), recording.torque_side);
    let nominal = Nominal { smoothing_rad_s: 0.005, ..Nominal::new(arm, friction, torque_side) };
    diagnose(&[log.validate().unwrap()], &nominal, &[], &DiagnoseSettings::default(), &|_, _| true).unwrap()
}

/// Joints that stick are known for it, and their friction in motion is found; no cause stands for the stops but friction that bends.
#[test]
fn sticking_is_no_cause() {
    let found = diagnosed(true);
    assert!(found.sticks, "{:?}", found.notes);
    let labels: Vec<CauseLabel> = found.findings.iter().map(|finding| finding.label).collect();
    assert!(labels.contains(&CauseLabel::Coulomb), "{labels:?}");
    let stands_for_stops = [CauseLabel::Presliding, CauseLabel::TimeDelay, CauseLabel::Stribeck];
    assert!(!labels.iter().any(|label| stands_for_stops.contains(label)), "{labels:?}");
    for joint in 0..7 {
        let over_true = sliding_nm(&found.effects(), joint, 0.4) / dry_nm(&presets::panda(), joint);
        assert!((0.95..1.05).contains(&over_true), "joint {joint}: {over_true}");
    }
}

/// Friction of a joint at a speed [rad/s] (Nm).
fn sliding_nm(effects: &[Effect], joint: usize, qd: f64) -> f64 {
    let of = effects.iter().map(|effect| match effect {
        Effect::Coulomb { joint: at, delta_coulomb_nm } if *at == joint => *delta_coulomb_nm,
        Effect::Viscous { joint: at, delta_viscous_nm_s_per_rad } if *at == joint => delta_viscous_nm_s_per_rad * qd,
        Effect::FrictionCurve { joint: at, amplitude_nm, width_rad_s } if *at == joint => {
            amplitude_nm * (qd / width_rad_s).tanh()
        }
        _ => 0.0,
    });
    of.sum()
}

/// The same motion without friction in the stops is not taken for sticking.
#[test]
fn stops_without_friction_are_not_sticking() {
    assert!(!diagnosed(false).sticks);
}
