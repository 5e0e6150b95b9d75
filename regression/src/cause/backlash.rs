//! A gap between motor and link, seen by two encoders.

use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `theta − q = b sign(tau_link)`: an angle, not a torque, so it has a column in the deflection only (see
/// [`crate::deflection`]).
pub(crate) struct Backlash {
    pub joint: usize,
}

/// Sign of the transmitted torque, smoothed over `width_nm` (Nm).
pub(crate) fn transmitted_sign(link_nm: f64, width_nm: f64) -> f64 {
    (link_nm / width_nm).tanh()
}

impl<const N: usize> Candidate<N> for Backlash {
    fn label(&self) -> CauseLabel {
        CauseLabel::Backlash
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>> {
        vec![data.joint_column(self.joint, |at| transmitted_sign(at.link_nm[self.joint], shape[0]))]
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::Backlash { joint: self.joint, half_gap_rad: coefficients[0] })
    }
}
