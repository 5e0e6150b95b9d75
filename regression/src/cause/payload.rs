//! A body at the flange.

use std::ops::Range;

use nalgebra::{DVector, Matrix3, SMatrix, SVector, Vector3};
use tribo_robot::{Arm, link_regressor};
use tribo_sim::Effect;

use super::{Candidate, RIGID_UNASKED};
use crate::column::{Column, FineColumn, combined};
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `Y_flange π`, π = [m, m c, I_o] in the flange frame: mass, first moments, inertia about the flange origin. Linear.
/// The same torque comes from a heavier last link; a payload is the likelier story.
pub(super) struct Payload {
    pub extent: Extent,
}

/// How much of the body shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    /// Mass and centre of mass.
    PointMass,
    /// Inertia too.
    Body,
}

/// Heaviest body that such an arm holds (kg).
const HEAVIEST_KG: f64 = 30.0;
/// Farthest believable centre of mass from the flange (m).
const FARTHEST_M: f64 = 1.0;
/// Centre of mass along the flange's axis (m): behind it is the arm itself.
const FARTHEST_BEHIND_M: f64 = -0.05;

impl<const N: usize> Candidate<N> for Payload {
    fn label(&self) -> CauseLabel {
        CauseLabel::Payload
    }

    fn location(&self) -> Location {
        Location::Arm
    }

    fn unavailable(&self, data: &RegressionData<N>) -> Option<String> {
        data.transmission.then(|| RIGID_UNASKED.to_owned())
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        let arm = &data.nominal.arm;
        let link_from_flange = link_from_flange(arm);
        let count = if self.extent == Extent::Body { 10 } else { 4 };
        let mut columns: Vec<Vec<_>> = (0..count).map(|_| Vec::with_capacity(data.motion.len())).collect();
        for at in &data.motion {
            let block = link_regressor(arm, &at.q, &at.qd, &at.qdd, N - 1) * link_from_flange;
            columns.iter_mut().enumerate().for_each(|(i, column)| column.push(block.column(i).into_owned()));
        }
        columns.into_iter().map(FineColumn::Arm).collect()
    }

    /// As the one column of the body that the coefficients make.
    fn add_to(&self, data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64], sum: &mut [SVector<f64, N>]) {
        let arm = &data.nominal.arm;
        let body = link_from_flange(arm).columns(0, coefficients.len()) * DVector::from_column_slice(coefficients);
        for (sum, at) in sum.iter_mut().zip(&data.motion) {
            *sum += link_regressor(arm, &at.q, &at.qd, &at.qdd, N - 1) * body;
        }
    }

    fn filtered(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<Column<N>> {
        let link_from_flange = link_from_flange(&data.nominal.arm);
        let count = if self.extent == Extent::Body { 10 } else { 4 };
        let regressor = &data.link_regressors()[N - 1];
        (0..count).map(|i| combined(regressor, &link_from_flange.column(i).into_owned())).collect()
    }

    fn columns_of_widest(&self) -> Option<Range<usize>> {
        (self.extent == Extent::PointMass).then_some(0..4)
    }

    fn admissible(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        let mass_kg = coefficients[0];
        let first_moment = Vector3::new(coefficients[1], coefficients[2], coefficients[3]);
        let reachable = first_moment.norm() < FARTHEST_M * mass_kg && first_moment.z > FARTHEST_BEHIND_M * mass_kg;
        mass_kg > 0.0 && mass_kg < HEAVIEST_KG && reachable
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        let c = coefficients;
        let mass_kg = c[0];
        let com = Vector3::new(c[1], c[2], c[3]) / mass_kg;
        let inertia = if self.extent == Extent::Body {
            let about_flange = Matrix3::new(c[4], c[5], c[6], c[5], c[7], c[8], c[6], c[8], c[9]);
            let cross = com.cross_matrix();
            nearest_inertia(&(about_flange + cross * cross * mass_kg))
        } else {
            Matrix3::zeros()
        };
        let inertia_kg_m2 =
            [inertia[(0, 0)], inertia[(0, 1)], inertia[(0, 2)], inertia[(1, 1)], inertia[(1, 2)], inertia[(2, 2)]];
        Some(Effect::Payload { mass_kg, com_m: [com.x, com.y, com.z], inertia_kg_m2 })
    }
}

/// The coefficients of a known body: [m, m c, I_o].
pub(super) fn coefficients(mass_kg: f64, com_m: &[f64; 3], inertia_kg_m2: &[f64; 6]) -> Vec<f64> {
    let com = Vector3::from(*com_m);
    let cross = com.cross_matrix();
    let [xx, xy, xz, yy, yz, zz] = *inertia_kg_m2;
    let about_flange = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) - cross * cross * mass_kg;
    let i = |row, column| about_flange[(row, column)];
    let h = com * mass_kg;
    vec![mass_kg, h.x, h.y, h.z, i(0, 0), i(0, 1), i(0, 2), i(1, 1), i(1, 2), i(2, 2)]
}

/// Noise makes an estimated inertia indefinite: the nearest one with no negative eigenvalue.
fn nearest_inertia(inertia: &Matrix3<f64>) -> Matrix3<f64> {
    let mut eigen = inertia.symmetric_eigen();
    eigen.eigenvalues.iter_mut().for_each(|value| *value = value.max(0.0));
    eigen.recompose()
}

/// The ten parameters of a body in the last link frame from those in the flange frame.
///
/// ```text
/// h' = R h + m p,   I' = R I Rᵀ + m (p·p 1 − p pᵀ) + 2 (p·R h) 1 − (p (R h)ᵀ + (R h) pᵀ)
/// ```
pub fn link_from_flange<const N: usize>(arm: &Arm<N>) -> SMatrix<f64, 10, 10> {
    let (r, p) = (arm.link_from_flange_rotation, arm.link_from_flange_translation);
    let mut map = SMatrix::<f64, 10, 10>::zeros();
    for i in 0..10 {
        let unit = SVector::<f64, 10>::from_fn(|row, _| if row == i { 1.0 } else { 0.0 });
        let (m, h) = (unit[0], r * Vector3::new(unit[1], unit[2], unit[3]));
        let flange = Matrix3::new(unit[4], unit[5], unit[6], unit[5], unit[7], unit[8], unit[6], unit[8], unit[9]);
        let inertia = r * flange * r.transpose()
            + (Matrix3::identity() * p.dot(&p) - p * p.transpose()) * m
            + Matrix3::identity() * (2.0 * p.dot(&h))
            - (p * h.transpose() + h * p.transpose());
        let moment = h + p * m;
        let column = SVector::<f64, 10>::from([
            m,
            moment.x,
            moment.y,
            moment.z,
            inertia[(0, 0)],
            inertia[(0, 1)],
            inertia[(0, 2)],
            inertia[(1, 1)],
            inertia[(1, 2)],
            inertia[(2, 2)],
        ]);
        map.set_column(i, &column);
    }
    map
}
