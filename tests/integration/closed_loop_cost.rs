//! What a trial costs: the tables that the tuning strategies are measured against.
//!
//! Reference: an independent prototype of the same physics (ready pose, paper phases, ±3 %
//! repeatability). Rows are means over [`SEEDS`]. Tolerances are the prototype's acceptance bars where they give one (J0 ±0.5,
//! measured oracle ±0.8, reference and hybrid ±0.3, frictionless ±0.2) and otherwise the larger of 3 % and 0.3, which is
//! three of the prototype's own standard deviations.

use nalgebra::Vector6;
use tribo_friction::VelocitySource::{Hybrid, Measured, Reference};
use tribo_friction::{FrictionModel, VelocitySource};
use tribo_sim::Truth;
use tribo_tests::{DT_S, default_ekf, no_friction, tuning_trial};
use tribo_trial::{AbortReason, Trial, TrialOutcome, run_trial, run_trial_observed};

const SEEDS: std::ops::RangeInclusive<u64> = 1..=3;

fn run(trial: &Trial<7>, friction: &FrictionModel<7>, seed: u64) -> TrialOutcome<7> {
    run_trial(trial, friction, default_ekf(), seed)
}

fn mean_cost(trial: &Trial<7>, friction: &FrictionModel<7>) -> f64 {
    let total: f64 = SEEDS
        .map(|seed| {
            let outcome = run(trial, friction, seed);
            assert_eq!(outcome.aborted, None);
            outcome.cost.total()
        })
        .sum();
    total / SEEDS.count() as f64
}

/// One row: mean J without compensation and with the true parameters, measured / reference / hybrid velocity.
fn row(truth: &Truth<7>, nullspace_damping_per_s: f64) -> [f64; 4] {
    let trial = |velocity: VelocitySource| {
        let mut trial = tuning_trial(truth.clone(), velocity);
        trial.impedance.nullspace_damping_per_s = nullspace_damping_per_s;
        trial
    };
    let oracle = |velocity| mean_cost(&trial(velocity), &truth.friction);
    [mean_cost(&trial(Hybrid), &no_friction()), oracle(Measured), oracle(Reference), oracle(Hybrid)]
}

fn assert_row(name: &str, measured: [f64; 4], expected: [f64; 4], tolerance: [f64; 4]) {
    println!("{name}: none, M, R, H = {measured:.3?}, notes {expected:?}");
    for k in 0..4 {
        assert!((measured[k] - expected[k]).abs() <= tolerance[k], "{name}: {measured:.3?} against {expected:?}");
    }
}

fn three_percent(expected: [f64; 4]) -> [f64; 4] {
    expected.map(|j| (0.03 * j).max(0.3))
}

#[test]
fn coulomb_viscous_meets_the_acceptance_bars() {
    let expected = [24.2, 12.4, 3.1, 3.1];
    assert_row("CV Dn 50", row(&Truth::panda_coulomb_viscous(), 50.0), expected, [0.5, 0.8, 0.3, 0.3]);
}

#[test]
fn frictionless_meets_the_acceptance_bar() {
    assert_row("frictionless Dn 50", row(&Truth::panda_frictionless(), 50.0), [2.25; 4], [0.2; 4]);
}

/// The prototype's table was made with Dn = 5 1/s.
#[test]
fn coulomb_viscous_agrees_with_the_table() {
    let expected = [24.15, 12.2, 3.08, 3.08];
    assert_row("CV Dn 5", row(&Truth::panda_coulomb_viscous(), 5.0), expected, three_percent(expected));
}

#[test]
fn stribeck_agrees_with_the_table() {
    let expected = [29.7, 16.0, 3.26, 3.26];
    assert_row("Stribeck Dn 5", row(&Truth::panda_stribeck(), 5.0), expected, three_percent(expected));
}

#[test]
fn lugre_agrees_with_the_table() {
    let expected = [23.9, 10.8, 6.47, 6.47];
    assert_row("LuGre Dn 5", row(&Truth::panda_lugre(), 5.0), expected, three_percent(expected));
}

#[test]
fn gaz_agrees_with_the_table() {
    let expected = [4.51, 2.25, 2.26, 2.26];
    assert_row("Gaz Dn 5", row(&Truth::panda_gaz(), 5.0), expected, three_percent(expected));
}

