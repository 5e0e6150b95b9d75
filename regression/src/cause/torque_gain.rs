//! A torque sensor of the wrong scale.

use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `measured = (1 + g) true`: the column is the nominal torque of the joint. Linear. Where gravity dominates it is a
/// first moment of a link.
pub(super) struct TorqueGain {
    pub joint: usize,
}

/// Largest believable error of a scale.
const LARGEST_ERROR: f64 = 0.6;

impl<const N: usize> Candidate<N> for TorqueGain {
    fn label(&self) -> CauseLabel {
        CauseLabel::TorqueGain
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        vec![data.joint_column(self.joint, |at| at.model_nm[self.joint])]
    }

    fn admissible(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients[0].abs() < LARGEST_ERROR
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::TorqueGain { joint: self.joint, gain_error: coefficients[0] })
    }
}
