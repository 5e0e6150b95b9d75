//! Rotor inertia unlike the model's.

use tribo_sim::{Effect, TorqueSide};

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `dIr qdd`. Linear; motor-side torques only. On the first joint it equals the inertia of the first link.
pub(super) struct RotorInertia {
    pub joint: usize,
}

impl<const N: usize> Candidate<N> for RotorInertia {
    fn label(&self) -> CauseLabel {
        CauseLabel::RotorInertia
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn unavailable(&self, data: &RegressionData<N>) -> Option<String> {
        let link = data.nominal.torque_side == TorqueSide::Link;
        link.then(|| "torques are measured on the link side of the gears, where rotors do not show".to_owned())
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        vec![data.joint_column(self.joint, |at| at.qdd[self.joint])]
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::RotorInertia { joint: self.joint, delta_rotor_inertia_kg_m2: coefficients[0] })
    }
}
