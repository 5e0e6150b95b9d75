//! Stationary covariance functions with one length-scale per coordinate.

pub mod matern52;
pub mod squared_exponential;
mod trend;

pub use trend::Trend;
pub(crate) use trend::correlations as trend_correlations;

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

/// Whether the coordinates act together or one by one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Structure {
    /// `ρ(r²)`: everything may interact with everything.
    Joint,
    /// `(1 − s) ρ(r²) + s Σ_i ρ(d r_i²)/d`, s = 0.8: mostly a sum of functions of one coordinate each
    /// (duvenaud2011), which d observations per function can tell apart. d r_i² has the mean of r²,
    /// so one length-scale means the same in both terms.
    Additive,
}

impl Structure {
    /// s: share of the variance that is a sum over the coordinates.
    pub(crate) fn additive_share(self) -> f64 {
        match self {
            Self::Joint => 0.0,
            Self::Additive => 0.8,
        }
    }
}

/// What a kernel is made of, its hyper-parameters apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KernelShape {
    /// ρ.
    pub family: KernelFamily,
    /// Joint or additive.
    pub structure: Structure,
    /// Whether a [`Trend`] is added.
    pub trend: bool,
}

impl From<KernelFamily> for KernelShape {
    /// The stationary kernel of the textbook.
    fn from(family: KernelFamily) -> Self {
        Self { family, structure: Structure::Joint, trend: false }
    }
}

