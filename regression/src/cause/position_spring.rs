//! A spring across the joint.

use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `k (q − rest)`: columns 1 and q, the rest position from their ratio. Linear. On a small range it is an offset.
pub(super) struct PositionSpring {
    pub joint: usize,
}

impl<const N: usize> Candidate<N> for PositionSpring {
    fn label(&self) -> CauseLabel {
        CauseLabel::PositionSpring
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        vec![data.joint_column(self.joint, |_| 1.0), data.joint_column(self.joint, |at| at.q[self.joint])]
    }

    /// A spring pulls back, and its rest position lies within a turn of the joint's range.
    fn admissible(&self, data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        let limits = &data.nominal.arm.limits;
        let rest = -coefficients[0] / coefficients[1];
        let turn = 2.0 * std::f64::consts::PI;
        coefficients[1] > 0.0
            && rest > limits.q_min_rad[self.joint] - turn
            && rest < limits.q_max_rad[self.joint] + turn
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        let [constant, stiffness] = [coefficients[0], coefficients[1]];
        Some(Effect::PositionSpring {
            joint: self.joint,
            stiffness_nm_per_rad: stiffness,
            rest_rad: -constant / stiffness,
        })
    }
}
