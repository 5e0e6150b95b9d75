//! Frames beyond the flange, and the load.

use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, SMatrix, Translation3, Vector3};
use tribo_robot::{ControlTerms, Payload, Pose};

/// Frames and load that a client can set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frames {
    /// Nominal end effector in the flange, as configured with the robot: here the flange itself.
    pub(super) flange_from_nominal: Pose,
    /// End effector.
    pub(super) nominal_from_end_effector: Pose,
    /// Stiffness frame: where the wrench is told.
    pub(super) end_effector_from_stiffness: Pose,
    /// What the flange carries.
    pub(super) load: Payload,
}

impl Default for Frames {
    fn default() -> Self {
        let here = Pose::identity();
        Self {
            flange_from_nominal: here,
            nominal_from_end_effector: here,
            end_effector_from_stiffness: here,
            load: Payload { mass_kg: 0.0, com_m: Vector3::zeros(), inertia_kg_m2: Matrix3::zeros() },
        }
    }
}

impl Frames {
    /// `flange_from_end_effector`.
    pub(super) fn flange_from_end_effector(&self) -> Pose {
        self.flange_from_nominal * self.nominal_from_end_effector
    }

    /// `flange_from_stiffness`.
    pub(super) fn flange_from_stiffness(&self) -> Pose {
        self.flange_from_end_effector() * self.end_effector_from_stiffness
    }
}

/// A 4 × 4 matrix, column by column, as a pose; `None` unless it is finite, its last row `0 0 0 1` and its rotation a
/// rotation within 1e-5, which floats repeat.
pub fn pose_of(matrix: &[f64; 16]) -> Option<Pose> {
    let rotation = Matrix3::from_fn(|row, column| matrix[4 * column + row]);
    let last_row = [matrix[3], matrix[7], matrix[11], matrix[15] - 1.0];
    let error =
        (rotation.transpose() * rotation - Matrix3::identity()).amax().max((rotation.determinant() - 1.0).abs());
    let valid =
        matrix.iter().all(|value| value.is_finite()) && last_row.iter().all(|value| value.abs() < 1e-5) && error < 1e-5;
    valid.then(|| {
        let translation = Translation3::new(matrix[12], matrix[13], matrix[14]);
        IsometryMatrix3::from_parts(translation, Rotation3::from_matrix_unchecked(rotation))
    })
}

/// Jacobian of the end effector's origin, base axes, linear rows first.
pub(super) fn end_effector_jacobian(terms: &ControlTerms<7>, end_effector: &Pose) -> SMatrix<f64, 6, 7> {
    let arm = end_effector.translation.vector - terms.base_from_flange.translation.vector;
    let mut jacobian = SMatrix::<f64, 6, 7>::zeros();
    for (k, column) in terms.jacobian.column_iter().enumerate() {
        let angular = column.fixed_rows::<3>(0).into_owned();
        let linear = column.fixed_rows::<3>(3) + angular.cross(&arm);
        jacobian.fixed_view_mut::<3, 1>(0, k).copy_from(&linear);
        jacobian.fixed_view_mut::<3, 1>(3, k).copy_from(&angular);
    }
    jacobian
}
