//! Exact Gaussian-process regression.

mod cholesky;
mod fit;
mod hyper;
mod inducing;
mod likelihood;
mod prior;
mod workspace;

pub use cholesky::Cholesky;
pub use fit::{Contender, FEWEST_SAMPLES, Fit, FitSettings, fit, fit_best, fit_coarse_to_fine};
pub use hyper::{HyperParameters, Lengthscales};
pub use inducing::InducingGp;
pub use likelihood::{Evaluation, MarginalLikelihood};
pub use prior::{HyperPrior, LogNormal};

use faer::Mat;

use crate::BayesoptError;
use crate::kernel::{Kernel, KernelShape};

/// Zero-mean Gaussian process conditioned on n observations:
///
/// ```text
/// mean(x) = k(x)ᵀ α,   α = (K + σ_n² I)⁻¹ y
/// var(x)  = k(x, x) − |L⁻¹ k(x)|²,   L Lᵀ = K + σ_n² I
/// ```
///
/// rasmussen2006, algorithm 2.1. Variance is that of the noise-free function.
#[derive(Debug, Clone)]
pub struct Gp {
    kernel: Kernel,
    points: Vec<Vec<f64>>,
    targets: Vec<f64>,
    noise_variance: f64,
    cholesky: Cholesky,
    alpha: Vec<f64>,
}

/// Posterior of the function value at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posterior {
    /// Mean, target units.
    pub mean: f64,
    /// Standard deviation of the noise-free function, target units, > 0.
    pub sd: f64,
}

/// Posterior with its gradients in x.
#[derive(Debug, Clone, PartialEq)]
pub struct PosteriorSlope {
    /// Mean and deviation.
    pub at: Posterior,
    /// ∂mean/∂x.
    pub d_mean: Vec<f64>,
    /// ∂sd/∂x.
    pub d_sd: Vec<f64>,
}

/// Variance below which a point counts as observed, relative to σ_f²: rounding of k(x,x) − |L⁻¹k|².
const LEAST_VARIANCE: f64 = 1e-14;

impl Gp {
    /// Conditions the process on `targets` at `points` with given hyper-parameters.
    ///
    /// # Errors
    /// `TooFewSamples` (none), `NonFiniteTarget`, `NonPositivePivot`.
    pub fn new(
        shape: impl Into<KernelShape>,
        hyper: &HyperParameters,
        points: Vec<Vec<f64>>,
        targets: &[f64],
    ) -> Result<Self, BayesoptError> {
        if points.is_empty() || points.len() != targets.len() {
            return Err(BayesoptError::TooFewSamples { need: points.len().max(1), got: targets.len() });
        }
        if let Some(index) = targets.iter().position(|t| !t.is_finite()) {
            return Err(BayesoptError::NonFiniteTarget { index, value: targets[index] });
        }
        let kernel = hyper.kernel(shape);
        let cholesky = factor(&kernel, hyper.noise_variance, &points)?;
        let alpha = cholesky.solve(targets);
        Ok(Self { kernel, points, targets: targets.to_vec(), noise_variance: hyper.noise_variance, cholesky, alpha })
    }

    /// Takes one observation more, in n²: the posterior is that of [`Self::new`] with all of them. Where the new point is so near
    /// to an old one that rounding swallows what it adds, everything is factorised anew, with the jitter that takes.
    ///
    /// # Errors
    /// `NonFiniteTarget`, `NonPositivePivot`.
    pub fn observe(&mut self, point: Vec<f64>, target: f64) -> Result<(), BayesoptError> {
        if !target.is_finite() {
            return Err(BayesoptError::NonFiniteTarget { index: self.points.len(), value: target });
        }
        let row = self.kernel.cross(&self.points, std::slice::from_ref(&point));
        let row: Vec<f64> = row.col(0).iter().copied().collect();
        let grown = self.cholesky.grow(&row, self.kernel.variance(&point) + self.noise_variance);
        self.points.push(point);
        self.targets.push(target);
        if grown.is_err() {
            self.cholesky = factor(&self.kernel, self.noise_variance, &self.points)?;
        }
        self.alpha = self.cholesky.solve(&self.targets);
        Ok(())
    }

