//! How often the 95 % limits of the friction-band estimate hold the truth.
//!
//! Truths are drawn from the model itself: wrench from the prior, friction uniform in its band, normal noise, at random
//! poses of a Panda. A sliding arm is the Gaussian case, where the limits are exact. Where joints stick they are
//! approximate: each limit pushes all friction to one side, so they are wide, as the paper finds too.

use crate::common::reference_stream::ReferenceStream;
use nalgebra::{SMatrix, SVector};
use tribo_friction::JointBand;
use tribo_residual::{ForceProblem, ForceSolver, diagonal_prior};
use tribo_robot::{Kinematics, LAMBDA_95, presets};

/// Draws per case; the binomial standard deviation of six components is then at least 0.09 %, if they were independent.
const DRAWS: usize = 10_000;
const FORCE_SD_N: f64 = 10.0;
const MOMENT_SD_NM: f64 = 1.0;

struct Coverage {
    share: f64,
    half_width_n: f64,
    rmse_n: f64,
}

/// Of arms whose joints each stick with probability `sticking`.
fn coverage(sticking: f64, seed: u64) -> Coverage {
    let arm = presets::panda();
    let coulomb = [1.2, 1.2, 1.0, 1.0, 0.6, 0.5, 0.4];
    let mut stream = ReferenceStream::new(seed);
    let mut solver = ForceSolver::<7, 6>::new(diagonal_prior(FORCE_SD_N, MOMENT_SD_NM));
    let (mut inside, mut width, mut square) = (0, 0.0, 0.0);
    for _ in 0..DRAWS {
        let q = SVector::<f64, 7>::from_fn(|j, _| stream.range(arm.limits.q_min_rad[j], arm.limits.q_max_rad[j]));
        let jacobian: SMatrix<f64, 6, 7> = Kinematics::at(&arm, &q).jacobian();
        let sd = |r: usize| if r < 3 { MOMENT_SD_NM } else { FORCE_SD_N };
        let wrench = SVector::<f64, 6>::from_fn(|r, _| sd(r) * stream.normal());
        let (mut lower, mut upper, mut torque) = (SVector::zeros(), SVector::zeros(), jacobian.transpose() * wrench);
        for j in 0..7 {
            let band = JointBand::coulomb_viscous(coulomb[j], 1.0, 3e-3, 0.1);
            let speed = if stream.u() < sticking { 0.0 } else { stream.range(0.1, 1.0) };
            [lower[j], upper[j]] = band.limits_nm(speed);
            torque[j] += stream.range(lower[j], upper[j]) + 0.1 * stream.normal();
        }
        let problem = ForceProblem { torque, jacobian, lower, upper, covariance: SMatrix::identity() * 0.01 };
        let estimate = solver.estimate(&problem).expect("a solvable programme");
        square += (estimate.force - wrench).fixed_rows::<3>(3).norm_squared() / (3 * DRAWS) as f64;
        for axis in 0..6 {
            let v = SVector::<f64, 6>::from_fn(|r, _| f64::from(u8::from(r == axis)));
            let above = solver.limit(&v, LAMBDA_95).expect("a limit").value;
            let below = -solver.limit(&-v, LAMBDA_95).expect("a limit").value;
            assert!(below <= estimate.force[axis] + 1e-9 && estimate.force[axis] <= above + 1e-9);
            inside += usize::from(below <= wrench[axis] && wrench[axis] <= above);
            if axis >= 3 {
                width += 0.5 * (above - below) / (3 * DRAWS) as f64;
            }
        }
    }
    let share = inside as f64 / (6 * DRAWS) as f64;
    let result = Coverage { share, half_width_n: width, rmse_n: square.sqrt() };
    println!(
        "sticking {sticking}: coverage {:.2} %, half width {:.2} N, RMSE {:.2} N",
        100.0 * share,
        result.half_width_n,
        result.rmse_n
    );
    result
}

/// 95 % within four standard deviations of six components that may be fully dependent.
#[test]
fn limits_of_a_sliding_arm_are_exact() {
    let sliding = coverage(0.0, 1);
    assert!((sliding.share - 0.95).abs() < 4.0 * (0.95_f64 * 0.05 / DRAWS as f64).sqrt());
}

#[test]
fn limits_of_a_sticking_arm_are_wide_rather_than_wrong() {
    let (some, all) = (coverage(0.5, 2), coverage(1.0, 3));
    assert!(some.share > 0.95 && all.share > 0.95);
    // No wider than the prior alone would allow, and wider than what is known when sliding.
    assert!(all.half_width_n < LAMBDA_95 * FORCE_SD_N && some.half_width_n < all.half_width_n);
}
