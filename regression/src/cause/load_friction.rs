//! Dry friction that grows with the load.

use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `γ |tau_link| tanh(qd/ε)`. Linear. Where the load hardly varies it is Coulomb friction.
pub(super) struct LoadFriction {
    pub joint: usize,
}

impl<const N: usize> Candidate<N> for LoadFriction {
    fn label(&self) -> CauseLabel {
        CauseLabel::LoadFriction
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        let j = self.joint;
        vec![data.joint_column(j, |at| at.link_nm[j].abs() * at.sign[j])]
    }

    fn admissible(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        (0.0..1.0).contains(&coefficients[0])
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::LoadFriction { joint: self.joint, load_coefficient: coefficients[0] })
    }
}
