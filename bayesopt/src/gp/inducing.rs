//! Gaussian process on a few of its points, for prediction in a fixed short time.

use faer::Mat;

use super::Posterior;
use super::cholesky::Cholesky;
use super::hyper::HyperParameters;
use crate::BayesoptError;
use crate::kernel::{Kernel, KernelFamily};

/// Projected process on m of n points:
///
/// ```text
/// mean(x) = k_m(x)ᵀ w,   w = (σ_n² K_mm + K_mn K_nm)⁻¹ K_mn y
/// var(x)  = k(x, x) − |v|² + |u|²,   v = L_m⁻¹ k_m(x),   u = L_B⁻¹ v
/// L_m L_mᵀ = K_mm,   L_B L_Bᵀ = I + A Aᵀ/σ_n²,   A = L_m⁻¹ K_mn
/// ```
///
/// rasmussen2006, eqs. (8.27), (8.28). All n observations enter; the m points only carry the functions that the
/// mean is made of. They are chosen greedily, each the point that the others say least about (pivoted Cholesky), until
/// there are `most` of them or no point has a prior variance above σ_n²/1000 left. With m = n it is the exact process.
/// A prediction costs m kernels and 2 m² and allocates nothing.
#[derive(Debug, Clone)]
pub struct InducingGp {
    kernel: Kernel,
    /// m × d, row by row.
    points: Vec<f64>,
    weights: Vec<f64>,
    /// L_m and L_B, m × m, row by row.
    prior_factor: Vec<f64>,
    posterior_factor: Vec<f64>,
}

/// Prior variance left at a point, relative to σ_n², below which another inducing point says nothing.
const EXHAUSTED: f64 = 1e-3;
/// The same relative to σ_f²: rounding.
const ROUNDING: f64 = 1e-10;

impl InducingGp {
    /// Projects the process conditioned on `targets` at `points` on at most `most` of them.
    ///
    /// # Errors
    /// `TooFewSamples` (none), `NonFiniteTarget`, `NonPositivePivot`.
    pub fn new(
        family: KernelFamily,
        hyper: &HyperParameters,
        points: &[Vec<f64>],
        targets: &[f64],
        most: usize,
    ) -> Result<Self, BayesoptError> {
        if points.is_empty() || points.len() != targets.len() || most == 0 {
            return Err(BayesoptError::TooFewSamples { need: points.len().max(1), got: targets.len().min(most) });
        }
        if let Some(index) = targets.iter().position(|t| !t.is_finite()) {
            return Err(BayesoptError::NonFiniteTarget { index, value: targets[index] });
        }
        let kernel = hyper.kernel(family);
        let chosen = greedy(&kernel, hyper.noise_variance, points, most);
        let inducing: Vec<Vec<f64>> = chosen.iter().map(|&k| points[k].clone()).collect();
        let (m, n) = (inducing.len(), points.len());

        let prior = Cholesky::new(&kernel.gram(&inducing))?;
        let mut a = Mat::from_fn(m, n, |i, j| kernel.value(&inducing[i], &points[j]));
        prior.forward_solve(a.as_mut());
        let inverse_noise = 1.0 / hyper.noise_variance;
        let mut b = &a * a.transpose() * faer::Scale(inverse_noise);
        for i in 0..m {
            b[(i, i)] += 1.0;
        }
        let posterior = Cholesky::new(&b)?;
        let y = Mat::from_fn(n, 1, |i, _| targets[i] * inverse_noise);
        let mut w = &a * y;
        posterior.forward_solve(w.as_mut());
        posterior.backward_solve(w.as_mut());
        prior.backward_solve(w.as_mut());
        Ok(Self {
            kernel,
            points: inducing.concat(),
            weights: w.col_as_slice(0).to_vec(),
            prior_factor: prior.lower_rows(),
            posterior_factor: posterior.lower_rows(),
        })
    }

    /// m.
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// Never: there is at least one point.
    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// Posterior at x, and the slope of its mean in `d_mean`; `scratch` holds m numbers.
    ///
    /// Coordinates of `x` and `d_mean` beyond those of the model, and room of `scratch` beyond m, are left alone.
    #[inline]
    pub fn posterior(&self, x: &[f64], scratch: &mut [f64], d_mean: &mut [f64]) -> Posterior {
        let (m, lengthscales) = (self.len(), &self.kernel.lengthscales);
        let scratch = &mut scratch[..m];
        d_mean.iter_mut().for_each(|slope| *slope = 0.0);
        let mut mean = 0.0;
        for ((row, k), &weight) in
            self.points.chunks_exact(lengthscales.len()).zip(scratch.iter_mut()).zip(&self.weights)
        {
            let (rho, slope) = self.kernel.family.correlation_and_slope(self.kernel.squared_distance(x, row));
            *k = self.kernel.signal_variance * rho;
            mean += *k * weight;
            let pull = 2.0 * self.kernel.signal_variance * slope * weight;
            for ((d, x), p) in d_mean.iter_mut().zip(x).zip(row) {
                *d += pull * (x - p);
            }
        }
        for (d, l) in d_mean.iter_mut().zip(lengthscales) {
            *d /= l * l;
        }
        let explained = forward_substitute(&self.prior_factor, scratch);
        let left = forward_substitute(&self.posterior_factor, scratch);
        let variance = self.kernel.signal_variance - explained + left;
        Posterior { mean, sd: variance.max(super::LEAST_VARIANCE * self.kernel.signal_variance).sqrt() }
    }
}

