//! The band identified from simulated logs covers what other logs of the same arm show.
//!
//! A Panda strokes back and forth in free space, fast and slow, under three truths: Coulomb and viscous friction, the
//! same with bristles (friction lags every reversal by 0.5 mrad), and Stribeck friction, which no band describes exactly.
//! The nominal arm is the true one. Logs of another seed, never fitted, say whether 95 % is 95 %.

use nalgebra::SVector;
use tribo_friction::{FrictionBand, JointFriction};
use tribo_logs::RobotLog;
use tribo_residual::{BandFitError, JointBandFit, QpEstimator, QpSettings, band_coverage, identify_band};
use tribo_robot::{ControlTerms, EstimatorInput, SensorFrame, Wrench, WrenchEstimator, presets};
use tribo_sim::excitation::{Chain, Envelope, Excitation};
use tribo_sim::{Effect, Recording, Truth, record};

/// Gain of the observer (rad/s), as the default of the estimators.
const GAIN_RAD_S: f64 = 50.0;

fn log(truth: &Truth<7>, duration_s: f64, seed: u64) -> RobotLog {
    let envelope = Envelope::of(&presets::panda());
    let [fast, slow] =
        [Excitation::Cruise, Excitation::BackAndForth].map(|kind| kind.draw(&envelope, 0.5 * duration_s, seed));
    record(truth, 1e-3, &Chain::new(fast, vec![slow]), &Recording::default(), seed).expect("a log")
}

fn band_of(fits: &[JointBandFit; 7]) -> FrictionBand<7> {
    FrictionBand::new(fits.map(|fit| fit.band)).expect("valid bands")
}

/// Coverage of a held-out log, over all joints by class of speed, and the least of any joint and class.
fn held_out(truth: &Truth<7>) -> ([JointBandFit; 7], [f64; 5], f64) {
    let arm = presets::panda();
    let fits = identify_band(&log(truth, 90.0, 1), &arm, GAIN_RAD_S).expect("a band");
    let coverage = band_coverage(&band_of(&fits), &log(truth, 90.0, 2), &arm, GAIN_RAD_S).expect("a log of the arm");
    let classes = std::array::from_fn(|class| coverage.iter().map(|joint| joint[class]).sum::<f64>() / 7.0);
    let least = coverage.iter().flatten().fold(1.0, |a: f64, b| a.min(*b));
    for fit in &fits {
        println!("{fit:.4?}");
    }
    println!("held out, slow to fast: {classes:.3?}, least {least:.3}");
    (fits, classes, least)
}

#[test]
fn coulomb_and_viscous_friction_are_found_and_covered() {
    let truth = Truth::panda_coulomb_viscous();
    let (fits, classes, least) = held_out(&truth);
    for (fit, law) in fits.iter().zip(&truth.friction.joints) {
        let JointFriction::CoulombViscous(law) = law else { panic!("the truth is Coulomb and viscous") };
        // Four standard errors of the noisiest joint, 0.5 Nm over 4400 rows.
        let half = 0.5 * (fit.band.coulomb_max_nm - fit.band.coulomb_min_nm);
        let middle = 0.5 * (fit.band.coulomb_max_nm + fit.band.coulomb_min_nm);
        assert!((half - law.coulomb_nm).abs() < 0.03 && middle.abs() < 0.03, "{half} {middle} {law:?}");
        // The velocity lags by 3 ms, so inertia leaks into c while a fast stroke speeds up.
        let viscous = fit.band.viscous_nm_s_per_rad / law.viscous_nm_s_per_rad;
        assert!((viscous - 1.0).abs() < 0.1, "{fit:?} {law:?}");
    }
    assert!(classes.iter().all(|share| (0.94..=0.999).contains(share)), "{classes:?}");
    assert!(least > 0.90, "{least}");
}

#[test]
fn friction_that_lags_is_covered() {
    let (_, classes, least) = held_out(&Truth::panda_lugre());
    assert!(classes.iter().all(|share| *share > 0.94), "{classes:?}");
    assert!(least > 0.90, "{least}");
}

#[test]
fn friction_of_another_law_is_covered() {
    let (fits, classes, least) = held_out(&Truth::panda_stribeck());
    assert!(classes.iter().all(|share| *share > 0.94), "{classes:?}");
    assert!(least > 0.90, "{least}");
    assert!(fits.iter().any(|fit| fit.widened > 1.05), "the likelihood alone is not enough here");
}

