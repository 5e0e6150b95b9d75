//! The worth of a point as the search sees it.

use super::Criterion;
use crate::gp::Gp;

/// An acquisition as a function of the point, unit coordinates; larger is better.
pub trait Worth {
    /// The worth of each of many points.
    fn values(&self, points: &[Vec<f64>]) -> Vec<f64>;

    /// The worth of one point; its gradient goes into `gradient`.
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

impl Worth for OneOutput<'_> {
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
