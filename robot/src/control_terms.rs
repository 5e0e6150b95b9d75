//! Everything a task-space controller and a task-space estimator need at one state, computed once per tick.

use nalgebra::{SMatrix, SVector, Vector6};

use crate::{Arm, Kinematics, Pose, bias_torque, mass_matrix};

/// Model terms at (q, qd): pose, J, J̇ qd, M, C qd, g. Base axes, angular part first, SI units.
#[derive(Clone, Copy, Debug)]
pub struct ControlTerms<const N: usize> {
    /// `base_from_flange`.
    pub base_from_flange: Pose,
    /// Geometric Jacobian of the flange origin.
    pub jacobian: SMatrix<f64, 6, N>,
    /// Drift J̇ qd [rad/s²; m/s²].
    pub jdot_qd: Vector6<f64>,
    /// Mass matrix with rotor inertia [kg m²].
    pub mass_matrix: SMatrix<f64, N, N>,
    /// Coriolis and centrifugal torque C(q, qd) qd (Nm).
    pub coriolis_nm: SVector<f64, N>,
    /// Gravity torque g(q) (Nm).
    pub gravity_nm: SVector<f64, N>,
}

impl<const N: usize> ControlTerms<N> {
    /// Evaluates all terms at q (rad), qd [rad/s].
    #[inline]
    pub fn at(arm: &Arm<N>, q: &SVector<f64, N>, qd: &SVector<f64, N>) -> Self {
        let kinematics = Kinematics::at(arm, q);
        let gravity_nm = kinematics.gravity_torque(arm);
        Self {
            base_from_flange: kinematics.base_from_flange(),
            jacobian: kinematics.jacobian(),
            jdot_qd: kinematics.jdot_qd(qd),
            mass_matrix: mass_matrix(arm, q),
            coriolis_nm: bias_torque(arm, q, qd) - gravity_nm,
            gravity_nm,
        }
    }

    /// Bias torque C qd + g (Nm).
    #[inline]
    pub fn bias_nm(&self) -> SVector<f64, N> {
        self.coriolis_nm + self.gravity_nm
    }
}
