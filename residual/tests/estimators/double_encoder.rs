//! Two encoders per joint: from a log to a model to wrenches, against gears whose law is known.

use std::sync::Arc;

use crate::common::prescribed::{Sample, hold, run, samples, sway};
use nalgebra::{SVector, Vector6};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_friction::FrictionModel;
use tribo_friction::law::CoulombViscous;
use tribo_logs::{LogColumns, RobotLog};
use tribo_residual::{
    CalibrationError, DeflectionMean, DoubleEncoderEstimator, DoubleEncoderModel, DoubleEncoderSettings, Rests,
    calibrate,
};
use tribo_robot::{EstimateFault, Kinematics, Wrench, WrenchEstimator, presets};

type Joints = SVector<f64, 7>;

/// Stiffness of the prescribed gears (Nm/rad).
const STIFFNESS: [f64; 7] = presets::PANDA_JOINT_STIFFNESS_NM_PER_RAD;
const ENCODER_SD_RAD: f64 = 1e-5;

/// A log at 100 Hz of an arm that goes from pose to pose around the ready one and is pushed at every fourth.
fn log(poses: usize, seed: u64) -> RobotLog {
    let arm = presets::panda();
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut columns = LogColumns {
        q_rad: vec![Vec::new(); 7],
        dq_rad_s: vec![Vec::new(); 7],
        tau_j_nm: vec![Vec::new(); 7],
        theta_rad: Some(vec![Vec::new(); 7]),
        o_f_ext: Some(Default::default()),
        ..LogColumns::default()
    };
    let mut time_s = 0.0;
    let mut last = presets::panda_ready_pose();
    for pose in 0..poses {
        let next = presets::panda_ready_pose() + Joints::from_fn(|_, _| rng.random_range(-0.35..0.35));
        let push = Vector6::from_fn(|i, _| rng.random_range(-1.0..1.0) * if i < 3 { 4.0 } else { 25.0 });
        // A second of motion, half a second of rest, and half a second under load.
        for k in 0..if pose % 4 == 0 { 200 } else { 150 } {
            let part = (f64::from(k) / 100.0).min(1.0);
            let q = last.lerp(&next, part);
            let qd = if k < 100 { next - last } else { Joints::zeros() };
            let h = if k >= 150 { push } else { Vector6::zeros() };
            let kinematics = Kinematics::at(&arm, &q);
            let load = kinematics.gravity_torque(&arm) + kinematics.jacobian().transpose() * h;
            columns.time_s.push(time_s);
            time_s += 0.01;
            let wrench = Wrench::from_vector(&h).to_force_moment();
            for j in 0..7 {
                let [a, b]: [f64; 2] = std::array::from_fn(|_| rng.sample(StandardNormal));
                columns.q_rad[j].push(q[j] + ENCODER_SD_RAD * a);
                columns.dq_rad_s[j].push(qd[j]);
                columns.tau_j_nm[j].push(load[j]);
                columns.theta_rad.as_mut().expect("two encoders")[j]
                    .push(q[j] + load[j] / STIFFNESS[j] + ENCODER_SD_RAD * b);
            }
            for (column, value) in columns.o_f_ext.as_mut().expect("a reference").iter_mut().zip(wrench) {
                column.push(value);
            }
        }
        last = next;
    }
    columns.validate().expect("a valid log")
}

fn from_log(settings: DoubleEncoderSettings, poses: usize) -> Result<DoubleEncoderModel<7>, CalibrationError> {
    let settings = settings.validate()?;
    calibrate(&presets::panda(), &Rests::in_log(&log(poses, 1), &settings)?, settings, 1)
}

fn no_friction() -> FrictionModel<7> {
    FrictionModel::uniform(CoulombViscous::default().into())
}

/// The log says everything: stiffness of each gear, gravity of an arm whose masses nobody knows, and wrenches at poses
/// of another log.
#[test]
fn a_log_makes_a_model_that_weighs_wrenches_elsewhere() {
    let model = from_log(DoubleEncoderSettings::paper(), 160).unwrap();
    // Loads that the pushes reach: the wrist has hardly a lever.
    let reached_nm = [15.0, 15.0, 15.0, 15.0, 4.0, 4.0, 4.0];
    for ((curve, truth), reached) in model.curves().iter().zip(STIFFNESS).zip(reached_nm) {
        // Within four of its own standard deviations everywhere, which are small where loads have been.
        for torque in [-1.0, -0.3, 0.3, 1.0].map(|part| part * reached) {
            let (got, variance) = curve.torque_between_nm(0.0, torque / truth);
            assert!((got - torque).abs() < 4.0 * variance.sqrt() && variance.sqrt() < 0.3, "{torque} {curve:?}");
        }
    }
    let others = Rests::<7>::in_log(&log(60, 2), model.settings()).unwrap();
    assert_eq!((others.free.len(), others.loaded.len()), (60, 15));
    let loaded: Vec<_> = others.loaded.iter().map(|rest| rest.loaded).collect();
    let (mut inside, mut worst) = (0, 0.0_f64);
    for (rest, at) in others.loaded.iter().zip(model.wrenches(&presets::panda(), &loaded)) {
        let at = at.unwrap();
        let error = at.wrench_base.to_vector() - rest.wrench_base.to_vector();
        worst = worst.max(error.fixed_rows::<3>(3).norm());
        inside += (0..6).filter(|&i| error[i].abs() <= 1.96 * at.covariance[(i, i)].sqrt()).count();
    }
    // 90 components: 95 % is 85.5 ± 2.1, and errors of one rest go together.
    assert!((78..=90).contains(&inside), "{inside} of 90 in their bands");
    assert!(worst < 4.0, "{worst} N on pushes of up to 43 N");
}