/// `x ← L⁻¹ x` for L row by row; returns |x|².
#[inline]
fn forward_substitute(lower: &[f64], x: &mut [f64]) -> f64 {
    let m = x.len();
    let mut norm = 0.0;
    for (i, row) in lower.chunks_exact(m).enumerate() {
        let (known, rest) = x.split_at_mut(i);
        let sum: f64 = row.iter().zip(known.iter()).map(|(l, x)| l * x).sum();
        if let Some(value) = rest.first_mut() {
            *value = (*value - sum) / row[i];
            norm += *value * *value;
        }
    }
    norm
}

/// Indices by pivoted Cholesky of K: always the point whose prior variance given those before is largest.
fn greedy(kernel: &Kernel, noise_variance: f64, points: &[Vec<f64>], most: usize) -> Vec<usize> {
    let n = points.len();
    let least = (EXHAUSTED * noise_variance).max(ROUNDING * kernel.signal_variance);
    let mut left = vec![kernel.signal_variance; n];
    let mut rows: Vec<Vec<f64>> = Vec::new();
    let mut chosen = Vec::new();
    while chosen.len() < most.min(n) {
        let (pivot, variance) =
            left.iter().enumerate().fold((0, 0.0), |best, (i, &v)| if v > best.1 { (i, v) } else { best });
        if variance <= least {
            break;
        }
        let scale = variance.sqrt();
        let row: Vec<f64> = (0..n)
            .map(|i| {
                let known: f64 = rows.iter().map(|row| row[i] * row[pivot]).sum();
                (kernel.value(&points[i], &points[pivot]) - known) / scale
            })
            .collect();
        for (v, r) in left.iter_mut().zip(&row) {
            *v -= r * r;
        }
        left[pivot] = 0.0;
        rows.push(row);
        chosen.push(pivot);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::sobol_point;
    use crate::gp::Gp;

    const FAMILY: KernelFamily = KernelFamily::SquaredExponential;

    fn hyper() -> HyperParameters {
        HyperParameters { lengthscales: vec![0.5, 0.9], signal_variance: 1.3, noise_variance: 1e-2, trend: None }
    }

    fn data() -> (Vec<Vec<f64>>, Vec<f64>) {
        let points: Vec<_> = (0..60).map(|i| sobol_point(2, i, 1)).collect();
        let targets = points.iter().map(|x| (6.0 * x[0]).sin() - x[1]).collect();
        (points, targets)
    }

    fn at(gp: &InducingGp, x: &[f64]) -> (Posterior, [f64; 2]) {
        let (mut scratch, mut slope) = (vec![0.0; gp.len()], [0.0; 2]);
        (gp.posterior(x, &mut scratch, &mut slope), slope)
    }

    /// Second algorithm: the exact process. A smooth kernel needs a third of the points; ten do visibly worse and say so.
    #[test]
    fn a_few_points_are_the_exact_process() {
        let (points, targets) = data();
        let exact = Gp::new(FAMILY, &hyper(), points.clone(), &targets).unwrap();
        let enough = InducingGp::new(FAMILY, &hyper(), &points, &targets, 60).unwrap();
        assert!(enough.len() < 40, "{}", enough.len());
        let coarse = InducingGp::new(FAMILY, &hyper(), &points, &targets, 8).unwrap();
        assert_eq!(coarse.len(), 8);
        let mut worst = 0.0_f64;
        for i in 100..140 {
            let x = sobol_point(2, i, 3);
            let want = exact.posterior_slope(&x);
            let (got, slope) = at(&enough, &x);
            assert!((got.mean - want.at.mean).abs() < 2e-4 && (got.sd / want.at.sd - 1.0).abs() < 2e-3, "{got:?}");
            assert!((slope[0] - want.d_mean[0]).abs() < 5e-3 && (slope[1] - want.d_mean[1]).abs() < 5e-3);
            worst = worst.max((at(&coarse, &x).0.mean - want.at.mean).abs());
        }
        assert!(worst > 1e-2, "{worst}");
    }

    #[test]
    fn the_slope_is_the_difference_quotient() {
        let (points, targets) = data();
        let gp = InducingGp::new(FAMILY, &hyper(), &points, &targets, 20).unwrap();
        let (_, slope) = at(&gp, &[0.31, 0.74]);
        for i in 0..2 {
            let moved = |h: f64| {
                let mut x = [0.31, 0.74];
                x[i] += h;
                at(&gp, &x).0.mean
            };
            assert!(((moved(1e-6) - moved(-1e-6)) / 2e-6 - slope[i]).abs() < 1e-7, "{i}");
        }
    }

    #[test]
    fn targets_must_be_finite_and_present() {
        let none = InducingGp::new(FAMILY, &hyper(), &[], &[], 3);
        assert!(matches!(none, Err(BayesoptError::TooFewSamples { need: 1, got: 0 })));
        let nan = InducingGp::new(FAMILY, &hyper(), &[vec![0.0, 0.0]], &[f64::NAN], 3);
        assert!(matches!(nan, Err(BayesoptError::NonFiniteTarget { index: 0, .. })));
    }
}
