//! More dry friction at low speed.

use tribo_sim::Effect;

use super::{Candidate, log_grid};
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `dF exp(−(qd/vs)²) tanh(qd/ε)`, profiled over vs. Confusable with Coulomb friction unless the joint also moves fast,
/// and with presliding where it only reverses.
pub(super) struct Stribeck {
    pub joint: usize,
}

/// Stribeck velocities of harmonic and planetary gears [rad/s].
const VELOCITY_RAD_S: [f64; 2] = [0.008, 0.3];

impl<const N: usize> Candidate<N> for Stribeck {
    fn label(&self) -> CauseLabel {
        CauseLabel::Stribeck
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn shapes(&self, _data: &RegressionData<N>) -> Vec<Vec<f64>> {
        log_grid(VELOCITY_RAD_S[0], VELOCITY_RAD_S[1], 7)
    }

    fn profile(&self) -> Option<[f64; 2]> {
        Some(VELOCITY_RAD_S)
    }

    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>> {
        let j = self.joint;
        vec![data.joint_column(j, |at| (-(at.qd[j] / shape[0]).powi(2)).exp() * at.sign[j])]
    }

    fn admissible(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients[0] > 0.0
    }

    fn effect(&self, _data: &RegressionData<N>, shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::Stribeck {
            joint: self.joint,
            breakaway_minus_coulomb_nm: coefficients[0],
            stribeck_velocity_rad_s: shape[0],
        })
    }
}
