//! How far a posture is from the mean posture of what a model was fitted to.
//!
//! ```text
//! p(t) = mean over joints that move of (q_j − ⟨q_j⟩)²/⟨(q_j − ⟨q_j⟩)²⟩
//! ```
//!
//! Weights, ripples and friction that goes with the load are known where an arm has been.

use crate::joint_term::JointTerm;
use crate::problem::Problem;

/// Joints that vary by less have one position [rad].
const STILL_RAD: f64 = 1e-3;

/// Mean position of each joint [rad] and the variance about it [rad²], 0 where it does not move.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Posture {
    moments: Vec<[f64; 2]>,
}

impl Posture {
    /// The postures of some parts.
    pub fn of(problem: &Problem, parts: &[usize]) -> Self {
        let moments = |joint: usize| {
            let q = problem.term_along(joint, JointTerm::Spring, parts);
            let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / q.len().max(1) as f64;
            let middle = mean(&mut q.iter().copied());
            let variance = mean(&mut q.iter().map(|x| (x - middle).powi(2)));
            [middle, if variance > STILL_RAD.powi(2) { variance } else { 0.0 }]
        };
        Self { moments: (0..problem.joints()).map(moments).collect() }
    }

    /// p at each sample of a part; its mean is 1 along what this was made of.
    pub fn over(&self, problem: &Problem, part: usize) -> Vec<f64> {
        let mut sum = vec![0.0; problem.columns.samples(&[part])];
        let moving = || self.moments.iter().enumerate().filter(|(_, [_, variance])| *variance > 0.0);
        for (joint, [middle, variance]) in moving() {
            let q = problem.term_along(joint, JointTerm::Spring, &[part]);
            sum.iter_mut().zip(q).for_each(|(sum, x)| *sum += (x - middle).powi(2) / variance);
        }
        sum.iter_mut().for_each(|p| *p /= moving().count().max(1) as f64);
        sum
    }
}
