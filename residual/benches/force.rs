//! Time of one estimate with its twelve limits: `cargo bench -p tribo-residual --bench force`.
//!
//! The thousand published instances of the tests, as other solvers are measured on them: each after an unrelated one
//! (cold), and each again after itself (warm). Then two of them stacked to fourteen joints. Prints percentiles (µs) over
//! all instances of the least of five runs, so that what the computer does besides does not count; at the end, of whole
//! ticks of the estimators on an arm that sways and stops, one run.

#[path = "../tests/estimators/common/mod.rs"]
mod common;

use std::time::Instant;

use common::prescribed::{samples, sway};
use common::published_instances::{LAMBDA, instance, prior};
use nalgebra::{SMatrix, SVector};
use tribo_friction::law::CoulombViscous;
use tribo_friction::{BandError, FrictionBand, FrictionModel, JointBand};
use tribo_residual::{ForceProblem, ForceSolver, MomentumEstimator, MomentumSettings, QpEstimator, QpSettings};
use tribo_robot::{Wrench, WrenchEstimator};

/// Instances.
const COUNT: u64 = 1000;
/// Runs of which the least counts.
const RUNS: usize = 5;

/// Estimate and limits; the sum, so that nothing is optimised away.
fn solve<const N: usize>(solver: &mut ForceSolver<N, 6>, problem: &ForceProblem<N, 6>, limits: bool) -> f64 {
    let mut sum = solver.estimate(problem).map_or(f64::NAN, |estimate| estimate.force[0]);
    for i in 0..if limits { 12 } else { 0 } {
        let v = SVector::<f64, 6>::from_fn(|r, _| if r != i / 2 { 0.0 } else { 1.0 - 2.0 * (i % 2) as f64 });
        sum += solver.limit(&v, LAMBDA).map_or(f64::NAN, |limit| limit.value);
    }
    sum
}

fn time<const N: usize>(label: &str, problems: &[ForceProblem<N, 6>], warm: bool, limits: bool) {
    let mut micros = vec![f64::INFINITY; problems.len()];
    for _ in 0..RUNS {
        let mut solver = ForceSolver::<N, 6>::new(prior());
        for (least, problem) in micros.iter_mut().zip(problems) {
            if warm {
                std::hint::black_box(solve(&mut solver, problem, limits));
            }
            let start = Instant::now();
            std::hint::black_box(solve(&mut solver, std::hint::black_box(problem), limits));
            *least = least.min(start.elapsed().as_secs_f64() * 1e6);
        }
    }
    show(label, &mut micros);
}

/// Two arms that push against each other.
fn stacked(a: &ForceProblem<7, 6>, b: &ForceProblem<7, 6>) -> ForceProblem<14, 6> {
    let join = |x: &SVector<f64, 7>, y: &SVector<f64, 7>| SVector::from_fn(|i, _| if i < 7 { x[i] } else { y[i - 7] });
    ForceProblem {
        torque: join(&a.torque, &b.torque),
        jacobian: SMatrix::from_fn(|r, c| if c < 7 { a.jacobian[(r, c)] } else { -b.jacobian[(r, c - 7)] }),
        lower: join(&a.lower, &b.lower),
        upper: join(&a.upper, &b.upper),
        covariance: SMatrix::from_diagonal(&join(&a.covariance.diagonal(), &b.covariance.diagonal())),
    }
}

/// Active sets tried per instance by the twelve limits: mean and most.
fn pivots(problems: &[ForceProblem<7, 6>]) {
    let mut solver = ForceSolver::<7, 6>::new(prior());
    let count = |problem| {
        let _ = solver.estimate(problem);
        let one =
            |i: usize| SVector::<f64, 6>::from_fn(|r, _| if r != i / 2 { 0.0 } else { 1.0 - 2.0 * (i % 2) as f64 });
        (0..12).filter_map(|i| solver.limit(&one(i), LAMBDA).ok()).map(|limit| limit.pivots).sum::<u32>()
    };
    let counts: Vec<u32> = problems.iter().map(count).collect();
    let mean = f64::from(counts.iter().sum::<u32>()) / counts.len() as f64;
    println!("active sets per twelve limits: mean {mean:.1}, most {}", counts.iter().max().unwrap_or(&0));
}

/// Whole ticks: observer, band, estimate, limits.
fn ticks<E: WrenchEstimator<7>>(label: &str, mut estimator: E) {
    let friction = FrictionModel::uniform(CoulombViscous { coulomb_nm: 0.5, viscous_nm_s_per_rad: 0.8 }.into());
    let push = |_| Wrench::from_force_moment(&[5.0, -3.0, 8.0, 0.2, 0.1, -0.3]);
    let samples = samples(sway, &push, &friction, 5000);
    estimator.reset(&samples[0].frame, &samples[0].terms);
    let mut micros: Vec<f64> = Vec::with_capacity(samples.len());
    for sample in &samples[1..] {
        let input = sample.input();
        let start = Instant::now();
        std::hint::black_box(estimator.step(std::hint::black_box(&input)));
        micros.push(start.elapsed().as_secs_f64() * 1e6);
    }
    show(label, &mut micros);
}

fn show(label: &str, micros: &mut [f64]) {
    micros.sort_by(f64::total_cmp);
    let at = |share: f64| micros[((micros.len() - 1) as f64 * share) as usize];
    println!("{label:32} p50 {:6.2}  p99 {:6.2}  max {:6.2} us", at(0.5), at(0.99), at(1.0));
}

fn main() -> Result<(), BandError> {
    let one: Vec<_> = (0..COUNT).map(instance).collect();
    let two: Vec<_> = one.windows(2).map(|pair| stacked(&pair[0], &pair[1])).collect();
    pivots(&one);
    time("7 joints, estimate, cold", &one, false, false);
    time("7 joints, estimate, warm", &one, true, false);
    time("7 joints, with limits, cold", &one, false, true);
    time("7 joints, with limits, warm", &one, true, true);
    time("14 joints, with limits, cold", &two, false, true);

    let band = FrictionBand::new([JointBand::coulomb_viscous(0.5, 0.8, 3e-3, 0.1); 7])?;
    ticks("tick, momentum", MomentumEstimator::new(MomentumSettings::new(band)));
    ticks("tick, band without limits", QpEstimator::new(QpSettings { limits: false, ..QpSettings::new(band) }));
    ticks("tick, band with limits", QpEstimator::new(QpSettings::new(band)));
    Ok(())
}
