//! The momentum observer against its closed form, and its confidence against statistics.

use crate::common::prescribed::{DT_S, hold, run, samples, sway};
use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_friction::law::CoulombViscous;
use tribo_friction::{FrictionBand, FrictionModel, JointBand};
use tribo_residual::{MomentumEstimator, MomentumObserver, MomentumSettings};
use tribo_robot::{Wrench, WrenchEstimator};

type Joints = SVector<f64, 7>;

fn no_friction() -> FrictionModel<7> {
    FrictionModel::uniform(CoulombViscous::default().into())
}

fn push() -> Wrench {
    Wrench::from_force_moment(&[5.0, -8.0, 10.0, 0.5, 1.0, -0.7])
}

/// Closed form at rest: a step of Jᵀh is answered by `Jᵀh (1 − exp(−K t))`, exactly, at any period.
#[test]
fn a_step_is_answered_by_an_exponential() {
    for (gain, every) in [(50.0, 1), (10.0, 1), (200.0, 4)] {
        let samples = samples(hold, &|_| push(), &no_friction(), 800);
        let mut observer = MomentumObserver::<7>::new(gain);
        observer.start(&samples[0].frame, &samples[0].terms);
        for k in (every..=800).step_by(every) {
            let s = &samples[k];
            let r = *observer.step(&s.frame, &s.terms, &s.tau_motor, DT_S * every as f64);
            let whole = s.terms.jacobian.transpose() * push().to_vector();
            let expected = whole * (1.0 - (-gain * k as f64 * DT_S).exp());
            assert!((r - expected).amax() < 1e-12, "{r} {expected}");
        }
    }
}

/// The same while the arm moves: inertia, Coriolis torque, the change of M and of J leave less than 0.1 % of the step.
#[test]
fn motion_does_not_enter_the_residual() {
    let samples = samples(sway, &|_| push(), &no_friction(), 2000);
    let mut observer = MomentumObserver::<7>::new(50.0);
    observer.start(&samples[0].frame, &samples[0].terms);
    for sample in &samples[1..] {
        observer.step(&sample.frame, &sample.terms, &sample.tau_motor, DT_S);
    }
    let whole = observer.lagged_jacobian().transpose() * push().to_vector();
    let error = (observer.residual_nm() - whole).amax();
    println!("error {error:.1e} of {:.1} Nm", whole.amax());
    assert!(error < 1e-3 * whole.amax(), "{error} of {}", whole.amax());
}

/// NEES over seeds: error that is drawn as stated has mean square 6 in the metric of the stated covariance, whatever
/// its distribution. Torque noise of every sample, and friction of the arcsine law in its band for the whole standstill.
#[test]
fn the_covariance_is_the_mean_square_error() {
    let band = JointBand::coulomb_viscous(0.4, 0.0, 1e-3, 1e-3);
    let samples = samples(hold, &|_| push(), &no_friction(), 300);
    for (joint, torque_sd) in [(band, 0.05), (JointBand::frictionless(1e-3), 0.5)] {
        let band = FrictionBand::new([joint; 7]).unwrap();
        let settings = MomentumSettings {
            torque_sd_nm: Joints::repeat(torque_sd),
            velocity_sd_rad_s: Joints::zeros(),
            ..MomentumSettings::new(band)
        };
        let half = 0.5 * (joint.limits_nm(0.0)[1] - joint.limits_nm(0.0)[0]);
        let seeds = 400;
        let (mut nees, mut covered) = (0.0, 0);
        for seed in 0..seeds {
            let mut rng = Pcg64::seed_from_u64(seed);
            let friction = Joints::from_fn(|_, _| half * rng.random_range(0.0..std::f64::consts::TAU).sin());
            let mut noisy = samples.clone();
            for sample in &mut noisy {
                let noise = Joints::from_fn(|_, _| torque_sd * rng.sample::<f64, _>(StandardNormal));
                sample.tau_motor += friction + noise;
            }
            let estimate = *run(&mut MomentumEstimator::new(settings), &noisy).last().unwrap();
            let error = estimate.wrench_base.to_vector() - push().to_vector();
            nees += error.dot(&estimate.covariance.cholesky().unwrap().solve(&error)) / seeds as f64;
            covered += estimate.interval95().contain(&push()).iter().filter(|&&inside| inside).count();
        }
        let coverage = covered as f64 / (6 * seeds) as f64;
        println!("NEES {nees:.2}, coverage {:.1} %", 100.0 * coverage);
        // Mean of 400 chi-squares of 6: standard deviation √(12/400) = 0.17; four of them.
        assert!((nees - 6.0).abs() < 0.7, "{nees}");
        // Friction is bounded, so it covers a little more than a normal error of the same mean square.
        let most = if half > 0.0 { 0.99 } else { 0.97 };
        assert!((0.93..=most).contains(&coverage), "{coverage}");
    }
}

/// Noise of the velocity passes as momentum: the stated bound is above what is seen, by less than a factor of two.
#[test]
fn velocity_noise_is_bounded() {
    let sd = 3e-3;
    let band = FrictionBand::new([JointBand::frictionless(1e-4); 7]).unwrap();
    let settings = MomentumSettings {
        torque_sd_nm: Joints::repeat(1e-4),
        velocity_sd_rad_s: Joints::repeat(sd),
        ..MomentumSettings::new(band)
    };
    let mut nees = 0.0;
    for seed in 0..200 {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut noisy = samples(hold, &|_| push(), &no_friction(), 200);
        for sample in &mut noisy {
            sample.frame.qd += Joints::from_fn(|_, _| sd * rng.sample::<f64, _>(StandardNormal));
        }
        let estimate = *run(&mut MomentumEstimator::new(settings), &noisy).last().unwrap();
        let error = estimate.wrench_base.to_vector() - push().to_vector();
        nees += error.dot(&estimate.covariance.cholesky().unwrap().solve(&error)) / 200.0;
    }
    println!("NEES with velocity noise {nees:.2}");
    assert!((3.0..=6.7).contains(&nees), "{nees}");
}

/// In a straight arm one moment is lost: its standard deviation tends to the damping and nothing overflows.
#[test]
fn a_singular_pose_is_damped() {
    let band = FrictionBand::new([JointBand::frictionless(0.05); 7]).unwrap();
    let mut estimator = MomentumEstimator::new(MomentumSettings::new(band));
    let arm = tribo_robot::presets::panda();
    let q = Joints::zeros();
    let terms = tribo_robot::ControlTerms::at(&arm, &q, &q);
    let mut sample = samples(hold, &|_| push(), &no_friction(), 1)[1].clone();
    (sample.frame.q, sample.frame.qd, sample.terms, sample.tau_motor) = (q, q, terms, terms.gravity_nm);
    estimator.reset(&sample.frame, &sample.terms);
    let estimate = estimator.step(&sample.input());
    let largest = estimate.covariance.symmetric_eigenvalues().max().sqrt();
    assert!(estimate.fault.is_none() && (largest / 100.0 - 1.0).abs() < 0.01, "{largest} Nm");
    assert!(estimate.wrench_base.to_vector().amax() < 1e-9);
}
