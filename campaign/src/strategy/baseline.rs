//! Strategies that do not look.

use tribo_friction::{FrictionModel, JointFriction};
use tribo_sim::panda_gaz_joints;

use super::{LogSource, Origin, Past, Proposal, Strategy, StrategyError};

/// The same parameters in every trial.
pub(super) struct Constant(pub(super) Vec<f64>);

impl<const N: usize> Strategy<N> for Constant {
    fn design(&self, _number: usize) -> Result<Option<Proposal>, StrategyError> {
        Ok(Some(Proposal { theta: self.0.clone(), origin: Origin::Constant }))
    }

    fn propose(&self, _: usize, _: Past<'_>, _: &dyn LogSource<N>) -> Result<Proposal, StrategyError> {
        Ok(Proposal { theta: self.0.clone(), origin: Origin::Constant })
    }
}

/// The friction published by gaz2019 for one real Panda.
pub(crate) fn published_gaz<const N: usize>() -> Result<FrictionModel<N>, StrategyError> {
    let joints: [JointFriction; 7] = panda_gaz_joints().map(Into::into);
    Ok(FrictionModel { joints: joints.as_slice().try_into().map_err(|_| StrategyError::NotAPanda)? })
}
