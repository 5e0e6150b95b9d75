//! A constant torque.

use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `offset`. Linear. On a joint that moves one way it is Coulomb friction; on a joint under gravity that keeps its
/// posture, a first moment.
pub(super) struct TorqueOffset {
    pub joint: usize,
}

impl<const N: usize> Candidate<N> for TorqueOffset {
    fn label(&self) -> CauseLabel {
        CauseLabel::TorqueOffset
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        vec![data.joint_column(self.joint, |_| 1.0)]
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::TorqueOffset { joint: self.joint, offset_nm: coefficients[0] })
    }
}
