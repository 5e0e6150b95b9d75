//! Where trials fail.

use crate::acquisition::log_normal_cdf;
use crate::gp::{FEWEST_SAMPLES, FitSettings, Gp, Lengthscales, fit};
use crate::kernel::KernelFamily;
use crate::{BayesoptError, History, Outcome};

/// Probability that a trial finishes, from those that did, those that did not, and how far these got:
///
/// ```text
/// P(x) = Φ(mean(x)/√(var(x) + σ_n²)),   mean, var: Gaussian process on s,   s = 1 of a finished trial, −1 − ½(1 − ξ/T) of a failed one
/// ```
///
/// s is the margin of a trial: the sooner one fails, the deeper it lies in the region of failure. Least-squares classification (rasmussen2006, §6.5) with graded labels; where nothing is known
/// P = ½, which costs an acquisition as much as half of its improvement. The kernel is Matérn-5/2 with one length-scale: a few
/// failures cannot tell fourteen apart.
#[derive(Debug, Clone)]
pub struct Feasibility {
    gp: Gp,
    noise_variance: f64,
}

impl Feasibility {
    /// The model after the trials that have come back, at unit coordinates; none where no trial has failed.
    ///
    /// # Errors
    /// A kernel matrix beyond repair.
    pub fn of(
        fit_settings: &FitSettings,
        history: &History,
        unit_points: &[Vec<f64>],
        seed: u64,
    ) -> Result<Option<Self>, BayesoptError> {
        let margins: Vec<(usize, f64)> =
            history.trials.iter().enumerate().filter_map(|(i, trial)| Some((i, margin(trial.outcome)?))).collect();
        if margins.len() < FEWEST_SAMPLES || margins.iter().all(|(_, margin)| *margin == FINISHED) {
            return Ok(None);
        }
        // As many as a fit can take; the latest lie where the next trial will.
        let latest = &margins[margins.len().saturating_sub(fit_settings.fit_limit)..];
        let points: Vec<Vec<f64>> = latest.iter().map(|(i, _)| unit_points[*i].clone()).collect();
        let targets: Vec<f64> = latest.iter().map(|(_, margin)| *margin).collect();
        let family = KernelFamily::Matern52;
        let settings = FitSettings { family, lengthscales: Lengthscales::Isotropic, starts: 1, ..*fit_settings };
        let hyper = fit(&settings, &points, &targets, seed ^ history.len() as u64)?.hyper;
        let gp = Gp::new(family, &hyper, points, &targets)?;
        Ok(Some(Self { gp, noise_variance: hyper.noise_variance }))
    }

    /// ln P at each point.
    pub fn log_probabilities(&self, points: &[Vec<f64>]) -> Vec<f64> {
        let log = |mean: f64, sd: f64| log_normal_cdf(mean / self.deviation(sd)).0;
        self.gp.posterior_batch(points).iter().map(|at| log(at.mean, at.sd)).collect()
    }

    /// ln P at x; its slope is added to `gradient`.
    pub fn add_slope(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let slope = self.gp.posterior_slope(x);
        let deviation = self.deviation(slope.at.sd);
        let z = slope.at.mean / deviation;
        let (value, by_z) = log_normal_cdf(z);
        for (i, gradient) in gradient.iter_mut().enumerate() {
            let d_deviation = slope.at.sd / deviation * slope.d_sd[i];
            *gradient += by_z * (slope.d_mean[i] - z * d_deviation) / deviation;
        }
        value
    }

    fn deviation(&self, sd: f64) -> f64 {
        (sd * sd + self.noise_variance).sqrt()
    }
}

/// s of a trial that finished.
const FINISHED: f64 = 1.0;

/// s of a trial that failed after `part` of it; of one that nobody timed, at once.
fn failed(part: f64) -> f64 {
    -1.0 - 0.5 * (1.0 - part)
}

