//! Time of one estimate with its twelve limits: `cargo run --release -p tribo-residual --example timing`.
//!
//! A thousand random states of a Panda, in three orders of difficulty: an unrelated one before each (cold), the same one
//! before it (warm), and seven joints more (two arms). Prints p50, p99 and max (µs).

use std::time::Instant;

use nalgebra::{SMatrix, SVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use tribo_residual::{ForceProblem, ForceSolver, diagonal_prior};

/// Problems timed.
const COUNT: usize = 20_000;

fn problem<const N: usize>(rng: &mut Pcg64) -> ForceProblem<N, 6> {
    let mut uniform = |a: f64, b: f64| rng.random_range(a..b);
    let sticks: [bool; N] = std::array::from_fn(|_| uniform(0.0, 1.0) < 0.5);
    let jacobian = SMatrix::<f64, 6, N>::from_fn(|r, _| uniform(-1.0, 1.0) * if r < 3 { 1.0 } else { 0.7 });
    let half = SVector::<f64, N>::from_fn(|j, _| if sticks[j] { uniform(0.3, 1.2) } else { 0.0 });
    let middle = SVector::<f64, N>::from_fn(|j, _| if sticks[j] { 0.0 } else { uniform(-1.0, 1.0) });
    let force = SVector::<f64, 6>::from_fn(|r, _| uniform(-1.0, 1.0) * if r < 3 { 0.5 } else { 15.0 });
    let friction = SVector::<f64, N>::from_fn(|j, _| middle[j] + half[j] * uniform(-1.0, 1.0));
    ForceProblem {
        torque: jacobian.transpose() * force + friction,
        jacobian,
        lower: middle - half,
        upper: middle + half,
        variance: SVector::repeat(0.02),
    }
}

fn solve<const N: usize>(solver: &mut ForceSolver<N, 6>, problem: &ForceProblem<N, 6>) -> f64 {
    let mut sum = solver.estimate(problem).map_or(f64::NAN, |estimate| estimate.force[0]);
    for i in 0..12 {
        let v = SVector::<f64, 6>::from_fn(|r, _| if r != i / 2 { 0.0 } else { 1.0 - 2.0 * (i % 2) as f64 });
        sum += solver.limit(&v, 1.96).map_or(f64::NAN, |limit| limit.value);
    }
    sum
}

fn time<const N: usize>(label: &str, warm: bool) {
    let mut rng = Pcg64::seed_from_u64(1);
    let mut solver = ForceSolver::<N, 6>::new(diagonal_prior(10.0, 1.0));
    let mut micros: Vec<f64> = (0..COUNT)
        .map(|_| {
            let problem = problem::<N>(&mut rng);
            if warm {
                std::hint::black_box(solve(&mut solver, &problem));
            }
            let start = Instant::now();
            std::hint::black_box(solve(&mut solver, std::hint::black_box(&problem)));
            start.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    micros.sort_by(f64::total_cmp);
    let at = |share: f64| micros[((COUNT - 1) as f64 * share) as usize];
    println!("{label:24} p50 {:6.2}  p99 {:6.2}  max {:8.2} us", at(0.5), at(0.99), at(1.0));
}

fn main() {
    time::<7>("7 joints, cold", false);
    time::<7>("7 joints, warm", true);
    time::<14>("14 joints, cold", false);
}
