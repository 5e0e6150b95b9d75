//! Least squares with bounds.

use nalgebra::SMatrix;

use super::temperature_path::{PARAMETERS, Parameters};

pub(super) type Information = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// Cost, minus half of its gradient, and half of its Gauss-Newton Hessian at one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expansion {
    pub cost: f64,
    pub score: Parameters,
    pub information: Information,
}

/// Levenberg and Marquardt (levenberg1944, marquardt1963) with Nielsen's damping (nielsen1999), steps clipped to the box; parameters that are not `free`
/// stay. Returns the minimiser and its expansion.
pub(super) fn minimise(
    start: Parameters,
    free: &[bool; PARAMETERS],
    bounds: &[[f64; 2]; PARAMETERS],
    mut expand: impl FnMut(&Parameters) -> Expansion,
    iterations: usize,
) -> (Parameters, Expansion) {
    let mut at = start;
    let mut here = expand(&at);
    let (mut damping, mut growth) = (1e-3, 2.0);
    for _ in 0..iterations {
        let mut a = here.information;
        let mut b = here.score;
        for i in 0..PARAMETERS {
            let outwards = (at[i] <= bounds[i][0] && b[i] < 0.0) || (at[i] >= bounds[i][1] && b[i] > 0.0);
            if !free[i] || outwards {
                a.row_mut(i).fill(0.0);
                a.column_mut(i).fill(0.0);
                (a[(i, i)], b[i]) = (1.0, 0.0);
            } else {
                a[(i, i)] += damping * a[(i, i)].max(f64::MIN_POSITIVE);
            }
        }
        let scale = Parameters::from_fn(|i, _| a[(i, i)].sqrt());
        let scaled = Information::from_fn(|i, j| a[(i, j)] / (scale[i] * scale[j]));
        let step = scaled.cholesky().map(|factor| factor.solve(&b.component_div(&scale)).component_div(&scale));
        let Some(step) = step.filter(|step| step.iter().all(|x| x.is_finite())) else {
            damping *= growth;
            growth *= 2.0;
            continue;
        };
        let next = Parameters::from_fn(|i, _| (at[i] + step[i]).clamp(bounds[i][0], bounds[i][1]));
        let step = next - at;
        let expected = 2.0 * step.dot(&here.score) - step.dot(&(here.information * step));
        let there = expand(&next);
        if there.cost.is_finite() && there.cost < here.cost {
            let gained = here.cost - there.cost;
            let ratio = gained / expected.max(f64::MIN_POSITIVE);
            damping = (damping * (1.0 - (2.0 * ratio - 1.0).powi(3)).max(1.0 / 3.0)).max(1e-14);
            growth = 2.0;
            (at, here) = (next, there);
            if gained < 1e-10 * here.cost.abs() && expected < 1e-6 {
                break;
            }
        } else {
            damping *= growth;
            growth *= 2.0;
            if expected < 1e-9 * here.cost.abs().max(1.0) || damping > 1e12 {
                break;
            }
        }
    }
    (at, here)
}
