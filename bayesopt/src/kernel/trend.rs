//! A polynomial trend with uncertain coefficients.

use faer::Mat;
use serde::{Deserialize, Serialize};

/// Variances of the trend  `Σ_i (β_i P₁(u_i) + γ_i P₂(u_i))/√d,   β_i ~ N(0, linear), γ_i ~ N(0, quadratic)`.
///
/// `P₁ = √3 (2u − 1)`, `P₂ = √5 (6u² − 6u + 1)` are the Legendre polynomials that are orthonormal on [0, 1], so the trend
/// has variance linear + quadratic over the cube. Integrating the coefficients out makes it a kernel (Rasmussen & Williams
/// 2006, §2.7): a cost with a bowl that spans the box shows its bottom long before it shows its details.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trend {
    /// Variance of the linear part, squared units of the target.
    pub linear: f64,
    /// Variance of the quadratic part, squared units of the target.
    pub quadratic: f64,
}

/// `(P₁, P₂)` at u.
fn legendre(u: f64) -> [f64; 2] {
    let x = 2.0 * u - 1.0;
    [3.0_f64.sqrt() * x, 5.0_f64.sqrt() * (1.5 * x * x - 0.5)]
}

/// `(P₁', P₂')` at u.
fn legendre_slope(u: f64) -> [f64; 2] {
    let x = 2.0 * u - 1.0;
    [2.0 * 3.0_f64.sqrt(), 6.0 * 5.0_f64.sqrt() * x]
}

/// `Σ_i P_k(a_i) P_k(b_i)/d` for k = 1, 2.
pub(crate) fn correlations(a: &[f64], b: &[f64]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for (a, b) in a.iter().zip(b) {
        let (p, q) = (legendre(*a), legendre(*b));
        sums[0] += p[0] * q[0];
        sums[1] += p[1] * q[1];
    }
    sums.map(|sum| sum / a.len() as f64)
}

impl Trend {
    /// `linear Σ P₁P₁/d + quadratic Σ P₂P₂/d`.
    pub fn value(self, a: &[f64], b: &[f64]) -> f64 {
        let [first, second] = correlations(a, b);
        self.linear * first + self.quadratic * second
    }

    /// Rows  `(√linear P₁(u_i)/√d …, √quadratic P₂(u_i)/√d …)`  whose scalar products are [`Self::value`], n × 2d.
    pub(super) fn features(self, points: &[Vec<f64>]) -> Mat<f64> {
        let d = points.first().map_or(0, Vec::len);
        let scale = [self.linear, self.quadratic].map(|variance| (variance / d as f64).sqrt());
        Mat::from_fn(points.len(), 2 * d, |i, j| scale[j / d] * legendre(points[i][j % d])[j / d])
    }

    /// `∂k/∂a_i`.
    #[inline]
    pub fn input_slope(self, a_i: f64, b_i: f64, dimension: usize) -> f64 {
        let (slope, q) = (legendre_slope(a_i), legendre(b_i));
        (self.linear * slope[0] * q[0] + self.quadratic * slope[1] * q[1]) / dimension as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomials_are_orthonormal() {
        // Gauss–Legendre with three nodes is exact to degree five.
        let node = 0.5 * 0.6_f64.sqrt();
        let rule = [(0.5 - node, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + node, 5.0 / 18.0)];
        let mean = |f: &dyn Fn([f64; 2]) -> f64| rule.iter().map(|(u, w)| w * f(legendre(*u))).sum::<f64>();
        for (got, want) in [
            (mean(&|p| p[0] * p[0]), 1.0),
            (mean(&|p| p[1] * p[1]), 1.0),
            (mean(&|p| p[0] * p[1]), 0.0),
            (mean(&|p| p[0]), 0.0),
            (mean(&|p| p[1]), 0.0),
        ] {
            assert!((got - want).abs() < 1e-14, "{got} {want}");
        }
    }
}
