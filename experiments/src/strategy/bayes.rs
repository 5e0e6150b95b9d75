//! Strategies that only look at the cost.

use tribo_bayesopt::{Domain, History, Observation, Outcome, Phase, Settings, suggest};

use super::{FinishedTrial, LogSource, Origin, Past, Proposal, RunningTrial, Strategy, StrategyError};
use crate::ParameterSpace;

/// A search by the optimiser's ask and tell on the cost alone.
pub(super) struct Search {
    settings: Settings,
    domain: Domain,
    seed: u64,
}

impl Search {
    pub(super) fn random(space: &ParameterSpace, seed: u64) -> Result<Self, StrategyError> {
        Ok(Self { settings: Settings::random(), domain: space.domain()?, seed })
    }

    pub(super) fn sobol(space: &ParameterSpace, seed: u64) -> Result<Self, StrategyError> {
        Ok(Self { settings: Settings::sobol(), domain: space.domain()?, seed })
    }

    pub(super) fn paper(space: &ParameterSpace, seed: u64, init: usize) -> Result<Self, StrategyError> {
        Ok(Self { settings: Settings { init_trials: init, ..Settings::paper() }, domain: space.domain()?, seed })
    }

    pub(super) fn bo(space: &ParameterSpace, seed: u64, init: usize) -> Result<Self, StrategyError> {
        let settings = Settings { init_trials: init, ..Settings::bo(space.zero()) };
        Ok(Self { settings, domain: space.domain()?, seed })
    }
}

impl<const N: usize> Strategy<N> for Search {
    fn design(&self, number: usize) -> Result<Option<Proposal>, StrategyError> {
        if self.settings.model.is_some() && number >= self.settings.init_trials {
            return Ok(None);
        }
        let theta = self.settings.design_point(&self.domain, number, self.seed)?;
        Ok(Some(Proposal { theta, origin: Origin::Design }))
    }

    fn propose(&self, _number: usize, past: Past<'_>, _logs: &dyn LogSource<N>) -> Result<Proposal, StrategyError> {
        let history = observations(past.finished, past.running);
        let suggestion = suggest(&self.settings, &self.domain, &history, self.seed)?;
        let origin = match suggestion.phase {
            Phase::Design => Origin::Design,
            Phase::Model => Origin::Model,
        };
        Ok(Proposal { theta: suggestion.point, origin })
    }
}

/// Trials as the optimiser takes them, by number: an aborted one has failed, its penalised cost beside it.
pub(crate) fn observations(finished: &[FinishedTrial], running: &[RunningTrial]) -> History {
    let finished = finished.iter().map(|trial| {
        let cost = trial.cost.total();
        let outcome = match trial.aborted {
            None => Outcome::Value(cost),
            Some(_) => Outcome::Failed { value: Some(cost) },
        };
        (trial.number, Observation { point: trial.theta.clone(), outcome })
    });
    let running = running
        .iter()
        .map(|trial| (trial.number, Observation { point: trial.theta.clone(), outcome: Outcome::Pending }));
    let mut trials: Vec<(usize, Observation)> = finished.chain(running).collect();
    trials.sort_by_key(|(number, _)| *number);
    History { trials: trials.into_iter().map(|(_, trial)| trial).collect() }
}
