//! The rotation group: exponential and logarithm.

use nalgebra::{Matrix3, Vector3};

/// Rodrigues' formula `exp([w]×) = I + (sin θ/θ)[w]× + ((1 − cos θ)/θ²)[w]×²`, θ = |w| (rad).
#[inline]
pub fn exp(w: &Vector3<f64>) -> Matrix3<f64> {
    let theta2 = w.norm_squared();
    // Series below 1e-4 rad²: the truncation error is θ⁶/5040 < 1e-18.
    let (a, b) = if theta2 < 1e-6 {
        (1.0 - theta2 / 6.0 + theta2 * theta2 / 120.0, 0.5 - theta2 / 24.0 + theta2 * theta2 / 720.0)
    } else {
        let theta = theta2.sqrt();
        let half = (0.5 * theta).sin();
        (theta.sin() / theta, 2.0 * half * half / theta2)
    };
    let k = w.cross_matrix();
    Matrix3::identity() + k * a + k * k * b
}

/// Inverse of [`exp`]: the rotation vector (rad) of R, |w| ≤ π. Exact to rounding near 0 and near π.
#[inline]
pub fn log(r: &Matrix3<f64>) -> Vector3<f64> {
    // vee(R − Rᵀ)/2 = sin θ · axis; (tr R − 1)/2 = cos θ.
    let s = Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]) * 0.5;
    let cos = ((r.trace() - 1.0) * 0.5).clamp(-1.0, 1.0);
    let sin2 = s.norm_squared();
    if sin2 < 1e-3 && cos > 0.0 {
        // Every tick's case: asin(x)/x = 1 + x²/6 + 3x⁴/40 + …, the first term left out is below 2e-17.
        let series = [1.0 / 6.0, 3.0 / 40.0, 15.0 / 336.0, 105.0 / 3456.0];
        return s * (1.0 + sin2 * series.iter().rev().fold(0.0, |sum, term| sum * sin2 + term));
    }
    let sin = sin2.sqrt();
    let theta = sin.atan2(cos);
    if sin > 1e-4 {
        s * (theta / sin)
    } else {
        // Near π the axis is the dominant column of a aᵀ = ((R + Rᵀ)/2 − cos θ I)/(1 − cos θ).
        let b = ((r + r.transpose()) * 0.5 - Matrix3::identity() * cos) / (1.0 - cos);
        let k = (0..3).fold(0, |best, i| if b[(i, i)] > b[(best, best)] { i } else { best });
        let axis = b.column(k) / b[(k, k)].max(f64::MIN_POSITIVE).sqrt();
        let axis = if axis.dot(&s) < 0.0 { -axis } else { axis };
        axis.normalize() * theta
    }
}

/// One Newton step of `R ← R (3 I − Rᵀ R)/2` back onto the rotation group; enough for rounding drift.
#[inline]
pub fn renormalized(r: &Matrix3<f64>) -> Matrix3<f64> {
    r * (Matrix3::identity() * 3.0 - r.transpose() * r) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log_inverts_exp_from_zero_to_pi() {
        let axis = Vector3::new(0.3, -0.8, 0.52).normalize();
        let pi = std::f64::consts::PI;
        for theta in [0.0, 1e-12, 1e-8, 1e-5, 9e-4, 1.1e-3, 0.0315, 0.0318, 0.1, 1.0, 3.0, 3.1412, pi - 1e-9] {
            let w = axis * theta;
            let tolerance = if theta < 0.2 { 4e-16 } else { 1e-8 };
            assert!((log(&exp(&w)) - w).norm() < tolerance, "theta {theta}");
        }
    }

    #[test]
    fn exp_is_a_rotation() {
        let r = exp(&Vector3::new(1.0, 2.0, -0.5));
        assert!((r.transpose() * r - Matrix3::identity()).amax() < 1e-15 * 4.0);
        let off = r * 1.0001;
        assert!((renormalized(&off).determinant() - 1.0).abs() < 1e-7);
    }
}