/// `k(a, b) = σ_f² ρ(r²) + trend,   r² = Σ_i r_i²,   r_i = (a_i − b_i)/ℓ_i`, with ρ(r²) as its [`Structure`] says.
///
/// ℓ has one entry per coordinate; the isotropic kernel has equal entries. Inputs are unit coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    /// ρ.
    pub family: KernelFamily,
    /// Joint or additive.
    pub structure: Structure,
    /// σ_f², in squared units of the target.
    pub signal_variance: f64,
    /// ℓ, in the units of the inputs.
    pub lengthscales: Vec<f64>,
    /// Variances of the trend, where there is one.
    pub trend: Option<Trend>,
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
        let scaled = |x: &[f64]| -> Vec<f64> { x.iter().zip(&self.lengthscales).map(|(x, l)| x / l).collect() };
        self.stationary(&scaled(a), &scaled(b)) + self.trend.map_or(0.0, |trend| trend.value(a, b))
    }

    /// `k(x, x)`.
    pub fn variance(&self, x: &[f64]) -> f64 {
        self.signal_variance + self.trend.map_or(0.0, |trend| trend.value(x, x))
    }

    /// The part without trend, of points in units of ℓ.
    #[inline]
    fn stationary(&self, a: &[f64], b: &[f64]) -> f64 {
        let r2: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        let joint = self.family.correlation_and_slope(r2).0;
        let share = self.structure.additive_share();
        if share == 0.0 {
            return self.signal_variance * joint;
        }
        let d = a.len() as f64;
        let alone =
            a.iter().zip(b).map(|(a, b)| self.family.correlation_and_slope(d * (a - b) * (a - b)).0).sum::<f64>() / d;
        self.signal_variance * ((1.0 - share) * joint + share * alone)
    }

    /// `K_ij = k(a_i, b_j)`, n × m.
    pub fn cross(&self, a: &[Vec<f64>], b: &[Vec<f64>]) -> Mat<f64> {
        let scaled = |points: &[Vec<f64>]| -> Vec<Vec<f64>> {
            points.iter().map(|x| x.iter().zip(&self.lengthscales).map(|(x, l)| x / l).collect()).collect()
        };
        let (za, zb) = (scaled(a), scaled(b));
        let mut cross = Mat::from_fn(a.len(), b.len(), |i, j| self.stationary(&za[i], &zb[j]));
        if let Some(trend) = self.trend {
            let (left, right) = (trend.features(a), trend.features(b));
            cross += &left * right.transpose();
        }
        cross
    }

    /// `∂k(a, b)/∂a_i`, added to `sums[k][i]` with weight `weights[k]`.
    #[inline]
    pub(crate) fn add_input_gradient(&self, a: &[f64], b: &[f64], weights: [f64; 2], sums: [&mut [f64]; 2]) {
        let share = self.structure.additive_share();
        let joint = 2.0
            * self.signal_variance
            * (1.0 - share)
            * self.family.correlation_and_slope(self.squared_distance(a, b)).1;
        let d = a.len();
        let [first, second] = sums;
        for i in 0..d {
            let r = (a[i] - b[i]) / self.lengthscales[i];
            let mut slope = joint * r / self.lengthscales[i];
            if share > 0.0 {
                // The d of d r_i² cancels that of the mean over the coordinates.
                let (_, alone) = self.family.correlation_and_slope(d as f64 * r * r);
                slope += 2.0 * self.signal_variance * share * alone * r / self.lengthscales[i];
            }
            if let Some(trend) = self.trend {
                slope += trend.input_slope(a[i], b[i], d);
            }
            first[i] += weights[0] * slope;
            second[i] += weights[1] * slope;
        }
    }

    /// `∂k/∂a_i`.
    pub fn input_gradient(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        let (mut gradient, mut unused) = (vec![0.0; a.len()], vec![0.0; a.len()]);
        self.add_input_gradient(a, b, [1.0, 0.0], [&mut gradient, &mut unused]);
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

    fn kernels(dimension: usize) -> Vec<Kernel> {
        let lengthscales: Vec<f64> = (0..dimension).map(|i| 0.2 + 0.15 * i as f64).collect();
        let kernel = |family, structure, trend| Kernel {
            family,
            structure,
            signal_variance: 1.7,
            lengthscales: lengthscales.clone(),
            trend,
        };
        let trend = Some(Trend { linear: 0.4, quadratic: 0.2 });
        FAMILIES
            .into_iter()
            .flat_map(|f| [kernel(f, Structure::Joint, None), kernel(f, Structure::Additive, trend)])
            .collect()
    }

    /// Central difference with step 1e-6: truncation 1e-12, rounding 1e-10, so 1e-8 is a safe tolerance.
    fn central(f: impl Fn(f64) -> f64) -> f64 {
        (f(1e-6) - f(-1e-6)) / 2e-6
    }

    #[test]
    fn gradients_match_finite_differences() {
        for kernel in kernels(4) {
            let (a, b) = (uniform_random_point(4, 0, 1), uniform_random_point(4, 1, 1));
            let input = kernel.input_gradient(&a, &b);
            for i in 0..4 {
                let moved = |h: f64| {
                    let mut a = a.clone();
                    a[i] += h;
                    kernel.value(&a, &b)
                };
                assert!((input[i] - central(moved)).abs() < 1e-8, "{kernel:?} input {i}");
            }
        }
    }

    #[test]
    fn gram_matrices_are_positive_semidefinite() {
        for dimension in [1, 3, 14, 50] {
            for kernel in kernels(dimension) {
                let points: Vec<_> = (0..40).map(|i| uniform_random_point(dimension, i, 9)).collect();
                let gram = kernel.gram(&points);
                let eigenvalues = gram.self_adjoint_eigenvalues(faer::Side::Lower).unwrap();
                // Rounding of an n = 40 eigenproblem with norm <= 156: n · eps · norm < 2e-12.
                assert!(eigenvalues.iter().all(|l| *l > -2e-12), "{kernel:?} {:?}", eigenvalues[0]);
            }
        }
    }

    #[test]
    fn coincident_points_have_the_signal_variance_and_no_slope() {
        for kernel in kernels(3).into_iter().map(|kernel| Kernel { trend: None, ..kernel }) {
            let a = [0.3, 0.4, 0.5];
            assert!((kernel.value(&a, &a) - 1.7).abs() < 1e-15 && kernel.variance(&a) == 1.7);
            assert!(kernel.input_gradient(&a, &a).iter().all(|g| *g == 0.0));
        }
    }
}
