//! Convex quadratic programme with simple bounds.

use nalgebra::{DMatrix, DVector};

/// The minimiser and how it was reached.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxLeastSquares {
    /// The minimiser.
    pub x: DVector<f64>,
    /// Sweeps used.
    pub sweeps: usize,
    /// Largest last change of a coordinate, relative to its scale.
    pub last_change: f64,
}

/// Minimises `½ xᵀ H x − bᵀ x` over `lower ≤ x ≤ upper`, H symmetric positive definite (n×n).
///
/// Coordinate descent from the projected unconstrained minimiser; each coordinate is solved exactly, so for strictly
/// convex problems the limit is the unique solution (luo1992). Meant for n ≲ 50, off the tick.
pub fn minimize_in_box(h: &DMatrix<f64>, b: &DVector<f64>, lower: &[f64], upper: &[f64]) -> BoxLeastSquares {
    const SWEEPS: usize = 20_000;
    const TOLERANCE: f64 = 1e-12;
    let n = b.len();
    let start = h.clone().cholesky().map_or_else(|| DVector::zeros(n), |factor| factor.solve(b));
    let mut x = DVector::from_fn(n, |i, _| start[i].clamp(lower[i], upper[i]));
    let mut gradient = h * &x - b;
    let mut last_change = f64::INFINITY;
    let mut sweeps = 0;
    while sweeps < SWEEPS && last_change > TOLERANCE {
        last_change = 0.0;
        for i in 0..n {
            if h[(i, i)] <= 0.0 {
                continue;
            }
            let moved = (x[i] - gradient[i] / h[(i, i)]).clamp(lower[i], upper[i]);
            let step = moved - x[i];
            if step != 0.0 {
                x[i] = moved;
                gradient.axpy(step, &h.column(i), 1.0);
                last_change = f64::max(last_change, step.abs() / moved.abs().max(1.0));
            }
        }
        sweeps += 1;
    }
    BoxLeastSquares { x, sweeps, last_change }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Witness: the KKT conditions, which hold at the minimiser only.
    #[test]
    fn solution_satisfies_kkt() {
        for seed in 0..50_u64 {
            let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1;
            let mut draw = || {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
            };
            let n = 9;
            let root = DMatrix::from_fn(n, n, |_, _| draw());
            let h = &root * root.transpose() + DMatrix::identity(n, n) * 1e-3;
            let b = DVector::from_fn(n, |_, _| draw());
            let (lower, upper) = (vec![-0.3; n], vec![0.4; n]);
            let solution = minimize_in_box(&h, &b, &lower, &upper);
            let gradient = &h * &solution.x - &b;
            for i in 0..n {
                let x = solution.x[i];
                assert!((lower[i]..=upper[i]).contains(&x));
                if x > lower[i] && x < upper[i] {
                    assert!(gradient[i].abs() < 1e-8, "seed {seed}: {}", gradient[i]);
                } else {
                    assert!(gradient[i] * if x == lower[i] { 1.0 } else { -1.0 } > -1e-9);
                }
            }
        }
    }
}
