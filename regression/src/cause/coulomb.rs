//! Dry friction unlike the model's.

use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `dFc tanh(qd/ε)`. Linear. Needs motion both ways: one way it is an offset.
pub(super) struct Coulomb {
    pub joint: usize,
}

impl<const N: usize> Candidate<N> for Coulomb {
    fn label(&self) -> CauseLabel {
        CauseLabel::Coulomb
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        vec![data.joint_column(self.joint, |at| at.sign[self.joint])]
    }

    /// The whole of dry friction stays positive, but for a slack of a tenth.
    fn admissible(&self, data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients[0] > -1.1 * data.nominal.dry_nm(self.joint)
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::Coulomb { joint: self.joint, delta_coulomb_nm: coefficients[0] })
    }
}