/// Second algorithm: the tick on inducing points and slopes, against the exact processes at rest.
#[test]
fn the_tick_ends_where_the_exact_processes_are() {
    let truth = Wrench::from_force_moment(&[8.0, -5.0, 12.0, 1.0, -0.5, 0.7]);
    let settings = DoubleEncoderSettings { gain_rad_s: 100.0, ..DoubleEncoderSettings::paper() };
    let model = Arc::new(from_log(settings, 120).unwrap());
    let samples = samples(hold, &|_| truth, &no_friction(), 400);
    let last = &samples[400];
    let rest = tribo_residual::Rest {
        q: last.frame.q,
        deflection_rad: last.frame.theta.unwrap() - last.frame.q,
        direction: Joints::zeros(),
        loading: Joints::zeros(),
    };
    let exact = model.wrenches(&presets::panda(), &[rest])[0].unwrap().wrench_base.to_vector();
    let tick = run(&mut DoubleEncoderEstimator::new(model), &samples)[399];
    let difference = tick.wrench_base.to_vector() - exact;
    // Compression of the processes is stated as some 1e-7 rad, 1e-3 Nm; weights differ by the observer's noise.
    assert!(difference.amax() < 0.2, "{difference}");
    assert!((exact - truth.to_vector()).amax() < 2.0, "{exact}");
}

/// Learnt from poses, used while moving: inertia is not taken for contact.
#[test]
fn a_calibrated_estimator_moves() {
    let settings = DoubleEncoderSettings { mean: DeflectionMean::RigidBody, ..DoubleEncoderSettings::paper() };
    let mut estimator = DoubleEncoderEstimator::new(Arc::new(from_log(settings, 120).unwrap()));
    let truth = Wrench::from_force_moment(&[0.0, 15.0, 0.0, 0.0, 0.0, 0.0]);
    let estimates = run(&mut estimator, &samples(sway, &|_| truth, &no_friction(), 1500));
    for estimate in &estimates[500..] {
        let error = estimate.wrench_base.to_vector() - truth.to_vector();
        assert!(error.fixed_rows::<3>(3).norm() < 1.0 && error.fixed_rows::<3>(0).norm() < 0.2, "{error}");
        assert!(estimate.interval95().contain(&truth).iter().filter(|&&inside| inside).count() >= 5);
    }
}

#[test]
fn a_frame_without_motor_positions_is_a_fault() {
    let settings = DoubleEncoderSettings::default().validate().unwrap();
    let model = DoubleEncoderModel::nominal(&presets::panda(), STIFFNESS, 0.02, settings);
    let mut estimator = DoubleEncoderEstimator::new(Arc::new(model));
    let good = samples(hold, &|_| Wrench::default(), &no_friction(), 20);
    let undisturbed = run(&mut estimator, &good);
    estimator.reset(&good[0].frame, &good[0].terms);
    for (k, sample) in good[1..].iter().enumerate() {
        let mut blind: Sample = sample.clone();
        blind.frame.theta = None;
        let held = estimator.step(&blind.input());
        assert_eq!(held.fault, Some(EstimateFault::MotorPositionMissing));
        assert_eq!(estimator.step(&sample.input()), undisturbed[k]);
    }
}

#[test]
fn what_a_calibration_lacks_is_named() {
    let settings = DoubleEncoderSettings::paper().validate().unwrap();
    let mut columns = log(8, 3).into_columns();
    columns.theta_rad = None;
    let single = columns.validate().unwrap();
    assert_eq!(Rests::<7>::in_log(&single, &settings).unwrap_err(), CalibrationError::NoMotorPositions);
    assert_eq!(Rests::<6>::in_log(&single, &settings).unwrap_err(), CalibrationError::JointCount { need: 6, got: 7 });
    let few = from_log(DoubleEncoderSettings::paper(), 12).unwrap_err();
    assert_eq!(few, CalibrationError::TooFewPoses { need: 40, got: 12 });
    let unloaded = from_log(DoubleEncoderSettings::paper(), 60).unwrap_err();
    assert_eq!(unloaded, CalibrationError::TooFewLoads { joint: 0, need: 30, got: 15 });
    assert!(unloaded.to_string().contains("O_F_ext"), "{unloaded}");
}