/// s of a trial that has come back.
fn margin(outcome: Outcome) -> Option<f64> {
    match outcome {
        Outcome::Pending => None,
        Outcome::Failed { part: Some(part), .. } if part.is_finite() => Some(failed(part.clamp(0.0, 1.0))),
        Outcome::Value(value) if value.is_finite() => Some(FINISHED),
        Outcome::Failed { .. } | Outcome::Value(_) => Some(failed(0.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Settings;
    use crate::design::sobol_point;

    /// Trials fail where x + y > 1, the sooner the further outside.
    fn history() -> (History, Vec<Vec<f64>>) {
        let mut history = History::new();
        let points: Vec<Vec<f64>> = (0..24).map(|k| sobol_point(2, k, 5)).collect();
        for point in &points {
            let excess = point[0] + point[1] - 1.0;
            let outcome = if excess > 0.0 {
                Outcome::Failed { value: None, part: Some(1.0 - excess) }
            } else {
                Outcome::Value(2.0)
            };
            history.push(point.clone(), outcome);
        }
        history.push(vec![0.1, 0.9], Outcome::Pending);
        (history, points)
    }

    fn of(history: &History, points: &[Vec<f64>]) -> Option<Feasibility> {
        let settings = Settings::bo(vec![0.0; 2]).model.unwrap().fit;
        Feasibility::of(&settings, history, points, 1).unwrap()
    }

    #[test]
    fn learns_where_trials_fail() {
        let (history, points) = history();
        let feasibility = of(&history, &points).unwrap();
        let p = |x: f64, y: f64| feasibility.log_probabilities(&[vec![x, y]])[0].exp();
        assert!(p(0.2, 0.2) > 0.95 && p(0.8, 0.8) < 0.05, "{} {}", p(0.2, 0.2), p(0.8, 0.8));
        assert!(p(0.4, 0.4) > 0.9 && p(0.6, 0.6) < 0.1, "{} {}", p(0.4, 0.4), p(0.6, 0.6));
    }

    /// A trial that failed in its last second says less against its surroundings than one that failed in its first.
    #[test]
    fn the_part_that_was_seen_counts() {
        let points: Vec<Vec<f64>> = (0..8).map(|k| sobol_point(2, k, 5)).collect();
        let after = |part: Option<f64>| {
            let mut history = History::new();
            points.iter().for_each(|x| _ = history.push(x.clone(), Outcome::Value(1.0)));
            history.trials[3].outcome = Outcome::Failed { value: None, part };
            let near = vec![points[3][0] + 0.02, points[3][1]];
            of(&history, &points).unwrap().log_probabilities(&[near])[0]
        };
        let (at_once, halfway, at_the_end) = (after(Some(0.0)), after(Some(0.5)), after(Some(1.0)));
        assert!(at_once < halfway && halfway < at_the_end, "{at_once} {halfway} {at_the_end}");
        assert_eq!(after(None), at_once);
    }

    #[test]
    fn without_failures_there_is_nothing_to_model() {
        let (mut history, points) = history();
        history.trials.iter_mut().for_each(|trial| trial.outcome = Outcome::Value(1.0));
        assert!(of(&history, &points).is_none());
    }

    #[test]
    fn the_slope_is_that_of_the_value() {
        let (history, points) = history();
        let feasibility = of(&history, &points).unwrap();
        for x in [[0.31, 0.42], [0.9, 0.95], [0.5, 0.5], [0.02, 0.97]] {
            // Added to what is there.
            let mut gradient = [1.0, -2.0];
            let value = feasibility.add_slope(&x, &mut gradient);
            assert!((value - feasibility.log_probabilities(&[x.to_vec()])[0]).abs() < 1e-9);
            for i in 0..2 {
                let at = |h: f64| {
                    let mut x = x;
                    x[i] += h;
                    feasibility.add_slope(&x, &mut [0.0; 2])
                };
                let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
                let slope = gradient[i] - [1.0, -2.0][i];
                assert!((slope - difference).abs() < 1e-5 * difference.abs().max(1.0), "{slope} {difference}");
            }
        }
    }
}
