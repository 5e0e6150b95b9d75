//! The band identified from simulated logs covers what other logs of the same arm show.
//!
//! A Panda strokes back and forth in free space, fast and slow, under three truths: Coulomb and viscous friction, the
//! same with bristles (friction lags every reversal by 0.5 mrad), and Stribeck friction, which no band describes exactly.
//! The nominal arm is the true one. Logs of another seed, never fitted, say whether 95 % is 95 %.

use tribo_friction::JointFriction;
use tribo_logs::RobotLog;
use tribo_residual::{BandFitError, FrictionBand, JointBandFit, band_coverage, identify_band};
use tribo_robot::presets;
use tribo_sim::excitation::{Chain, Envelope, Excitation};
use tribo_sim::{Recording, Truth, record};

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
