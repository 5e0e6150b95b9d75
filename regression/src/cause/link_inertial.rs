//! A link of another mass or first moment.

use std::ops::Range;

use nalgebra::{Matrix3, SVector, Vector3};
use tribo_robot::{LinkInertia, link_regressor};
use tribo_sim::Effect;

use super::{Candidate, RIGID_UNASKED};
use crate::column::{Column, FineColumn, combined};
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `Y_k dπ_k`, Y_k the regressor of link k. Linear. Only what the joints feel of a link is identifiable: the least change
/// that explains the torque is reported. On the last link it cannot be told from a payload.
pub(super) struct LinkInertial {
    pub link: usize,
    pub extent: Extent,
}

/// How much of a link may differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    /// All ten parameters in proportion: the link is heavier.
    Scale,
    /// The first moments, inertia about the link origin kept.
    FirstMoment,
    /// The first moments, inertia about the centre of mass kept: the link is moved in itself.
    Shift,
    /// Mass and first moments, inertia about the link origin kept.
    Mass,
    /// Mass and first moments, inertia about the centre of mass kept.
    MassAndShift,
    /// All ten parameters.
    Body,
}

impl Extent {
    pub const ALL: [Self; 6] =
        [Self::Scale, Self::FirstMoment, Self::Shift, Self::Mass, Self::MassAndShift, Self::Body];
}

impl LinkInertial {
    /// Columns of the regressor as the extent combines them: ten numbers per coefficient.
    fn directions<const N: usize>(&self, data: &RegressionData<N>) -> Vec<SVector<f64, 10>> {
        let link = &data.nominal.arm.links[self.link];
        let unit = |i: usize| SVector::<f64, 10>::from_fn(|row, _| if row == i { 1.0 } else { 0.0 });
        let moved = |i: usize| unit(i) + with_origin_inertia(&steiner_change(link, &unit(i)));
        match self.extent {
            Extent::Scale => vec![link.parameters()],
            Extent::FirstMoment => (1..4).map(unit).collect(),
            Extent::Shift => (1..4).map(moved).collect(),
            Extent::Mass => (0..4).map(unit).collect(),
            Extent::MassAndShift => (0..4).map(moved).collect(),
            Extent::Body => (0..10).map(unit).collect(),
        }
    }

    /// The change of the ten parameters that coefficients make.
    fn change<const N: usize>(&self, data: &RegressionData<N>, coefficients: &[f64]) -> SVector<f64, 10> {
        self.directions(data).iter().zip(coefficients).map(|(direction, c)| direction * *c).sum()
    }
}

/// First-order change of the inertia about the origin, `I_o = I_c + (h·h 1 − h hᵀ)/m`, by a change of m and h.
fn steiner_change(link: &LinkInertia, change: &SVector<f64, 10>) -> Matrix3<f64> {
    let (m, h) = (link.mass_kg.max(1e-6), link.com_m * link.mass_kg);
    let (dm, dh) = (change[0], Vector3::new(change[1], change[2], change[3]));
    let square = Matrix3::identity() * h.dot(&h) - h * h.transpose();
    let slope = Matrix3::identity() * (2.0 * h.dot(&dh)) - (h * dh.transpose() + dh * h.transpose());
    slope / m - square * (dm / (m * m))
}

/// Ten parameters with this inertia about the origin and nothing else.
fn with_origin_inertia(i: &Matrix3<f64>) -> SVector<f64, 10> {
    let six = [i[(0, 0)], i[(0, 1)], i[(0, 2)], i[(1, 1)], i[(1, 2)], i[(2, 2)]];
    SVector::from_fn(|row, _| if row < 4 { 0.0 } else { six[row - 4] })
}

