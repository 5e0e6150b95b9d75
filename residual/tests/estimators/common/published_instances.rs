//! The published benchmark of force estimation: random poses, velocities, friction and forces of a Panda.

use nalgebra::{SMatrix, SVector};
use tribo_residual::{ForcePrior, ForceProblem};
use tribo_robot::{Kinematics, presets};

use super::reference_stream::ReferenceStream;

/// A force, then a moment.
pub type Vector6 = SVector<f64, 6>;

/// Standard deviations of a limit.
pub const LAMBDA: f64 = 1.96;

/// Small contact moments are expected: 10 N, 0.1 Nm.
pub fn prior() -> ForcePrior<6> {
    let sd = Vector6::new(10.0, 10.0, 10.0, 0.1, 0.1, 0.1);
    ForcePrior { mean: Vector6::zeros(), covariance: SMatrix::from_diagonal(&sd.component_mul(&sd)) }
}

/// Instance k of 1000.
pub fn instance(k: u64) -> ForceProblem<7, 6> {
    let (arm, mut s) = (presets::panda(), ReferenceStream::new(5000 + k));
    let limits = &arm.limits;
    let mut q = SVector::<f64, 7>::zeros();
    for i in 0..7 {
        q[i] = s.range(limits.q_min_rad[i], limits.q_max_rad[i]);
    }
    let mode = (3.0 * s.u()).floor() as u32;
    let mut qd = SVector::<f64, 7>::zeros();
    for i in 0..7 {
        let slow = match mode {
            0 => true,
            1 => false,
            _ => s.u() < 0.5,
        };
        qd[i] = s.range(-1.0, 1.0) * if slow { 0.02 } else { 0.5 * limits.qd_max_rad_s[i] };
    }
    let mut force = Vector6::zeros();
    for (i, scale) in [6.0, 6.0, 6.0, 0.1, 0.1, 0.1].into_iter().enumerate() {
        force[i] = scale * s.normal();
    }
    let coulomb = [1.2, 1.2, 1.0, 1.0, 0.6, 0.5, 0.4];
    let viscous = [0.9, 0.9, 0.7, 0.7, 0.4, 0.35, 0.3];
    let noise = [0.25, 0.25, 0.2, 0.2, 0.12, 0.1, 0.08];
    let bound = |i: usize, side: f64| {
        -coulomb[i] + 2.0 * coulomb[i] / (1.0 + (-60.0 * (qd[i] + side * 0.05)).exp()) + viscous[i] * qd[i]
    };
    let (lower, upper) = (SVector::from_fn(|i, _| bound(i, -1.0)), SVector::from_fn(|i, _| bound(i, 1.0)));
    let sd = SVector::<f64, 7>::from_fn(|i, _| noise[i] * (1.0 + 5.0 * qd[i].abs()));
    let angular_first = Kinematics::at(&arm, &q).jacobian();
    let jacobian = SMatrix::<f64, 6, 7>::from_fn(|r, c| angular_first[((r + 3) % 6, c)]);
    let mut torque = jacobian.transpose() * force;
    for i in 0..7 {
        torque[i] += s.range(lower[i], upper[i]);
    }
    for i in 0..7 {
        torque[i] += sd[i] * s.normal();
    }
    ForceProblem { torque, jacobian, lower, upper, covariance: SMatrix::from_diagonal(&sd.component_mul(&sd)) }
}
