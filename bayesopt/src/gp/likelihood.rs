//! Log marginal likelihood and its gradient.

use super::hyper::{HyperParameters, Lengthscales};
use super::prior::HyperPrior;
use super::workspace::Workspace;
use crate::BayesoptError;
use crate::kernel::KernelShape;

/// `ln p(y|θ) = −½ yᵀ α − ½ ln det(K + σ_n² I) − (n/2) ln 2π,   α = (K + σ_n² I)⁻¹ y`
///
/// ```text
/// ∂ ln p/∂θ_j = ½ tr( (α αᵀ − (K + σ_n² I)⁻¹) ∂K/∂θ_j )
/// ```
///
/// rasmussen2006, eqs. (2.30), (5.9). θ as in [`HyperParameters::from_log`]; points n × d, targets n.
/// `log_posterior` adds the prior densities of ℓ, σ_f² and σ_n². Leaves out: a mean function (standardise the targets).
#[derive(Debug, Clone)]
pub struct MarginalLikelihood<'a> {
    /// What the kernel is made of.
    pub shape: KernelShape,
    /// ARD or isotropic.
    pub lengthscales: Lengthscales,
    /// Prior of the posterior; ignored by the likelihood itself.
    pub prior: HyperPrior,
    /// n points of d coordinates.
    pub points: &'a [Vec<f64>],
    /// n targets.
    pub targets: &'a [f64],
}

/// A log density with its gradient in θ and the jitter its Cholesky factor needed.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// The log density.
    pub value: f64,
    /// ∂value/∂θ.
    pub gradient: Vec<f64>,
    /// Jitter added to the diagonal.
    pub jitter: f64,
}

