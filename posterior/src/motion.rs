//! How fast a sample is, next to the motion that a model was fitted to.
//!
//! ```text
//! m(t) = mean over joints of ½ q̇_j²/⟨q̇_j²⟩ + ½ q̈_j²/⟨q̈_j²⟩
//! ```
//!
//! Friction that bends, couplings and timing are wrong by more where an arm is faster: what a model leaves grows with m.

use crate::joint_term::JointTerm;
use crate::problem::Problem;

/// Mean squares of speed and acceleration of each joint (rad²/s², rad²/s⁴), 0 where it does not move.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    squares: Vec<[f64; 2]>,
}

/// Speed and acceleration.
const TERMS: [JointTerm; 2] = [JointTerm::Viscous, JointTerm::Rotor];

impl Motion {
    /// The motion of some parts.
    pub fn of(problem: &Problem, parts: &[usize]) -> Self {
        let mean_square = |joint: usize, term| {
            let values = problem.term_along(joint, term, parts);
            values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64
        };
        Self { squares: (0..problem.joints()).map(|j| TERMS.map(|term| mean_square(j, term))).collect() }
    }

    /// m at each sample of a part; its mean is 1 along the motion of this scale.
    pub fn over(&self, problem: &Problem, part: usize) -> Vec<f64> {
        let mut sum = vec![0.0; problem.columns.samples(&[part])];
        let mut terms: f64 = 0.0;
        for (joint, squares) in self.squares.iter().enumerate() {
            for (term, square) in TERMS.into_iter().zip(squares).filter(|(_, square)| **square > 0.0) {
                let values = problem.term_along(joint, term, &[part]);
                sum.iter_mut().zip(values).for_each(|(sum, x)| *sum += x * x / square);
                terms += 1.0;
            }
        }
        sum.iter_mut().for_each(|m| *m /= terms.max(1.0));
        sum
    }
}
