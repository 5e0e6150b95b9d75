//! What chooses the trials of a campaign.

use std::fmt;
use std::sync::Arc;

use crate::friction_limit::FrictionLimit;
use crate::strategy::{FinishedTrial, Identification, LogSource, Strategy, StrategyError};
use crate::{EarlyStop, ValidTune};

/// The strategy that chooses the next trial, the limit that holds it back, and the least squares on past logs that both ask.
///
/// It remembers what it has read of the logs: a campaign in which other trials have finished, or another law holds, needs another one.
pub(crate) struct Chooser<const N: usize> {
    pub identification: Arc<Identification<N>>,
    pub strategy: Box<dyn Strategy<N>>,
    pub limit: FrictionLimit<N>,
}

impl<const N: usize> Chooser<N> {
    /// What the settings of a campaign ask for.
    #[inline(never)]
    pub fn of(tune: &ValidTune<N>) -> Result<Self, StrategyError> {
        let identification = Arc::new(Identification::new(tune)?);
        let strategy = tune.config.strategy.build(tune, &identification)?;
        let limit = FrictionLimit::of(tune, &identification);
        Ok(Self { identification, strategy, limit })
    }

    /// Why trial `next` is not worth its time, if it is not.
    pub fn ends_before(
        &self,
        next: usize,
        tune: &ValidTune<N>,
        finished: &[FinishedTrial],
        logs: &dyn LogSource<N>,
    ) -> Result<Option<EarlyStop>, StrategyError> {
        let Some(rule) = tune.config.stop_rule() else { return Ok(None) };
        EarlyStop::before(next, &rule, self.strategy.as_ref(), finished, (&self.limit, logs))
    }
}

impl<const N: usize> fmt::Debug for Chooser<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Chooser").finish_non_exhaustive()
    }
}
