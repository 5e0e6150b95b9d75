//! Torque through a gear from its deflection.

use nalgebra::{Matrix3, Vector3};

/// Piecewise-linear stiffness, continuous and through the origin:
///
/// ```text
/// T(δ) = k₁ min(δ + δ₀, 0) + k₂ clamp(δ, −δ₀, δ₀) + k₃ max(δ − δ₀, 0)
/// ```
///
/// uhlmann2023, eq. (16), the other way round: the paper writes δ = g(τ) with slopes m = 1/k and the near-zero
/// load τ_W0 = k₂ δ₀; its additive constants follow from continuity, which it asks of its fit and we build in. We keep
/// the torque as a function of the deflection, because then its slopes enter linearly in both of its uses
/// (see [`Self::torque_nm`] and [`Self::torque_between_nm`]), and so does their covariance.
///
/// The paper's Δθ = θ_s − θ is negative for a positive drive torque; here δ = motor − link angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StiffnessCurve {
    /// k₁, k₂, k₃ > 0 (Nm/rad): below, within and above the near-zero interval.
    pub slopes_nm_per_rad: Vector3<f64>,
    /// δ₀ > 0 (rad).
    pub knot_rad: f64,
    /// Covariance of the slopes (Nm²/rad²).
    pub slope_covariance: Matrix3<f64>,
    /// Stiction of the link that loads had to overcome (Nm).
    pub stiction_nm: f64,
    /// Half-width of the hysteresis (Nm): torque on the loading less that on the unloading branch is twice this.
    pub hysteresis_nm: f64,
    /// RMS of what the curve leaves of the torques it was fitted to (Nm).
    pub rms_nm: f64,
}

impl StiffnessCurve {
    /// One stiffness (Nm/rad) known to the given relative standard deviation.
    pub fn linear(stiffness_nm_per_rad: f64, relative_sd: f64) -> Self {
        let sd = relative_sd * stiffness_nm_per_rad;
        Self {
            slopes_nm_per_rad: Vector3::repeat(stiffness_nm_per_rad),
            knot_rad: 1e-3,
            // Fully correlated: it is one number.
            slope_covariance: Matrix3::repeat(sd * sd),
            stiction_nm: 0.0,
            hysteresis_nm: 0.0,
            rms_nm: 0.0,
        }
    }

    /// ∂T/∂k at δ (rad).
    #[inline]
    pub fn columns(knot_rad: f64, deflection_rad: f64) -> Vector3<f64> {
        let within = deflection_rad.clamp(-knot_rad, knot_rad);
        let beyond = deflection_rad - within;
        Vector3::new(beyond.min(0.0), within, beyond.max(0.0))
    }

    /// T(δ) (Nm).
    #[inline]
    pub fn torque_nm(&self, deflection_rad: f64) -> f64 {
        self.slopes_nm_per_rad.dot(&Self::columns(self.knot_rad, deflection_rad))
    }

    /// T(to) − T(from) (Nm), and its variance by that of the slopes (Nm²).
    #[inline]
    pub fn torque_between_nm(&self, from_rad: f64, to_rad: f64) -> (f64, f64) {
        let columns = Self::columns(self.knot_rad, to_rad) - Self::columns(self.knot_rad, from_rad);
        (self.slopes_nm_per_rad.dot(&columns), (self.slope_covariance * columns).dot(&columns))
    }

    /// dT/dδ (Nm/rad).
    #[inline]
    pub fn stiffness_nm_per_rad(&self, deflection_rad: f64) -> f64 {
        let segment = if deflection_rad.abs() <= self.knot_rad { 1 } else { 2 * usize::from(deflection_rad > 0.0) };
        self.slopes_nm_per_rad[segment]
    }

    /// The paper's g: deflection (rad) under a torque (Nm).
    #[inline]
    pub fn deflection_rad(&self, torque_nm: f64) -> f64 {
        let load = self.near_zero_load_nm();
        let within = torque_nm.clamp(-load, load);
        let beyond = torque_nm - within;
        let k = &self.slopes_nm_per_rad;
        beyond.min(0.0) / k[0] + within / k[1] + beyond.max(0.0) / k[2]
    }

    /// τ_W0 (Nm).
    #[inline]
    pub fn near_zero_load_nm(&self) -> f64 {
        self.slopes_nm_per_rad[1] * self.knot_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> StiffnessCurve {
        let slopes_nm_per_rad = Vector3::new(1.2e4, 7e3, 1.5e4);
        StiffnessCurve { slopes_nm_per_rad, knot_rad: 4e-4, ..StiffnessCurve::linear(1e4, 0.1) }
    }

    /// Closed form on each segment, continuity at the knots, and g as the inverse.
    #[test]
    fn segments_meet_and_invert() {
        let curve = curve();
        assert!((curve.torque_nm(1e-3) - (2.8 + 1.5e4 * 6e-4)).abs() < 1e-12);
        assert!((curve.torque_nm(-1e-3) + (2.8 + 1.2e4 * 6e-4)).abs() < 1e-12);
        assert!((curve.near_zero_load_nm() - 2.8).abs() < 1e-12);
        for knot in [-4e-4, 4e-4] {
            assert!((curve.torque_nm(knot + 1e-12) - curve.torque_nm(knot - 1e-12)).abs() < 1e-7);
        }
        for deflection in [-2e-3, -4e-4, -1e-4, 0.0, 3e-4, 5e-3] {
            assert!((curve.deflection_rad(curve.torque_nm(deflection)) - deflection).abs() < 1e-15);
            let slope = (curve.torque_nm(deflection + 1e-9) - curve.torque_nm(deflection)) / 1e-9;
            let k = curve.stiffness_nm_per_rad(deflection + 5e-10);
            assert!((slope / k - 1.0).abs() < 1e-5 || deflection == -4e-4, "{slope} {k}");
        }
    }

    #[test]
    fn a_uniform_error_of_stiffness_is_a_relative_error_of_torque() {
        let curve = StiffnessCurve::linear(1e4, 0.1);
        let (torque, variance) = curve.torque_between_nm(-3e-4, 4e-3);
        assert!((torque - 43.0).abs() < 1e-9 && (variance.sqrt() - 4.3).abs() < 1e-9);
    }
}
