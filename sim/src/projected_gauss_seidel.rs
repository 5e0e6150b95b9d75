//! The friction impulse of one step.

use nalgebra::{SMatrix, SVector};
use tribo_robot::product;

/// Most sweeps spent on one step.
const MAX_SWEEPS: usize = 60;
/// Change of a joint velocity [rad/s] below which a sweep counts as converged.
const TOLERANCE_RAD_S: f64 = 1e-12;

/// Finds the friction impulse p and the velocity `v = A (b − p)` with
///
/// ```text
/// lower_i ≤ p_i ≤ upper_i,   v_i > 0 ⇒ p_i = upper_i,   v_i < 0 ⇒ p_i = lower_i
/// ```
///
/// by projected Gauss–Seidel, `p_i ← clamp(p_i + v_i/A_ii)`. A [rad²/(kg m²)…] is symmetric positive definite,
/// b (`momentum`) and impulses in Nm s. `p` enters as a warm start and leaves as the solution; a joint strictly inside its bounds is
/// stuck and gets the velocity 0 exactly. Returns v [rad/s].
#[inline]
pub(crate) fn solve_friction<const N: usize>(
    a: &SMatrix<f64, N, N>,
    momentum: &SVector<f64, N>,
    lower: &SVector<f64, N>,
    upper: &SVector<f64, N>,
    p: &mut SVector<f64, N>,
) -> SVector<f64, N> {
    for i in 0..N {
        p[i] = within(p[i], lower[i], upper[i]);
    }
    let mut v = product(a, &(momentum - *p));
    // What each joint weighs when the others are free; divided by once, not in every sweep.
    let inertia = a.diagonal().map(|mobility| 1.0 / mobility);
    for _ in 0..MAX_SWEEPS {
        let mut largest = 0.0_f64;
        for i in 0..N {
            // A joint that slides on, as nearly every one does nearly always, stays at its bound: no step.
            let moved = within(p[i] + v[i] * inertia[i], lower[i], upper[i]);
            let step = moved - p[i];
            if step != 0.0 {
                p[i] = moved;
                v.axpy(-step, &a.column(i), 1.0);
                largest = largest.max((step * a[(i, i)]).abs());
            }
        }
        if largest < TOLERANCE_RAD_S {
            break;
        }
    }
    for i in 0..N {
        if p[i] > lower[i] && p[i] < upper[i] {
            v[i] = 0.0;
        }
    }
    v
}

/// x, or the bound that it is beyond: an instruction for each, as NaN need not be told from a number. `clamp` would panic where the
/// bounds are NaN.
#[inline]
fn within(x: f64, lower: f64, upper: f64) -> f64 {
    let above = if x > lower { x } else { lower };
    if above < upper { above } else { upper }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form, one joint: v = max(|v_free| − A F, 0) sign(v_free).
    #[test]
    fn one_joint_is_soft_thresholding() {
        let a = SMatrix::<f64, 1, 1>::new(2.0);
        for v_free in [-3.0, -0.5, 0.0, 0.7, 5.0_f64] {
            let bound = SVector::<f64, 1>::new(0.6);
            let mut p = SVector::zeros();
            let v = solve_friction(&a, &SVector::from([v_free / 2.0]), &-bound, &bound, &mut p);
            let expected = (v_free.abs() - 1.2).max(0.0) * v_free.signum();
            assert!((v[0] - expected).abs() < 1e-12);
        }
    }

    /// The complementarity conditions identify the solution whatever the coupling and the warm start.
    #[test]
    fn coupled_joints_satisfy_complementarity() {
        let root = SMatrix::<f64, 7, 7>::from_fn(|r, c| ((r * 7 + c) as f64 * 1.3).sin());
        let a = root * root.transpose() + SMatrix::identity() * 2.0;
        let upper = SVector::<f64, 7>::from_fn(|i, _| 0.1 + 0.02 * i as f64);
        let lower = upper * -0.7;
        for k in 0..100 {
            let b = SVector::<f64, 7>::from_fn(|i, _| 0.3 * (k as f64 + i as f64 * 2.1).sin());
            let mut p = SVector::<f64, 7>::from_fn(|i, _| (k as f64 * 3.1 + i as f64).cos());
            let v = solve_friction(&a, &b, &lower, &upper, &mut p);
            assert!((a * (b - p) - v).amax() < 1e-10);
            for i in 0..7 {
                assert!(p[i] >= lower[i] && p[i] <= upper[i]);
                assert!(v[i] <= 1e-10 || p[i] == upper[i]);
                assert!(v[i] >= -1e-10 || p[i] == lower[i]);
            }
        }
    }
}
