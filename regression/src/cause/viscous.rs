//! Viscous friction unlike the model's.

use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `dFv qd`. Linear. Confusable with friction that grows faster than qd unless speeds vary.
pub(super) struct Viscous {
    pub joint: usize,
}

impl<const N: usize> Candidate<N> for Viscous {
    fn label(&self) -> CauseLabel {
        CauseLabel::Viscous
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        vec![data.joint_column(self.joint, |at| at.qd[self.joint])]
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::Viscous { joint: self.joint, delta_viscous_nm_s_per_rad: coefficients[0] })
    }
}
