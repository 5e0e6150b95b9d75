//! Dry friction as the soft constraint of a physics engine.

use nalgebra::{SMatrix, SVector};
use tribo_robot::{Arm, SpdFactor, mass_matrix};

use crate::projected_gauss_seidel::solve_friction;

/// Largest impedance dmax = 0.95 times the time constant 0.02 s of the constraint (s).
const CONSTRAINT_S: f64 = 0.95 * 0.02;
/// Rate at which the constraint stops a joint (1/s).
const STOPPING_PER_S: f64 = 2.0 / CONSTRAINT_S;
/// Time by which [`SoftFriction`] leads the velocity (s): one over the rate at which it stops a joint.
pub const SOFT_FRICTION_LEAD_S: f64 = 0.5 * CONSTRAINT_S;
/// Stiffness of the constraint over the inertia that a joint feels [-]: d/(1 − d), d = 0.9.
const HARDNESS: f64 = 9.0;

/// One sub-step with soft dry friction; v* = A b is the velocity [rad/s] without it:
///
/// ```text
/// v⁺ = v* − A p,     p_j = clip(9 m_j (v⁺_j − (1 − 105 h) v_j), h [lower_j, upper_j]),     m_j = 1/A_jj
/// ```
///
/// The velocity-level form of [`SoftFriction`], implicit in the acceleration `(v⁺ − v)/h`: the box of [`solve_friction`] with the compliance
/// `A_jj/9` added to the diagonal, about the velocity that the constraint asks for. `p` (Nm s) is a warm start and leaves as the solution.
pub(crate) fn solve_soft_friction<const N: usize>(
    a: &SMatrix<f64, N, N>,
    (momentum, qd, h): (&SVector<f64, N>, &SVector<f64, N>, f64),
    [lower, upper]: [&SVector<f64, N>; 2],
    p: &mut SVector<f64, N>,
) -> SVector<f64, N> {
    let free = a * momentum;
    let mut soft = *a;
    for j in 0..N {
        soft[(j, j)] += a[(j, j)] / HARDNESS;
    }
    let wanted = qd * (1.0 - h * STOPPING_PER_S);
    let Some(factor) = SpdFactor::of(&soft) else { return free };
    let shifted = factor.inverse() * (free - wanted);
    solve_friction(&soft, &shifted, lower, upper, p);
    free - a * *p
}

/// MuJoCo's `frictionloss` with its default `solreffriction` and `solimpfriction`, along a given motion:
///
/// ```text
/// tau_j = clip(9 m_j (q̈_j + 105 q̇_j), ± loss_j),   m_j = 1/(M⁻¹)_jj at one pose
/// ```
///
/// A joint creeps under load instead of sticking, and friction leads the velocity by 1/105 s. Sign as of every friction here: the
/// torque that the motor has to deliver. Source: MuJoCo documentation, chapter Computation, "Friction loss" and "Parameters".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftFriction<const N: usize> {
    /// Largest friction (Nm).
    pub loss_nm: SVector<f64, N>,
    /// Inertia that each joint feels when all others are free [kg m²].
    pub felt_kg_m2: SVector<f64, N>,
}

impl<const N: usize> SoftFriction<N> {
    /// The friction of an arm, inertia taken at one pose (rad); `None` if its mass matrix there is singular.
    pub fn of(arm: &Arm<N>, q: &SVector<f64, N>, loss_nm: SVector<f64, N>) -> Option<Self> {
        let inverse = mass_matrix(arm, q).cholesky()?.inverse();
        Some(Self { loss_nm, felt_kg_m2: inverse.diagonal().map(f64::recip) })
    }

    /// Friction torque (Nm) at q̇ [rad/s] and q̈ [rad/s²].
    pub fn torque(&self, qd: &SVector<f64, N>, qdd: &SVector<f64, N>) -> SVector<f64, N> {
        SVector::from_fn(|j, _| {
            let soft = HARDNESS * self.felt_kg_m2[j] * (qdd[j] + STOPPING_PER_S * qd[j]);
            soft.clamp(-self.loss_nm[j], self.loss_nm[j])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;

    #[test]
    fn it_is_dry_friction_in_motion_and_stiff_damping_near_rest() {
        let loss = SVector::<f64, 7>::repeat(0.5);
        let friction = SoftFriction::of(&presets::panda(), &presets::panda_ready_pose(), loss).unwrap();
        let zero = SVector::zeros();
        assert_eq!(friction.torque(&SVector::repeat(1.0), &zero), loss);
        assert_eq!(friction.torque(&SVector::repeat(-1.0), &zero), -loss);
        // The wrist, being light, leaves sticking at the highest speed.
        let slow = SVector::<f64, 7>::repeat(1e-4);
        let torque = friction.torque(&slow, &zero);
        assert!(torque[6] < torque[0] && torque[0] < 0.5, "{torque}");
        assert!((torque[6] / (9.0 * friction.felt_kg_m2[6] * 105.263e-4) - 1.0).abs() < 1e-4);
        // An inertia felt with all other joints free is below the diagonal of the mass matrix.
        let mass = mass_matrix(&presets::panda(), &presets::panda_ready_pose());
        assert!((0..7).all(|j| friction.felt_kg_m2[j] <= mass[(j, j)] && friction.felt_kg_m2[j] > 0.0));
    }
}