/// From one log to the wrench on another: the band identified in free space, the wrench of a log with a contact for the
/// half of it. The environment pushes the robot, so the wrench by the robot is the opposite.
#[test]
fn an_identified_band_gives_a_wrench_whose_limits_hold() {
    let (arm, free) = (presets::panda(), Truth::panda_lugre());
    let band = band_of(&identify_band(&log(&free, 90.0, 1), &arm, GAIN_RAD_S).unwrap());
    let (force_n, moment_nm) = ([12.0, -8.0, 10.0], [0.8, -0.5, 0.3]);
    let contact = Effect::ExternalContact { force_n, moment_nm, start_s: 5.0, end_s: 25.0 };
    let pushed = log(&Truth { effects: vec![contact], ..free }, 40.0, 3);
    let by_robot = Wrench { force_n: force_n.into(), moment_nm: moment_nm.into() }.reaction();

    let mut estimator = QpEstimator::new(QpSettings { gain_rad_s: GAIN_RAD_S, ..QpSettings::new(band) });
    let at = |columns: &[Vec<f64>], k: usize| SVector::<f64, 7>::from_fn(|j, _| columns[j][k]);
    let (mut inside, mut count, mut force2) = ([0; 2], [0; 2], [0.0; 2]);
    for k in 0..pushed.rows() {
        let (q, qd, tau) = (at(&pushed.q_rad, k), at(&pushed.dq_rad_s, k), at(&pushed.tau_j_nm, k));
        let (time_s, none) = (pushed.time_s[k], SVector::zeros());
        let (frame, terms) = (SensorFrame { time_s, q, qd, tau, theta: None }, ControlTerms::at(&arm, &q, &qd));
        if k == 0 {
            estimator.reset(&frame, &terms);
            continue;
        }
        let estimate = estimator.step(&EstimatorInput {
            frame: &frame,
            terms: &terms,
            tau_motor: &((tau + at(&pushed.tau_j_nm, k - 1)) * 0.5),
            tau_friction: &none,
            acceleration_command: &nalgebra::Vector6::zeros(),
            dt_s: time_s - pushed.time_s[k - 1],
        });
        assert_eq!(estimate.fault, None);
        // Not while the contact comes and goes: the estimate is 20 ms late.
        let edge_s = [0.0, 5.0, 25.0].map(|edge: f64| time_s - edge);
        if edge_s.iter().any(|after| (-0.03..0.2).contains(after)) {
            continue;
        }
        let touched = usize::from((5.0..25.0).contains(&time_s));
        let truth = if touched == 1 { by_robot } else { Wrench::default() };
        inside[touched] += estimate.interval95().contain(&truth).iter().filter(|&&inside| inside).count();
        force2[touched] += (estimate.wrench_base.force_n - truth.force_n).norm_squared() / 3.0;
        count[touched] += 1;
    }
    for touched in 0..2 {
        let share = inside[touched] as f64 / (6 * count[touched]) as f64;
        let rmse_n = (force2[touched] / f64::from(count[touched])).sqrt();
        println!("contact {touched}: covered {:.1} %, RMSE {rmse_n:.2} N", 100.0 * share);
        assert!(share > 0.94 && rmse_n < 2.0, "contact {touched}: {share}, {rmse_n} N");
    }
}

#[test]
fn a_log_that_gives_no_band_says_why() {
    let (arm, truth) = (presets::panda(), Truth::panda_coulomb_viscous());
    let error = identify_band(&log(&truth, 4.0, 1), &arm, GAIN_RAD_S).unwrap_err();
    assert!(matches!(error, BandFitError::TooShort { need: 300, .. }), "{error}");
    let mut columns = log(&truth, 30.0, 1).into_columns();
    columns.dq_rad_s[0].iter_mut().for_each(|speed| *speed = speed.abs());
    let error = identify_band(&columns.clone().validate().unwrap(), &arm, GAIN_RAD_S).unwrap_err();
    assert_eq!(error, BandFitError::OneDirection { joint: 0 });
    for quantity in [&mut columns.q_rad, &mut columns.dq_rad_s, &mut columns.tau_j_nm] {
        quantity.truncate(6);
    }
    let error = identify_band(&columns.validate().unwrap(), &arm, GAIN_RAD_S).unwrap_err();
    assert_eq!(error, BandFitError::JointCount { got: 6, need: 7 });
}
