//! Strategies that do not look.

use tribo_friction::FrictionModel;
use tribo_sim::panda_gaz_joints;

use super::{FinishedTrial, LogSource, Origin, Proposal, Strategy, StrategyError};

/// The same parameters in every trial.
pub(super) struct Constant(pub(super) Vec<f64>);

impl Strategy for Constant {
    fn design(&self, _number: usize) -> Result<Option<Proposal>, StrategyError> {
        Ok(Some(Proposal { theta: self.0.clone(), origin: Origin::Constant }))
    }

    fn propose(&self, _: usize, _: &[FinishedTrial], _: &dyn LogSource) -> Result<Proposal, StrategyError> {
        Ok(Proposal { theta: self.0.clone(), origin: Origin::Constant })
    }
}

/// The friction published by Gaz et al. 2019 for one real Panda.
pub(super) fn published_gaz() -> FrictionModel<7> {
    FrictionModel { joints: panda_gaz_joints().map(Into::into) }
}
