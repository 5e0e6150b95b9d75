//! Stationary covariance functions with one length-scale per coordinate.

pub mod matern52;
pub mod squared_exponential;

use faer::Mat;
use serde::{Deserialize, Serialize};

/// Which correlation  `ρ(r²)`  of the scaled squared distance r² is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum KernelFamily {
    /// Matérn ν = 5/2: twice differentiable, the field's default for costs.
    Matern52,
    /// Squared exponential: infinitely differentiable.
    SquaredExponential,
}

impl KernelFamily {
    /// `(ρ, dρ/dr²)` at the squared scaled distance `r2 >= 0`.
    #[inline]
    pub fn correlation_and_slope(self, r2: f64) -> (f64, f64) {
        match self {
            Self::Matern52 => matern52::correlation_and_slope(r2),
            Self::SquaredExponential => squared_exponential::correlation_and_slope(r2),
        }
    }
}

/// `k(a, b) = σ_f² ρ(r²),   r² = Σ_i ((a_i − b_i)/ℓ_i)²`.
///
/// ℓ has one entry per coordinate; the isotropic kernel has equal entries. Inputs are unit coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    /// ρ.
    pub family: KernelFamily,
    /// σ_f², in squared units of the target.
    pub signal_variance: f64,
    /// ℓ, in the units of the inputs.
    pub lengthscales: Vec<f64>,
}

impl Kernel {
    /// r² between two points.
    #[inline]
    pub fn squared_distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let term = |i: usize| ((a[i] - b[i]) / self.lengthscales[i]).powi(2);
        (0..self.lengthscales.len()).map(term).sum()
    }

    /// `k(a, b)`.
    pub fn value(&self, a: &[f64], b: &[f64]) -> f64 {
        self.signal_variance * self.family.correlation_and_slope(self.squared_distance(a, b)).0
    }

    /// `∂k/∂a_i = 2 σ_f² ρ' (a_i − b_i)/ℓ_i²`.
    pub fn input_gradient(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        let (_, slope) = self.family.correlation_and_slope(self.squared_distance(a, b));
        let factor = 2.0 * self.signal_variance * slope;
        (0..a.len()).map(|i| factor * (a[i] - b[i]) / self.lengthscales[i].powi(2)).collect()
    }

    /// `∂k/∂ln ℓ_i = −2 σ_f² ρ' ((a_i − b_i)/ℓ_i)²`, then `∂k/∂ln σ_f² = k` as the last entry.
    pub fn log_hyper_gradient(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        let (correlation, slope) = self.family.correlation_and_slope(self.squared_distance(a, b));
        let factor = -2.0 * self.signal_variance * slope;
        let mut gradient: Vec<f64> =
            (0..a.len()).map(|i| factor * ((a[i] - b[i]) / self.lengthscales[i]).powi(2)).collect();
        gradient.push(self.signal_variance * correlation);
        gradient
    }

    /// Gram matrix `K_ij = k(x_i, x_j)`, n × n, both triangles, without noise.
    pub fn gram(&self, points: &[Vec<f64>]) -> Mat<f64> {
        let n = points.len();
        let mut gram = Mat::zeros(n, n);
        for j in 0..n {
            for i in j..n {
                let k = self.value(&points[i], &points[j]);
                gram[(i, j)] = k;
                gram[(j, i)] = k;
            }
        }
        gram
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::uniform_random_point;

    const FAMILIES: [KernelFamily; 2] = [KernelFamily::Matern52, KernelFamily::SquaredExponential];

    fn kernel(family: KernelFamily, dimension: usize) -> Kernel {
        let lengthscales = (0..dimension).map(|i| 0.2 + 0.15 * i as f64).collect();
        Kernel { family, signal_variance: 1.7, lengthscales }
    }

    /// Central difference with step 1e-6: truncation 1e-12, rounding 1e-10, so 1e-8 is a safe tolerance.
    fn central(f: impl Fn(f64) -> f64) -> f64 {
        (f(1e-6) - f(-1e-6)) / 2e-6
    }

    #[test]
    fn gradients_match_finite_differences() {
        for family in FAMILIES {
            let kernel = kernel(family, 4);
            let (a, b) = (uniform_random_point(4, 0, 1), uniform_random_point(4, 1, 1));
            let input = kernel.input_gradient(&a, &b);
            let hyper = kernel.log_hyper_gradient(&a, &b);
            for i in 0..4 {
                let moved = |h: f64| {
                    let mut a = a.clone();
                    a[i] += h;
                    kernel.value(&a, &b)
                };
                assert!((input[i] - central(moved)).abs() < 1e-8, "{family:?} input {i}");
                let scaled = |h: f64| {
                    let mut kernel = kernel.clone();
                    kernel.lengthscales[i] *= h.exp();
                    kernel.value(&a, &b)
                };
                assert!((hyper[i] - central(scaled)).abs() < 1e-8, "{family:?} lengthscale {i}");
            }
            let scaled = |h: f64| Kernel { signal_variance: 1.7 * h.exp(), ..kernel.clone() }.value(&a, &b);
            assert!((hyper[4] - central(scaled)).abs() < 1e-8, "{family:?} signal variance");
        }
    }

    #[test]
    fn gram_matrices_are_positive_semidefinite() {
        for family in FAMILIES {
            for dimension in [1, 3, 14, 50] {
                let points: Vec<_> = (0..40).map(|i| uniform_random_point(dimension, i, 9)).collect();
                let gram = kernel(family, dimension).gram(&points);
                let eigenvalues = gram.self_adjoint_eigenvalues(faer::Side::Lower).unwrap();
                // Rounding of an n = 40 eigenproblem with norm <= 68: n · eps · norm < 1e-12.
                assert!(eigenvalues.iter().all(|l| *l > -1e-12), "{family:?} {dimension}-D {:?}", eigenvalues[0]);
            }
        }
    }

    #[test]
    fn coincident_points_have_the_signal_variance_and_no_slope() {
        for family in FAMILIES {
            let kernel = kernel(family, 3);
            let a = [0.3, 0.4, 0.5];
            assert_eq!(kernel.value(&a, &a), 1.7);
            assert!(kernel.input_gradient(&a, &a).iter().all(|g| *g == 0.0));
        }
    }
}
