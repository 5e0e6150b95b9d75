//! Dry friction that turns round before the joint does.

use tribo_friction::law::leading_sign;
use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `A (clip((qd + ℓ qdd)/w) − s)`. Shape w, ℓ. Known to the selection as a family of all joints
/// (`tribo-posterior`), not joint by joint: a whole arm is simulated with soft friction, or none of it.
pub(super) struct FrictionLead {
    pub joint: usize,
}

impl<const N: usize> Candidate<N> for FrictionLead {
    fn label(&self) -> CauseLabel {
        CauseLabel::FrictionCurve
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>> {
        let (j, width_rad_s, lead_s) = (self.joint, shape[0], shape[1]);
        vec![data.joint_column(j, |at| leading_sign(at.qd[j], at.qdd[j], width_rad_s, lead_s) - at.sign[j])]
    }

    fn effect(&self, _data: &RegressionData<N>, shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        let (amplitude_nm, width_rad_s, lead_s) = (coefficients[0], shape[0], shape[1]);
        Some(Effect::FrictionLead { joint: self.joint, amplitude_nm, width_rad_s, lead_s })
    }
}
