//! Friction that bends with speed.

use tribo_friction::law::smooth_sign;
use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `A tanh(qd/w)`. Shape w. Several widths beside viscous friction make any curve that rises and bends; the selection knows
/// it as a family of all joints (`tribo-posterior`), not joint by joint.
pub(super) struct FrictionCurve {
    pub joint: usize,
}

impl<const N: usize> Candidate<N> for FrictionCurve {
    fn label(&self) -> CauseLabel {
        CauseLabel::FrictionCurve
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>> {
        vec![data.joint_column(self.joint, |at| smooth_sign(at.qd[self.joint], shape[0]))]
    }

    fn effect(&self, _data: &RegressionData<N>, shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::FrictionCurve { joint: self.joint, amplitude_nm: coefficients[0], width_rad_s: shape[0] })
    }
}