impl MarginalLikelihood<'_> {
    /// Number of coordinates d.
    pub fn dimension(&self) -> usize {
        self.points.first().map_or(0, Vec::len)
    }

    /// Number of entries of θ.
    pub fn parameter_count(&self) -> usize {
        self.lengthscale_count() + if self.shape.trend { 4 } else { 2 }
    }

    /// Number of entries ln ℓ of θ, which come first.
    pub(super) fn lengthscale_count(&self) -> usize {
        self.lengthscales.count(self.dimension())
    }

    /// `ln p(y|θ)` and its gradient.
    ///
    /// # Errors
    /// `NonPositivePivot`.
    pub fn evaluate(&self, theta: &[f64]) -> Result<Evaluation, BayesoptError> {
        self.evaluate_in(theta, &mut self.workspace())
    }

    /// The same in the matrices of an earlier evaluation.
    ///
    /// # Errors
    /// `NonPositivePivot`.
    pub(super) fn evaluate_in(&self, theta: &[f64], work: &mut Workspace) -> Result<Evaluation, BayesoptError> {
        let (n, dimension) = (self.points.len(), self.dimension());
        let hyper = HyperParameters::from_log(theta, self.lengthscales, dimension);
        work.scale(self.points, &hyper.lengthscales);
        work.factor(self.shape, &hyper)?;
        let alpha = work.cholesky.solve(self.targets);
        let mut gradient = work.traces(self.shape, &hyper, &alpha);
        if self.lengthscales == Lengthscales::Isotropic {
            let sum = gradient[..dimension].iter().sum();
            gradient.splice(..dimension, [sum]);
        }

        let fit: f64 = self.targets.iter().zip(&alpha).map(|(y, a)| y * a).sum();
        let normaliser = n as f64 * (2.0 * std::f64::consts::PI).ln();
        let value = -0.5 * (fit + work.cholesky.log_determinant() + normaliser);
        Ok(Evaluation { value, gradient, jitter: work.cholesky.jitter() })
    }

    /// `ln p(y|θ) + ln p(θ)`, the objective of MAP; equal to the likelihood under the flat prior.
    ///
    /// # Errors
    /// `NonPositivePivot`.
    pub fn log_posterior(&self, theta: &[f64]) -> Result<Evaluation, BayesoptError> {
        self.log_posterior_in(theta, &mut self.workspace())
    }

    /// The same in the matrices of an earlier evaluation.
    ///
    /// # Errors
    /// `NonPositivePivot`.
    pub(super) fn log_posterior_in(&self, theta: &[f64], work: &mut Workspace) -> Result<Evaluation, BayesoptError> {
        let mut evaluation = self.evaluate_in(theta, work)?;
        for (i, prior) in self.priors().into_iter().enumerate() {
            if let Some(prior) = prior {
                let (log_density, slope) = prior.log_density(theta[i]);
                evaluation.value += log_density;
                evaluation.gradient[i] += slope;
            }
        }
        let count = self.lengthscale_count();
        let pooled = self.prior.pooling(&theta[..count], &mut evaluation.gradient[..count]);
        evaluation.value += pooled;
        Ok(evaluation)
    }

    /// Room for the evaluations of one ascent.
    pub(super) fn workspace(&self) -> Workspace {
        Workspace::new(self.points, self.dimension(), self.shape)
    }

    /// The prior of each entry of θ.
    pub(super) fn priors(&self) -> Vec<Option<super::prior::LogNormal>> {
        let mut priors = vec![self.prior.lengthscale(self.dimension()); self.lengthscale_count()];
        priors.extend([self.prior.signal(), self.prior.noise()]);
        priors.resize(self.parameter_count(), self.prior.trend());
        priors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::uniform_random_point;
    use crate::kernel::{KernelFamily, Structure};

    #[test]
    fn gradients_match_central_differences() {
        let points: Vec<_> = (0..12).map(|i| uniform_random_point(3, i, 4)).collect();
        let targets: Vec<f64> = points.iter().map(|x| (5.0 * x[0]).sin() + x[1] * x[2] - 0.4).collect();
        let stationary = |family| KernelShape::from(family);
        for family in [KernelFamily::Matern52, KernelFamily::SquaredExponential] {
            for shape in [
                stationary(family),
                KernelShape { trend: true, ..stationary(family) },
                KernelShape { trend: true, structure: Structure::Additive, family },
            ] {
                for lengthscales in [Lengthscales::Ard, Lengthscales::Isotropic] {
                    for prior in [HyperPrior::Flat, HyperPrior::DimensionScaled] {
                        let model =
                            MarginalLikelihood { shape, lengthscales, prior, points: &points, targets: &targets };
                        let mut theta = vec![-0.7, -0.2, 0.3, 0.1, -3.0, -1.2, -0.4];
                        theta.truncate(if shape.trend { 7 } else { 5 });
                        theta.drain(..3 - lengthscales.count(3));
                        let at = model.log_posterior(&theta).unwrap();
                        for i in 0..theta.len() {
                            // Step 1e-5 on a function of size 10: truncation and rounding both near 1e-9.
                            let moved = |h: f64| {
                                let mut theta = theta.clone();
                                theta[i] += h;
                                model.log_posterior(&theta).unwrap().value
                            };
                            let central = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                            let error = (central - at.gradient[i]).abs();
                            assert!(error < 1e-7, "{shape:?} {lengthscales:?} {prior:?} θ{i}: {error:e}");
                        }
                    }
                }
            }
        }
    }

    /// Second algorithm: the kernel point by point instead of the workspace's columns.
    #[test]
    fn the_workspace_factorises_the_kernel_that_predicts() {
        let points: Vec<_> = (0..9).map(|i| uniform_random_point(3, i, 4)).collect();
        let targets: Vec<f64> = points.iter().map(|x| (5.0 * x[0]).sin() + x[1] * x[2] - 0.4).collect();
        for structure in [Structure::Joint, Structure::Additive] {
            let shape = KernelShape { family: KernelFamily::Matern52, structure, trend: true };
            let (lengthscales, prior) = (Lengthscales::Ard, HyperPrior::Flat);
            let model = MarginalLikelihood { shape, lengthscales, prior, points: &points, targets: &targets };
            let theta = [-0.7, -0.2, 0.3, 0.1, -3.0, -1.2, -0.4];
            let hyper = HyperParameters::from_log(&theta, lengthscales, 3);
            let mut covariance = hyper.kernel(shape).gram(&points);
            (0..9).for_each(|i| covariance[(i, i)] += hyper.noise_variance);
            let cholesky = super::super::Cholesky::new(&covariance).unwrap();
            let fit: f64 = targets.iter().zip(cholesky.solve(&targets)).map(|(y, a)| y * a).sum();
            let want = -0.5 * (fit + cholesky.log_determinant() + 9.0 * (2.0 * std::f64::consts::PI).ln());
            assert!((model.evaluate(&theta).unwrap().value - want).abs() < 1e-10);
        }
    }
}
