//! Torque periodic in the joint angle.

use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `a sin(n q) + b cos(n q)`: amplitude and phase follow. Shape n, found by [`crate::ripple`].
pub struct TorqueRipple {
    /// The joint, from 0.
    pub joint: usize,
}

impl<const N: usize> Candidate<N> for TorqueRipple {
    fn label(&self) -> CauseLabel {
        CauseLabel::TorqueRipple
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>> {
        let j = self.joint;
        vec![
            data.joint_column(j, |at| (shape[0] * at.q[j]).sin()),
            data.joint_column(j, |at| (shape[0] * at.q[j]).cos()),
        ]
    }

    fn effect(&self, _data: &RegressionData<N>, shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        let [sine, cosine] = [coefficients[0], coefficients[1]];
        Some(Effect::TorqueRipple {
            joint: self.joint,
            cycles_per_rev: shape[0],
            amplitude_nm: sine.hypot(cosine),
            phase_rad: cosine.atan2(sine),
        })
    }
}
