//! Right inverse of the Jacobian of a redundant arm.

use nalgebra::{Matrix6, SMatrix, SVector, Vector6};
use tribo_robot::{SpdFactor, product, product_transposed};

/// `J# = Jᵀ (J Jᵀ + λ² I)⁻¹` (nakamura1986).
///
/// ```text
/// λ² = 0                           while w ≥ w0
/// λ² = λmax² (1 − (w/w0)²)         near a singularity,   w = √det(J Jᵀ) manipulability
/// ```
///
/// Exact away from singularities, so the null-space projector `I − J#J` is exact there and does not depend on the mix
/// of m and rad in the rows of J. Where λ > 0 a little of the projected motion leaks into the task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampedPseudoInverse {
    /// Manipulability w0 below which damping sets in [m³ rad³].
    pub threshold: f64,
    /// Damping λmax at the singularity.
    pub max_damping: f64,
}

impl Default for DampedPseudoInverse {
    /// w0 = 0.005, a twentieth of the Panda's manipulability at its ready pose; λmax = 0.1.
    fn default() -> Self {
        Self { threshold: 0.005, max_damping: 0.1 }
    }
}

/// The factored pseudo-inverse at one configuration.
#[derive(Clone, Copy, Debug)]
pub struct Factored<'a, const N: usize> {
    jacobian: &'a SMatrix<f64, 6, N>,
    /// J#.
    inverse: SMatrix<f64, N, 6>,
    /// λ² in use.
    pub damping_squared: f64,
}

impl DampedPseudoInverse {
    /// Factors J; `None` if it is not finite.
    #[inline]
    pub fn factor<'a, const N: usize>(&self, jacobian: &'a SMatrix<f64, 6, N>) -> Option<Factored<'a, N>> {
        let gram = product_transposed(jacobian, jacobian);
        let exact = SpdFactor::of(&gram);
        let w2 = exact.map_or(0.0, |factor| factor.determinant());
        let ratio2 = w2 / (self.threshold * self.threshold);
        let damping_squared = if ratio2 < 1.0 { self.max_damping * self.max_damping * (1.0 - ratio2) } else { 0.0 };
        let gram = match exact {
            Some(factor) if damping_squared == 0.0 => factor,
            _ => SpdFactor::of(&(gram + Matrix6::identity() * damping_squared))?,
        };
        Some(Factored { jacobian, inverse: gram.right_solve(&jacobian.transpose()), damping_squared })
    }
}

impl<const N: usize> Factored<'_, N> {
    /// Joint motion `J# x` of smallest norm for the task motion x (angular part first).
    #[inline]
    pub fn apply(&self, x: &Vector6<f64>) -> SVector<f64, N> {
        product(&self.inverse, x)
    }

    /// `(I − J#J) y`: the part of a joint motion y that does not move the tool.
    #[inline]
    pub fn project_to_null_space(&self, y: &SVector<f64, N>) -> SVector<f64, N> {
        y - self.apply(&product(self.jacobian, y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::{Kinematics, presets};

    #[test]
    fn inverts_the_task_and_projects_out_of_it() {
        let j = Kinematics::at(&presets::panda(), &presets::panda_ready_pose()).jacobian();
        let inverse = DampedPseudoInverse::default().factor(&j).unwrap();
        assert_eq!(inverse.damping_squared, 0.0);
        let x = Vector6::new(0.3, -0.2, 0.5, 0.1, 0.2, -0.4);
        assert!((j * inverse.apply(&x) - x).amax() < 1e-13);
        let y = SVector::<f64, 7>::from_fn(|i, _| (i as f64).sin());
        let z = inverse.project_to_null_space(&y);
        assert!((j * z).amax() < 1e-13 && z.norm() > 0.1);
        assert!((inverse.project_to_null_space(&z) - z).amax() < 1e-13);
    }

    #[test]
    fn stays_bounded_at_a_singularity() {
        // Arm straight up, wrist axes aligned.
        let q = SVector::from([0.0, 0.0, 0.0, -0.07, 0.0, 0.0, 0.0]);
        let j = Kinematics::at(&presets::panda(), &q).jacobian();
        let inverse = DampedPseudoInverse::default().factor(&j).unwrap();
        assert!(inverse.damping_squared > 0.0);
        let norm = inverse.apply(&Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 1.0)).norm();
        assert!(norm < 1.0 / (2.0 * 0.1) + 1e-9, "{norm}"); // σ/(σ² + λ²) ≤ 1/(2λ)
        assert!(DampedPseudoInverse::default().factor(&(j * f64::NAN)).is_none());
    }
}
