//! Strategies that do not look.

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
