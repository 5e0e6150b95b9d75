//! A base that is not level.

use std::ops::Range;

use nalgebra::{Rotation3, Unit, Vector3};
use tribo_robot::{Arm, gravity_torque};
use tribo_sim::Effect;

use super::{Candidate, RIGID_UNASKED};
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::logged_motion::Burst;
use crate::regression_data::RegressionData;

/// Gravity of another direction: columns are the gravity torque per m/s² of its change.
///
/// ```text
/// tau = G(q) dg,   g + dg = R(axis, angle)ᵀ g
/// ```
///
/// A small tilt changes only the components across gravity (two columns); a large one all three. Needs postures in
/// which gravity loads the first joints differently.
pub(super) struct BaseTilt {
    /// Whether the third component is free too.
    pub large: bool,
}

/// Tilts beyond this are another mounting (rad).
const LARGEST_RAD: f64 = 0.8;
/// Gravity that a turned base has kept, relative.
const LENGTH_TOLERANCE: f64 = 0.05;

impl BaseTilt {
    /// Directions of the columns in base axes: across gravity, then along it.
    fn directions(gravity: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let down = gravity.normalize();
        let least = down.iamin();
        let across = down.cross(&Vector3::ith(least, 1.0)).normalize();
        [across, down.cross(&across), down]
    }

    /// The columns with one arm per log; its own gravity does not matter, directions are about that of the model.
    fn columns_of<const N: usize>(&self, data: &RegressionData<N>, arms: &[Arm<N>]) -> Vec<FineColumn<N>> {
        let directions = Self::directions(&data.nominal.arm.gravity_m_s2);
        let column = |direction: &Vector3<f64>| {
            let of_burst = |burst: &Burst| {
                let arm = Arm { gravity_m_s2: *direction, ..arms[burst.log].clone() };
                data.motion[burst.fine.clone()].iter().map(|at| gravity_torque(&arm, &at.q)).collect::<Vec<_>>()
            };
            FineColumn::Arm(data.bursts.iter().flat_map(of_burst).collect())
        };
        directions[..if self.large { 3 } else { 2 }].iter().map(column).collect()
    }

    fn turned<const N: usize>(&self, arm: &Arm<N>, coefficients: &[f64]) -> Vector3<f64> {
        let directions = Self::directions(&arm.gravity_m_s2);
        directions.iter().zip(coefficients).fold(arm.gravity_m_s2, |g, (direction, c)| g + direction * *c)
    }
}

impl<const N: usize> Candidate<N> for BaseTilt {
    fn label(&self) -> CauseLabel {
        CauseLabel::BaseTilt
    }

    fn location(&self) -> Location {
        Location::Arm
    }

    fn unavailable(&self, data: &RegressionData<N>) -> Option<String> {
        data.transmission.then(|| RIGID_UNASKED.to_owned())
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        self.columns_of(data, &vec![data.nominal.arm.clone(); data.chains.len()])
    }

    fn columns_of_widest(&self) -> Option<Range<usize>> {
        (!self.large).then_some(0..2)
    }

    fn admissible(&self, data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        let gravity = data.nominal.arm.gravity_m_s2;
        let turned = self.turned(&data.nominal.arm, coefficients);
        let same_length = !self.large || (turned.norm() / gravity.norm() - 1.0).abs() < LENGTH_TOLERANCE;
        same_length && gravity.angle(&turned) < LARGEST_RAD
    }

    fn effect(&self, data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        let gravity = data.nominal.arm.gravity_m_s2;
        let turned = self.turned(&data.nominal.arm, coefficients);
        // Rᵀ g = turned: R turns `turned` back onto g.
        let axis = turned.cross(&gravity);
        let axis = Unit::try_new(axis, 1e-12)?;
        Some(Effect::BaseTilt { angle_rad: gravity.angle(&turned), axis: [axis.x, axis.y, axis.z] })
    }
}

/// Gravity torque per m/s² of the two directions across gravity, of one arm per log.
pub fn base_tilt_columns<const N: usize>(data: &RegressionData<N>, arms: &[Arm<N>]) -> Vec<FineColumn<N>> {
    BaseTilt { large: false }.columns_of(data, arms)
}

/// The tilt whose gravity differs by these components across the nominal one (m/s²).
pub fn tilt_of<const N: usize>(data: &RegressionData<N>, change: [f64; 2]) -> Option<Effect> {
    BaseTilt { large: false }.effect(data, &[], &change)
}

/// Coefficients of the three columns for a known tilt under standard gravity along −z.
pub(super) fn gravity_change(angle_rad: f64, axis: &[f64; 3]) -> Vec<f64> {
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let Some(axis) = Unit::try_new(Vector3::from(*axis), 1e-12) else { return vec![0.0; 3] };
    let change = Rotation3::from_axis_angle(&axis, angle_rad).inverse() * gravity - gravity;
    BaseTilt::directions(&gravity).iter().map(|direction| direction.dot(&change)).collect()
}