/// The change of the inertia about the origin that leaves a link's inertia about its centre of mass as it was.
fn consistent_inertia(link: &LinkInertia, change: &SVector<f64, 10>) -> [f64; 6] {
    let mass_kg = link.mass_kg + change[0];
    let com_m = (link.com_m * link.mass_kg + Vector3::new(change[1], change[2], change[3])) / mass_kg;
    let moved = LinkInertia { mass_kg, com_m, inertia_kg_m2: link.inertia_kg_m2 };
    let difference = moved.parameters() - link.parameters();
    std::array::from_fn(|i| difference[4 + i])
}

/// Whether a link with this change is a body: positive mass, inertia about its centre of mass positive semi-definite.
fn is_body(link: &LinkInertia, change: &SVector<f64, 10>) -> bool {
    let p = link.parameters() + change;
    if p[0] <= 0.0 {
        return false;
    }
    let com = Vector3::new(p[1], p[2], p[3]) / p[0];
    let cross = com.cross_matrix();
    let about_origin = Matrix3::new(p[4], p[5], p[6], p[5], p[7], p[8], p[6], p[8], p[9]);
    (about_origin + cross * cross * p[0]).symmetric_eigenvalues().min() > 0.0
}

impl<const N: usize> Candidate<N> for LinkInertial {
    fn label(&self) -> CauseLabel {
        CauseLabel::LinkInertial
    }

    fn location(&self) -> Location {
        Location::Link(self.link)
    }

    fn unavailable(&self, data: &RegressionData<N>) -> Option<String> {
        data.transmission.then(|| RIGID_UNASKED.to_owned())
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        let directions = self.directions(data);
        let mut columns: Vec<Vec<_>> = (0..directions.len()).map(|_| Vec::with_capacity(data.motion.len())).collect();
        for at in &data.motion {
            let block = link_regressor(&data.nominal.arm, &at.q, &at.qd, &at.qdd, self.link);
            columns.iter_mut().zip(&directions).for_each(|(column, direction)| column.push(block * direction));
        }
        columns.into_iter().map(FineColumn::Arm).collect()
    }

    /// As the one column of the change that the coefficients make.
    fn add_to(&self, data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64], sum: &mut [SVector<f64, N>]) {
        let change = self.change(data, coefficients);
        for (sum, at) in sum.iter_mut().zip(&data.motion) {
            *sum += link_regressor(&data.nominal.arm, &at.q, &at.qd, &at.qdd, self.link) * change;
        }
    }

    fn filtered(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<Column<N>> {
        let regressor = &data.link_regressors()[self.link];
        self.directions(data).iter().map(|direction| combined(regressor, direction)).collect()
    }

    fn columns_of_widest(&self) -> Option<Range<usize>> {
        match self.extent {
            Extent::FirstMoment => Some(1..4),
            Extent::Mass => Some(0..4),
            _ => None,
        }
    }

    /// A link keeps a good part of its mass.
    fn admissible(&self, data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        let mass_kg = data.nominal.arm.links[self.link].mass_kg;
        match self.extent {
            Extent::Scale => (-0.9..5.0).contains(&coefficients[0]),
            Extent::FirstMoment | Extent::Shift => true,
            Extent::Mass | Extent::MassAndShift | Extent::Body => {
                coefficients[0] > -0.95 * mass_kg && coefficients[0] < 20.0
            }
        }
    }

    /// Where the estimate is no body (noise, or an inertia that the motion does not show), the inertia about the centre
    /// of mass is left as it was.
    fn effect(&self, data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        let link = &data.nominal.arm.links[self.link];
        let delta = self.change(data, coefficients);
        let delta_inertia_kg_m2 = match self.extent {
            Extent::Scale => std::array::from_fn(|i| delta[4 + i]),
            Extent::FirstMoment | Extent::Mass | Extent::Body if is_body(link, &delta) => {
                std::array::from_fn(|i| delta[4 + i])
            }
            _ => consistent_inertia(link, &delta),
        };
        Some(Effect::LinkInertial {
            link: self.link,
            delta_mass_kg: delta[0],
            delta_first_moment_kg_m: [delta[1], delta[2], delta[3]],
            delta_inertia_kg_m2,
        })
    }
}
