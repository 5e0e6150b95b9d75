//! How far a motion is from that which a model was fitted to.
//!
//! ```text
//! d² = mean over samples of min over fitted samples of mean over terms x of (Δx)²/⟨(x − ⟨x⟩)²⟩,   x position and velocity of each joint
//! ```
//!
//! A path that comes again is near; other postures and faster motions are far.

use crate::joint_term::JointTerm;
use crate::problem::Problem;
use crate::split::folds;

/// Position and velocity.
const TERMS: [JointTerm; 2] = [JointTerm::Spring, JointTerm::Viscous];
/// Most samples of a motion that are compared.
const MOST_POINTS: usize = 400;
/// Terms that vary by less are none of a motion [rad, rad/s].
const STILL: f64 = 1e-3;

/// The terms that vary along a problem, with their standard deviations there [rad, rad/s].
#[derive(Clone, Debug, PartialEq)]
pub struct MotionSpace {
    axes: Vec<(usize, JointTerm, f64)>,
}

/// Some samples of a motion, every term over its standard deviation.
pub(crate) type Points = Vec<Vec<f64>>;

impl MotionSpace {
    /// Of all parts of a problem.
    pub fn of(problem: &Problem) -> Self {
        let parts = problem.all_parts();
        let sd = |joint: usize, term| {
            let values = problem.term_along(joint, term, &parts);
            let samples = values.len().max(1) as f64;
            let middle = values.iter().sum::<f64>() / samples;
            (values.iter().map(|x| (x - middle).powi(2)).sum::<f64>() / samples).sqrt()
        };
        let all = (0..problem.joints()).flat_map(|joint| TERMS.map(|term| (joint, term, sd(joint, term))));
        Self { axes: all.filter(|(_, _, sd)| *sd > STILL).collect() }
    }

    /// The motion along some parts of a problem, this one or another of the same arm.
    pub fn points(&self, problem: &Problem, parts: &[usize]) -> Points {
        let samples = problem.columns.samples(parts);
        let every = samples.div_ceil(MOST_POINTS).max(1);
        let mut points: Points = (0..samples.div_ceil(every)).map(|_| Vec::with_capacity(self.axes.len())).collect();
        for (joint, term, sd) in &self.axes {
            let values = problem.term_along(*joint, *term, parts);
            points.iter_mut().zip(values.iter().step_by(every)).for_each(|(point, x)| point.push(x / sd));
        }
        points
    }

    /// d of parts that are held out in turn from the others, in the mean.
    pub fn in_turn(&self, problem: &Problem) -> f64 {
        let (_, folds) = folds(problem);
        let of_fold = |held_out: &Vec<usize>| {
            let seen: Vec<usize> = problem.all_parts().into_iter().filter(|part| !held_out.contains(part)).collect();
            distance(&self.points(problem, held_out), &self.points(problem, &seen))
        };
        folds.iter().map(of_fold).sum::<f64>() / folds.len().max(1) as f64
    }
}

/// d of a motion from what was fitted; infinite where nothing was.
pub fn distance(motion: &Points, fitted: &Points) -> f64 {
    let square =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len().max(1) as f64;
    let nearest = |point: &Vec<f64>| fitted.iter().map(|other| square(point, other)).fold(f64::INFINITY, f64::min);
    (motion.iter().map(nearest).sum::<f64>() / motion.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_that_comes_again_is_near_and_others_are_far() {
        let path = |shift: f64| -> Points { (0..50).map(|k| vec![f64::from(k) * 0.1 + shift, 0.0]).collect() };
        assert_eq!(distance(&path(0.0), &path(0.0)), 0.0);
        // 25 of 50 samples lie beyond the end of the path, by 0.1 k in the first of two terms: Σ k² = 25·26·51/6.
        let beyond = distance(&path(2.5), &path(0.0));
        assert!((beyond - (0.01 * 5525.0 / 50.0 / 2.0f64).sqrt()).abs() < 1e-9, "{beyond}");
        assert_eq!(distance(&path(0.0), &Vec::new()), f64::INFINITY);
    }
}
