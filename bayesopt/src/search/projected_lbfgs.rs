//! Limited-memory BFGS in a box.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// A box  `lower <= x <= upper`.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
}

impl Bounds {
    /// The unit cube.
    pub fn unit_cube(dimension: usize) -> Self {
        Self { lower: vec![0.0; dimension], upper: vec![1.0; dimension] }
    }

    /// Nearest point of the box, coordinate by coordinate.
    pub fn project(&self, x: &mut [f64]) {
        for (x, (lo, hi)) in x.iter_mut().zip(self.lower.iter().zip(&self.upper)) {
            *x = x.clamp(*lo, *hi);
        }
    }

    /// Coordinate i may move against its gradient without leaving the box.
    fn is_free(&self, i: usize, x: f64, gradient: f64) -> bool {
        (x > self.lower[i] || gradient < 0.0) && (x < self.upper[i] || gradient > 0.0)
    }
}

/// Tolerances of one descent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Descent {
    /// Most iterations.
    pub iterations: usize,
    /// Stop when the largest free gradient entry is below this.
    pub gradient_tolerance: f64,
    /// Stop when an iteration gains less than this, relative to 1 + |value|.
    pub value_tolerance: f64,
    /// Euclidean length of the first step.
    pub first_step: f64,
    /// Curvature pairs kept. Default 10, as in L-BFGS-B.
    pub memory: usize,
}

impl Default for Descent {
    fn default() -> Self {
        Self { iterations: 100, gradient_tolerance: 1e-6, value_tolerance: 1e-10, first_step: 1.0, memory: 10 }
    }
}

/// How a descent ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DescentEnd {
    /// The projected gradient is below its tolerance.
    Converged,
    /// An iteration gained less than the value tolerance.
    Stalled,
    /// The iterations are spent.
    BudgetSpent,
    /// The function is not finite where the descent began.
    NotFinite,
}

/// The best point found.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// Where.
    pub point: Vec<f64>,
    /// Function value there.
    pub value: f64,
    /// Why the descent stopped.
    pub end: DescentEnd,
}

/// Sufficient decrease of the Armijo rule (nocedal2006, §3.1).
const ARMIJO: f64 = 1e-4;
/// Most halvings of one step.
const BACKTRACKS: usize = 25;

/// `x ← P(x + t d)`, d the L-BFGS direction of the coordinates not held by a bound, t by Armijo backtracking.
///
/// Projected quasi-Newton (bertsekas1982; nocedal2006, algorithm 7.4 for d). Chosen over
/// a smooth box transform because optima of friction compensation lie *on* the box, where a
/// transform has zero slope or infinite coordinates (`benches/descent.rs` measures it); and over the line searches of argmin 0.11,
/// which know no bounds and end in an error at the first non-finite value — here that is a rejected step.
/// `function(x, gradient)` writes the gradient and returns the value.
pub fn minimise(
    function: impl FnMut(&[f64], &mut [f64]) -> f64,
    start: &[f64],
    bounds: &Bounds,
    descent: &Descent,
) -> Minimum {
    minimise_with(function, start, bounds, descent, &mut Curvature::default())
}

/// [`minimise`] that begins with the curvature of an earlier descent on a similar function, and leaves its own.
pub fn minimise_with(
    mut function: impl FnMut(&[f64], &mut [f64]) -> f64,
    start: &[f64],
    bounds: &Bounds,
    descent: &Descent,
    curvature: &mut Curvature,
) -> Minimum {
    let pairs = &mut curvature.pairs;
    let dimension = start.len();
    let mut x = start.to_vec();
    bounds.project(&mut x);
    let mut gradient = vec![0.0; dimension];
    let mut value = function(&x, &mut gradient);
    if !value.is_finite() {
        return Minimum { point: x, value, end: DescentEnd::NotFinite };
    }

    for _ in 0..descent.iterations {
        // Coordinates held by a bound leave the problem.
        let free: Vec<bool> = (0..dimension).map(|i| bounds.is_free(i, x[i], gradient[i])).collect();
        let steepest: Vec<f64> = (0..dimension).map(|i| if free[i] { -gradient[i] } else { 0.0 }).collect();
        if steepest.iter().all(|g| g.abs() < descent.gradient_tolerance) {
            return Minimum { point: x, value, end: DescentEnd::Converged };
        }

        // Quasi-Newton direction, or steepest descent where it does not descend.
        let mut direction = two_loop(pairs, &steepest, &free);
        if pairs.is_empty() || dot(&direction, &steepest) <= 0.0 {
            pairs.clear();
            let length = dot(&steepest, &steepest).sqrt();
            direction = steepest.iter().map(|g| g * descent.first_step / length).collect();
        }

        // Backtrack along the projected arc.
        let Some(step) = backtrack(&mut function, &x, value, &gradient, &direction, bounds) else {
            if pairs.is_empty() {
                return Minimum { point: x, value, end: DescentEnd::Stalled };
            }
            pairs.clear();
            continue;
        };
        let gain = value - step.value;

        // Keep the curvature where it is positive.
        let s: Vec<f64> = step.x.iter().zip(&x).map(|(a, b)| a - b).collect();
        let y: Vec<f64> = step.gradient.iter().zip(&gradient).map(|(a, b)| a - b).collect();
        if dot(&s, &y) > 1e-12 * dot(&y, &y) {
            while pairs.len() >= descent.memory.max(1) {
                pairs.pop_front();
            }
            pairs.push_back(Pair { s, y });
        }
        (x, value, gradient) = (step.x, step.value, step.gradient);
        if gain <= descent.value_tolerance * (1.0 + value.abs()) {
            return Minimum { point: x, value, end: DescentEnd::Stalled };
        }
    }
    Minimum { point: x, value, end: DescentEnd::BudgetSpent }
}