    /// Jitter that the factorisation needed, target units squared.
    pub fn jitter(&self) -> f64 {
        self.cholesky.jitter()
    }

    /// The kernel in use.
    pub fn kernel(&self) -> &Kernel {
        &self.kernel
    }

    /// Posterior at each of m points, by one triangular solve with m right-hand sides.
    pub fn posterior_batch(&self, at: &[Vec<f64>]) -> Vec<Posterior> {
        let mut cross = self.kernel.cross(&self.points, at);
        let means: Vec<f64> =
            (0..at.len()).map(|j| cross.col(j).iter().zip(&self.alpha).map(|(k, a)| k * a).sum()).collect();
        self.cholesky.forward_solve(cross.as_mut());
        let sd = |j: usize| self.deviation(&at[j], cross.col(j).iter().map(|v| v * v).sum());
        (0..at.len()).map(|j| Posterior { mean: means[j], sd: sd(j) }).collect()
    }

    /// Posterior and its gradients at one point:
    /// `∂mean = Jᵀα`, `∂sd = (½ ∂k(x, x) − Jᵀ(K + σ_n² I)⁻¹k)/sd`, J_ij = ∂k(x_i, x)/∂x_j.
    pub fn posterior_slope(&self, x: &[f64]) -> PosteriorSlope {
        let mut column = self.kernel.cross(&self.points, &[x.to_vec()]);
        let mean = column.col(0).iter().zip(&self.alpha).map(|(k, a)| k * a).sum();
        self.cholesky.forward_solve(column.as_mut());
        let sd = self.deviation(x, column.col(0).iter().map(|v| v * v).sum());
        self.cholesky.backward_solve(column.as_mut());

        let (mut d_mean, mut d_sd) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        for ((point, alpha), weight) in self.points.iter().zip(&self.alpha).zip(column.col(0).iter()) {
            self.kernel.add_input_gradient(x, point, [*alpha, -weight / sd], [&mut d_mean, &mut d_sd]);
        }
        // The prior variance itself: ½ ∂k(x, x)/∂x = ∂k(a, x)/∂a at a = x.
        if let Some(trend) = self.kernel.trend {
            for c in 0..x.len() {
                d_sd[c] += trend.input_slope(x[c], x[c], x.len()) / sd;
            }
        }
        PosteriorSlope { at: Posterior { mean, sd }, d_mean, d_sd }
    }

    /// Posterior of the difference `f(a) − f(b)`; its deviation is 0 where a and b are one point.
    pub fn difference(&self, a: &[f64], b: &[f64]) -> Posterior {
        let cross = self.kernel.cross(&self.points, &[a.to_vec(), b.to_vec()]);
        let mut column = Mat::from_fn(self.points.len(), 1, |i, _| cross[(i, 0)] - cross[(i, 1)]);
        let mean = column.col(0).iter().zip(&self.alpha).map(|(k, alpha)| k * alpha).sum();
        self.cholesky.forward_solve(column.as_mut());
        let explained: f64 = column.col(0).iter().map(|v| v * v).sum();
        let prior = self.kernel.variance(a) + self.kernel.variance(b) - 2.0 * self.kernel.value(a, b);
        Posterior { mean, sd: (prior - explained).max(0.0).sqrt() }
    }

    fn deviation(&self, x: &[f64], explained: f64) -> f64 {
        let prior = self.kernel.variance(x);
        (prior - explained).max(LEAST_VARIANCE * prior).sqrt()
    }
}

