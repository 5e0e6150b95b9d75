//! Dry friction unlike the model's.

use tribo_sim::Effect;

use super::Candidate;
use crate::diagnosis::{CauseLabel, Location};
use crate::scene::{FineColumn, Scene};

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

    fn columns(&self, scene: &Scene<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        vec![scene.joint_column(self.joint, |at| at.sign[self.joint])]
    }

    /// The whole of dry friction stays positive, but for a slack of a tenth.
    fn admissible(&self, scene: &Scene<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        coefficients[0] > -1.1 * scene.nominal.dry_nm(self.joint)
    }

    fn effect(&self, _scene: &Scene<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::Coulomb { joint: self.joint, delta_coulomb_nm: coefficients[0] })
    }
}