/// Regression. Without the pre-roll, eq. (35) starts with a jump of up to 2.5 cm and 5°. The jump, not the friction, is then
/// what J reports: measured 9.3 in hybrid mode instead of 3.0 (the prototype: 15 instead of 3). The tool's 15 Hz
/// acceleration, as the length of a vector, passes the 5 m/s² and 30 rad/s² that the prototype penalises (prototype: 6 and 34).
#[test]
fn without_the_pre_roll_the_first_jump_is_what_is_measured() {
    let truth = Truth::panda_coulomb_viscous();
    let mut trial = tuning_trial(truth.clone(), Hybrid);
    (trial.reference.hold_s, trial.reference.ramp_s) = (0.0, 1e-6);
    (trial.limits.acceleration_m_s2, trial.limits.acceleration_rad_s2) = (f64::INFINITY, f64::INFINITY);
    let cost = mean_cost(&trial, &truth.friction);
    let (linear, angular) = fastest_acceleration(&trial, &truth.friction);
    println!("no pre-roll: J {cost:.2}, {linear:.2} m/s2, {angular:.1} rad/s2");
    assert!((cost - 9.3).abs() <= 1.5, "{cost}");
    assert!((5.0..7.0).contains(&linear) && (30.0..36.0).contains(&angular), "{linear} {angular}");
    // With the pre-roll both stay far away from it.
    let (linear, angular) = fastest_acceleration(&tuning_trial(truth.clone(), Hybrid), &truth.friction);
    println!("with it: {linear:.2} m/s2, {angular:.1} rad/s2");
    assert!(linear < 1.0 && angular < 6.0, "{linear} {angular}");
}

/// Largest length of the tool's acceleration, linear [m/s²] and angular [rad/s²], behind a 15 Hz first-order filter.
fn fastest_acceleration(trial: &Trial<7>, friction: &FrictionModel<7>) -> (f64, f64) {
    let weight = 1.0 - (-2.0 * std::f64::consts::PI * 15.0 * DT_S).exp();
    let (mut last, mut filtered) = (None, Vector6::zeros());
    let (mut linear, mut angular) = (0.0_f64, 0.0_f64);
    run_trial_observed(trial, friction, default_ekf(), 1, |record, _| {
        let twist = record.task.twist;
        filtered += ((twist - last.unwrap_or(twist)) / DT_S - filtered) * weight;
        last = Some(twist);
        angular = angular.max(filtered.fixed_rows::<3>(0).norm());
        linear = linear.max(filtered.fixed_rows::<3>(3).norm());
    });
    (linear, angular)
}

#[test]
fn same_seed_same_bits() {
    let truth = Truth::panda_stribeck();
    let trial = tuning_trial(truth.clone(), Hybrid);
    let first = run(&trial, &truth.friction, 7);
    assert_eq!(first, run(&trial, &truth.friction, 7));
    assert_ne!(first.cost, run(&trial, &truth.friction, 8).cost);
}

/// Notes §6, measured velocity, Dn = 5: excess Coulomb friction is a constant drive, the tool holds its path and the
/// elbow slides at ΔFc/(B Dn) until a joint limit. 1.25 still runs (11.6); 1.4 and 2 do not (530 and 920, penalty
/// 1000 exp(−ξ/T) plus the cost so far).
#[test]
fn over_compensation_ends_in_a_penalty() {
    let truth = Truth::panda_coulomb_viscous();
    let mut trial = tuning_trial(truth.clone(), Measured);
    trial.impedance.nullspace_damping_per_s = 5.0;
    let mild = mean_cost(&trial, &truth.friction.scaled(1.25));
    println!("k 1.25: {mild:.2}");
    assert!((mild - 11.6).abs() <= 1.5, "{mild}");
    let at = |scale: f64| run(&trial, &truth.friction.scaled(scale), 1);
    let mut last_abort_s = f64::INFINITY;
    for scale in [1.4, 1.7, 2.0] {
        let outcome = at(scale);
        println!("k {scale}: {:.1} {:?} at {:?}", outcome.cost.total(), outcome.aborted, outcome.aborted_at_s);
        assert_eq!(outcome.aborted, Some(AbortReason::JointLimit), "k {scale}");
        let at_s = outcome.aborted_at_s.unwrap();
        assert!(at_s < last_abort_s, "more over-compensation must crash sooner");
        assert!((outcome.cost.penalty - 1000.0 * (-at_s.max(0.0) / 30.0).exp()).abs() < 1e-9);
        assert!(outcome.cost.total() > 400.0);
        last_abort_s = at_s;
    }
    // The cure that the defaults contain.
    trial.impedance.nullspace_damping_per_s = 50.0;
    assert_eq!(run(&trial, &truth.friction.scaled(1.4), 1).aborted, None);
}