/// The factor of `K + σ_n² I`.
fn factor(kernel: &Kernel, noise_variance: f64, points: &[Vec<f64>]) -> Result<Cholesky, BayesoptError> {
    let mut covariance = kernel.gram(points);
    for i in 0..points.len() {
        covariance[(i, i)] += noise_variance;
    }
    Cholesky::new(&covariance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::sobol_point;
    use crate::kernel::{KernelFamily, Structure, Trend};

    fn hyper(noise_variance: f64) -> HyperParameters {
        HyperParameters { lengthscales: vec![0.5, 0.9], signal_variance: 1.3, noise_variance, trend: None }
    }

    fn shapes() -> Vec<KernelShape> {
        let shape = |family, structure, trend| KernelShape { family, structure, trend };
        [KernelFamily::Matern52, KernelFamily::SquaredExponential]
            .into_iter()
            .flat_map(|family| [shape(family, Structure::Joint, false), shape(family, Structure::Additive, true)])
            .collect()
    }

    fn with_trend(shape: KernelShape, noise_variance: f64) -> HyperParameters {
        let trend = shape.trend.then_some(Trend { linear: 0.4, quadratic: 0.2 });
        HyperParameters { trend, ..hyper(noise_variance) }
    }

    fn data() -> (Vec<Vec<f64>>, Vec<f64>) {
        let points: Vec<_> = (0..9).map(|i| sobol_point(2, i, 1)).collect();
        let targets = points.iter().map(|x| (3.0 * x[0]).sin() - x[1]).collect();
        (points, targets)
    }

    #[test]
    fn observations_one_by_one_or_all_at_once_are_the_same() {
        let (points, targets) = data();
        for shape in shapes() {
            for noise in [1e-2, 1e-9] {
                let hyper = with_trend(shape, noise);
                let whole = Gp::new(shape, &hyper, points.clone(), &targets).unwrap();
                let mut grown = Gp::new(shape, &hyper, points[..2].to_vec(), &targets[..2]).unwrap();
                points[2..].iter().zip(&targets[2..]).for_each(|(x, y)| grown.observe(x.clone(), *y).unwrap());
                for x in (20..40).map(|i| sobol_point(2, i, 7)) {
                    let (a, b) = (whole.posterior_slope(&x), grown.posterior_slope(&x));
                    assert!((a.at.mean - b.at.mean).abs() < 1e-10 && (a.at.sd - b.at.sd).abs() < 1e-10, "{a:?} {b:?}");
                    assert!(a.d_mean.iter().zip(&b.d_mean).all(|(a, b)| (a - b).abs() < 1e-9), "{a:?} {b:?}");
                }
            }
        }
    }

    #[test]
    fn a_repeated_noise_free_observation_is_factorised_anew() {
        let (points, targets) = data();
        let mut gp = Gp::new(KernelFamily::Matern52, &hyper(0.0), points.clone(), &targets).unwrap();
        assert_eq!(gp.jitter(), 0.0);
        gp.observe(points[4].clone(), targets[4]).unwrap();
        assert!(gp.jitter() > 0.0 && (gp.posterior_slope(&points[4]).at.mean - targets[4]).abs() < 1e-6);
        assert!(gp.observe(vec![0.5, 0.5], f64::NAN).is_err());
    }

    #[test]
    fn noise_free_data_is_interpolated() {
        let (points, targets) = data();
        let gp = Gp::new(KernelFamily::Matern52, &hyper(1e-12), points.clone(), &targets).unwrap();
        for (x, y) in points.iter().zip(&targets) {
            let at = gp.posterior_slope(x).at;
            assert!((at.mean - y).abs() < 1e-8 && at.sd < 1e-5, "{at:?} {y}");
        }
    }

    #[test]
    fn posterior_equals_the_dense_formula() {
        // Second algorithm: the explicit inverse by faer's LU instead of the Cholesky factor.
        use faer::linalg::solvers::DenseSolveCore;
        let (points, targets) = data();
        for shape in shapes() {
            let gp = Gp::new(shape, &with_trend(shape, 0.01), points.clone(), &targets).unwrap();
            let noisy = &gp.kernel.gram(&points) + faer::Scale(0.01) * Mat::<f64>::identity(9, 9);
            let inverse = noisy.partial_piv_lu().inverse();
            let at: Vec<_> = (20..25).map(|i| sobol_point(2, i, 7)).collect();
            for (x, batch) in at.iter().zip(gp.posterior_batch(&at)) {
                let k = Mat::from_fn(9, 1, |i, _| gp.kernel.value(x, &points[i]));
                let y = Mat::from_fn(9, 1, |i, _| targets[i]);
                let mean = (k.transpose() * &inverse * &y)[(0, 0)];
                let variance = gp.kernel.value(x, x) - (k.transpose() * &inverse * &k)[(0, 0)];
                for posterior in [&batch, &gp.posterior_slope(x).at] {
                    assert!((posterior.mean - mean).abs() < 1e-12);
                    assert!((posterior.sd - variance.sqrt()).abs() < 1e-12);
                }
            }
        }
    }

    /// Second algorithm: the explicit inverse.
    #[test]
    fn differences_have_the_joint_posterior() {
        use faer::linalg::solvers::DenseSolveCore;
        let (points, targets) = data();
        for shape in shapes() {
            let gp = Gp::new(shape, &with_trend(shape, 0.01), points.clone(), &targets).unwrap();
            let noisy = &gp.kernel.gram(&points) + faer::Scale(0.01) * Mat::<f64>::identity(9, 9);
            let inverse = noisy.partial_piv_lu().inverse();
            let (a, b) = (sobol_point(2, 20, 7), sobol_point(2, 21, 7));
            let k = |x: &[f64]| Mat::from_fn(9, 1, |i, _| gp.kernel.value(x, &points[i]));
            let covariance =
                |x: &[f64], y: &[f64]| gp.kernel.value(x, y) - (k(x).transpose() * &inverse * k(y))[(0, 0)];
            let variance = covariance(&a, &a) + covariance(&b, &b) - 2.0 * covariance(&a, &b);
            let (difference, at) = (gp.difference(&a, &b), gp.posterior_batch(&[a.clone(), b.clone()]));
            assert!((difference.mean - at[0].mean + at[1].mean).abs() < 1e-12);
            assert!((difference.sd - variance.sqrt()).abs() < 1e-11, "{difference:?} {variance}");
            assert_eq!(gp.difference(&a, &a).sd, 0.0);
        }
    }

    #[test]
    fn gradients_match_central_differences() {
        let (points, targets) = data();
        for shape in shapes() {
            let gp = Gp::new(shape, &with_trend(shape, 0.01), points.clone(), &targets).unwrap();
            let x = vec![0.31, 0.74];
            let slope = gp.posterior_slope(&x);
            for i in 0..2 {
                let moved = |h: f64| {
                    let mut x = x.clone();
                    x[i] += h;
                    gp.posterior_slope(&x).at
                };
                let (right, left) = (moved(1e-6), moved(-1e-6));
                assert!(((right.mean - left.mean) / 2e-6 - slope.d_mean[i]).abs() < 1e-8, "{shape:?} mean");
                assert!(((right.sd - left.sd) / 2e-6 - slope.d_sd[i]).abs() < 1e-8, "{shape:?} sd");
            }
        }
    }

    #[test]
    fn the_order_of_the_observations_does_not_matter() {
        let (points, targets) = data();
        let gp = Gp::new(KernelFamily::Matern52, &hyper(1e-3), points.clone(), &targets).unwrap();
        let reversed: (Vec<_>, Vec<_>) = points.into_iter().zip(targets).rev().unzip();
        let other = Gp::new(KernelFamily::Matern52, &hyper(1e-3), reversed.0, &reversed.1).unwrap();
        let (a, b) = (gp.posterior_slope(&[0.4, 0.6]).at, other.posterior_slope(&[0.4, 0.6]).at);
        assert!((a.mean - b.mean).abs() < 1e-11 && (a.sd - b.sd).abs() < 1e-11, "{a:?} {b:?}");
    }

    #[test]
    fn duplicated_noise_free_points_need_a_reported_jitter() {
        let twice = vec![vec![0.2, 0.2]; 4];
        let gp = Gp::new(KernelFamily::Matern52, &hyper(0.0), twice, &[1.0; 4]).unwrap();
        assert!(gp.jitter() > 0.0);
        assert!((gp.posterior_slope(&[0.2, 0.2]).at.mean - 1.0).abs() < 1e-6);
    }

    #[test]
    fn targets_must_be_finite_and_present() {
        let nan = Gp::new(KernelFamily::Matern52, &hyper(0.1), vec![vec![0.0, 0.0]], &[f64::NAN]);
        assert!(matches!(nan, Err(BayesoptError::NonFiniteTarget { index: 0, .. })));
        let none = Gp::new(KernelFamily::Matern52, &hyper(0.1), vec![], &[]);
        assert!(matches!(none, Err(BayesoptError::TooFewSamples { need: 1, got: 0 })));
    }
}
