//! The acquisition function as the search sees it.

use super::Criterion;
use crate::Feasibility;
use crate::gp::Gp;

/// An acquisition as a function of the point, unit coordinates; larger is better.
pub trait AcquisitionFunction: Sync {
    /// Its value at each of many points.
    fn values(&self, points: &[Vec<f64>]) -> Vec<f64>;

    /// Its value at one point; its gradient goes into `gradient`.
    fn slope(&self, x: &[f64], gradient: &mut [f64]) -> f64;
}

/// `a(mean(x), sd(x))` of one Gaussian process.
#[derive(Debug, Clone, Copy)]
pub struct OneOutput<'a> {
    /// The process.
    pub gp: &'a Gp,
    /// The acquisition.
    pub criterion: &'a Criterion,
}

impl AcquisitionFunction for OneOutput<'_> {
    fn values(&self, points: &[Vec<f64>]) -> Vec<f64> {
        let value = |at: &crate::gp::Posterior| self.criterion.evaluate(at.mean, at.sd).value;
        self.gp.posterior_batch(points).iter().map(value).collect()
    }

    fn slope(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let slope = self.gp.posterior_slope(x);
        let at = self.criterion.evaluate(slope.at.mean, slope.at.sd);
        for (i, gradient) in gradient.iter_mut().enumerate() {
            *gradient = at.d_mean * slope.d_mean[i] + at.d_sd * slope.d_sd[i];
        }
        at.value
    }
}

/// `a(x) + ln P(x)`: a logarithmic acquisition of the trials that do not fail (gardner2014).
#[derive(Clone, Copy)]
pub struct OfFinished<'a> {
    /// a, a logarithm.
    pub acquisition: &'a dyn AcquisitionFunction,
    /// P, the probability that a trial finishes.
    pub feasibility: &'a Feasibility,
}

impl AcquisitionFunction for OfFinished<'_> {
    fn values(&self, points: &[Vec<f64>]) -> Vec<f64> {
        let finishes = self.feasibility.log_probabilities(points);
        self.acquisition.values(points).into_iter().zip(finishes).map(|(value, finishes)| value + finishes).collect()
    }

    fn slope(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let value = self.acquisition.slope(x, gradient);
        value + self.feasibility.add_slope(x, gradient)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::Acquisition;
    use super::*;
    use crate::{Domain, History, Outcome, Settings, SurrogateModel};

    /// Holds `slope` against `values` (to `tolerance`) and its gradient against central differences; returns the value.
    pub(in crate::acquisition) fn slope_is_that_of_the_value(
        acquisition: &impl AcquisitionFunction,
        x: [f64; 2],
        tolerance: f64,
    ) -> f64 {
        let mut gradient = [0.0; 2];
        let value = acquisition.slope(&x, &mut gradient);
        assert!((value - acquisition.values(&[x.to_vec()])[0]).abs() < tolerance * value.abs().max(1.0));
        for i in 0..2 {
            let at = |h: f64| {
                let mut x = x;
                x[i] += h;
                acquisition.slope(&x, &mut [0.0; 2])
            };
            let difference = (at(1e-6) - at(-1e-6)) / 2e-6;
            assert!((gradient[i] - difference).abs() < 1e-4 * difference.abs().max(1.0), "{gradient:?} {difference}");
        }
        value
    }

    #[test]
    fn the_acquisition_of_finished_trials_has_the_slope_of_its_value() {
        let (domain, settings) = (Domain::unit_cube(2).unwrap(), Settings::bo(vec![0.1, 0.1]));
        let mut history = History::new();
        for k in 0..12 {
            let x = settings.design_point(&domain, k, 2).unwrap();
            let cost = 1.0 + (x[0] - 0.3).powi(2) + (x[1] - 0.2).powi(2);
            let fails = x[0] + x[1] > 0.5;
            history.push(x, if fails { Outcome::FAILED } else { Outcome::Value(cost) });
        }
        let surrogate = SurrogateModel::of(settings.model.as_ref().unwrap(), &domain, &history, 2).unwrap().unwrap();
        let criterion = surrogate.criterion();
        assert_eq!(criterion.acquisition, Acquisition::LogEi);
        let own = OneOutput { gp: &surrogate.gp, criterion: &criterion };
        let acquisition = OfFinished { acquisition: &own, feasibility: surrogate.feasibility.as_ref().unwrap() };
        for x in [[0.4, 0.05], [0.2, 0.6], [0.9, 0.8]] {
            let value = slope_is_that_of_the_value(&acquisition, x, 1e-8);
            assert!(value < own.values(&[x.to_vec()])[0]);
        }
    }
}
