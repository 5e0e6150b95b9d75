//! Which trial is the best so far, where costs do not repeat.

use crate::gp::{Gp, Posterior};

/// The trial from which the search goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Incumbent {
    /// Its place among the observations.
    pub(crate) at: usize,
    /// Its target: what was seen, or, of noisy costs, the posterior mean.
    pub(crate) target: f64,
    /// Whether its lead over the runner-up is within one deviation of their difference: only another trial of it would tell.
    pub(crate) doubtful: bool,
}

/// Noise variance of standardised targets above which costs are noisy: a deviation of a hundredth of theirs. Below it the
/// noise moves no incumbent that matters.
const NOISY_ABOVE: f64 = 1e-4;
/// Two targets this close are equal to rounding.
const EQUAL: f64 = 1e-9;

/// Whether the fitted noise is noise: above what rounding, and a kernel that does not follow every detail, leave behind, and not refuted by a
/// point that was tried twice and cost the same to rounding.
pub(crate) fn is_noisy(noise_variance: f64, points: &[Vec<f64>], targets: &[f64]) -> bool {
    let same = |i: usize, j: usize| points[i] == points[j] && (targets[i] - targets[j]).abs() < EQUAL;
    noise_variance > NOISY_ABOVE && !(0..points.len()).any(|i| (0..i).any(|j| same(i, j)))
}

impl Incumbent {
    /// The observation with the least target; the first of equals.
    pub(crate) fn observed(targets: &[f64]) -> Self {
        let first = (0, targets[0]);
        let (at, target) =
            targets.iter().copied().enumerate().fold(first, |best, (i, v)| if v < best.1 { (i, v) } else { best });
        Self { at, target, doubtful: false }
    }

    /// The observation with the least posterior mean among `finished`, the places of trials that did not fail; the first of
    /// equals. None where there are none.
    pub(crate) fn believed(gp: &Gp, points: &[Vec<f64>], finished: &[usize]) -> Option<Self> {
        let tried: Vec<Vec<f64>> = finished.iter().map(|&i| points[i].clone()).collect();
        if tried.is_empty() {
            return None;
        }
        let means: Vec<f64> = gp.posterior_batch(&tried).iter().map(|at| at.mean).collect();
        let best = Self::observed(&means);
        let others: Vec<usize> = (0..tried.len()).filter(|&i| tried[i] != tried[best.at]).collect();
        let runner_up = others.iter().copied().min_by(|&a, &b| means[a].total_cmp(&means[b]));
        let doubtful = runner_up.is_some_and(|other| {
            let Posterior { mean: lead, sd } = gp.difference(&tried[other], &tried[best.at]);
            lead < sd
        });
        Some(Self { at: finished[best.at], target: best.target, doubtful })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gp::HyperParameters;
    use crate::kernel::KernelFamily;

    fn gp(noise_variance: f64, points: &[Vec<f64>], targets: &[f64]) -> Gp {
        let hyper = HyperParameters { lengthscales: vec![0.3], signal_variance: 1.0, noise_variance, trend: None };
        Gp::new(KernelFamily::Matern52, &hyper, points.to_vec(), targets).unwrap()
    }

    /// One lucky trial among worse neighbours loses to three that agree.
    #[test]
    fn luck_is_not_believed() {
        let points: Vec<Vec<f64>> = [0.1, 0.11, 0.12, 0.8, 0.81, 0.82].map(|x| vec![x]).to_vec();
        let targets = [0.5, -1.1, 0.6, -0.9, -1.0, -0.8];
        assert_eq!(Incumbent::observed(&targets).at, 1);
        let believed = Incumbent::believed(&gp(0.3, &points, &targets), &points, &[0, 1, 2, 3, 4, 5]).unwrap();
        assert!(believed.at >= 3 && believed.target > -1.0, "{believed:?}");
        // Failed trials are none.
        let left = Incumbent::believed(&gp(0.3, &points, &targets), &points, &[0, 1, 2]).unwrap();
        assert!(left.at < 3);
        assert_eq!(Incumbent::believed(&gp(0.3, &points, &targets), &points, &[]), None);
    }

    #[test]
    fn doubt_ends_with_the_noise() {
        let points = vec![vec![0.1], vec![0.9]];
        let doubtful =
            |noise, gap: f64| Incumbent::believed(&gp(noise, &points, &[0.0, gap]), &points, &[0, 1]).unwrap().doubtful;
        assert!(doubtful(0.5, 0.2) && !doubtful(1e-4, 0.2) && !doubtful(0.1, 3.0));
    }

    #[test]
    fn a_cost_that_repeats_is_not_noisy() {
        let points = vec![vec![0.1], vec![0.5], vec![0.1]];
        assert!(is_noisy(0.1, &points, &[0.3, 0.2, 0.31]));
        assert!(!is_noisy(0.1, &points, &[0.3, 0.2, 0.3]));
        assert!(!is_noisy(1e-5, &points, &[0.3, 0.2, 0.31]));
    }
}