/// What a descent has learnt of the second derivatives: its last steps and the changes of the gradient along them.
#[derive(Debug, Clone, Default)]
pub struct Curvature {
    pairs: VecDeque<Pair>,
}

#[derive(Debug, Clone)]
struct Pair {
    s: Vec<f64>,
    y: Vec<f64>,
}

struct Step {
    x: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
}

/// H·(−g) on the free coordinates by the two-loop recursion.
fn two_loop(pairs: &VecDeque<Pair>, steepest: &[f64], free: &[bool]) -> Vec<f64> {
    let masked_dot = |a: &[f64], b: &[f64]| (0..a.len()).filter(|&i| free[i]).map(|i| a[i] * b[i]).sum::<f64>();
    let mut direction = steepest.to_vec();
    let mut undo = Vec::with_capacity(pairs.len());
    let mut gamma = None;
    for pair in pairs.iter().rev() {
        let curvature = masked_dot(&pair.s, &pair.y);
        if curvature <= 0.0 {
            continue;
        }
        gamma.get_or_insert_with(|| curvature / masked_dot(&pair.y, &pair.y));
        let alpha = masked_dot(&pair.s, &direction) / curvature;
        add_free(&mut direction, -alpha, &pair.y, free);
        undo.push((pair, alpha, curvature));
    }
    let gamma = gamma.unwrap_or(1.0);
    direction.iter_mut().for_each(|d| *d *= gamma);
    for (pair, alpha, curvature) in undo.into_iter().rev() {
        let beta = masked_dot(&pair.y, &direction) / curvature;
        add_free(&mut direction, alpha - beta, &pair.s, free);
    }
    direction
}

fn backtrack(
    function: &mut impl FnMut(&[f64], &mut [f64]) -> f64,
    x: &[f64],
    value: f64,
    gradient: &[f64],
    direction: &[f64],
    bounds: &Bounds,
) -> Option<Step> {
    let mut t = 1.0;
    let mut trial_gradient = vec![0.0; x.len()];
    for _ in 0..BACKTRACKS {
        let mut trial: Vec<f64> = x.iter().zip(direction).map(|(x, d)| x + t * d).collect();
        bounds.project(&mut trial);
        let predicted: f64 = (0..x.len()).map(|i| gradient[i] * (trial[i] - x[i])).sum();
        if predicted >= 0.0 {
            return None;
        }
        let trial_value = function(&trial, &mut trial_gradient);
        if trial_value.is_finite() && trial_value <= value + ARMIJO * predicted {
            return Some(Step { x: trial, value: trial_value, gradient: trial_gradient });
        }
        // Minimum of the parabola through value, slope and trial value, kept inside [0.1, 0.5] of the step.
        let shrink = -0.5 * predicted / (trial_value - value - predicted);
        t *= if shrink.is_finite() { shrink.clamp(0.1, 0.5) } else { 0.1 };
    }
    None
}

fn add_free(target: &mut [f64], factor: f64, by: &[f64], free: &[bool]) {
    for i in 0..target.len() {
        if free[i] {
            target[i] += factor * by[i];
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rosenbrock(x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        let mut value = 0.0;
        for i in 0..x.len() - 1 {
            let (valley, offset) = (x[i + 1] - x[i] * x[i], 1.0 - x[i]);
            value += 100.0 * valley * valley + offset * offset;
            gradient[i] += -400.0 * x[i] * valley - 2.0 * offset;
            gradient[i + 1] += 200.0 * valley;
        }
        value
    }

    fn precise() -> Descent {
        Descent { iterations: 500, gradient_tolerance: 1e-8, value_tolerance: 0.0, ..Descent::default() }
    }

    #[test]
    fn free_minimum_of_the_rosenbrock_valley() {
        let bounds = Bounds { lower: vec![-5.0; 6], upper: vec![5.0; 6] };
        let found = minimise(rosenbrock, &[-1.2; 6], &bounds, &precise());
        assert!(found.value < 1e-10 || (found.value - 3.97394).abs() < 1e-4, "{found:?}");
        let found =
            minimise(rosenbrock, &[-1.2, 1.0], &Bounds { lower: vec![-5.0; 2], upper: vec![5.0; 2] }, &precise());
        assert!(found.value < 1e-12 && found.end == DescentEnd::Converged, "{found:?}");
    }

    #[test]
    fn minimum_on_the_bound() {
        // Hock & Schittkowski problem 1 turned: upper bound 0.5 on x0 gives (0.5, 0.25), value 0.25.
        let bounds = Bounds { lower: vec![-5.0; 2], upper: vec![0.5, 5.0] };
        let found = minimise(rosenbrock, &[-2.0, 4.0], &bounds, &precise());
        assert!((found.point[0] - 0.5).abs() < 1e-9 && (found.point[1] - 0.25).abs() < 1e-8, "{found:?}");
        assert_eq!(found.end, DescentEnd::Converged);
    }

    #[test]
    fn a_start_in_a_corner_can_leave_it_and_walls_of_infinity_are_steps_refused() {
        let bowl = |x: &[f64], g: &mut [f64]| {
            g[0] = 2.0 * (x[0] - 0.3);
            if x[0] > 0.8 { f64::INFINITY } else { (x[0] - 0.3).powi(2) }
        };
        let bounds = Bounds::unit_cube(1);
        let found = minimise(bowl, &[0.0], &bounds, &Descent::default());
        assert!((found.point[0] - 0.3).abs() < 1e-5, "{found:?}");
        assert_eq!(minimise(bowl, &[0.9], &bounds, &Descent::default()).end, DescentEnd::NotFinite);
    }
}
