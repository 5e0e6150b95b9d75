//! Strategies that only look at the cost, or at its parts.

use tribo_bayesopt::{
    Domain, ExpectedGain, History, Observation, Outcome, Phase, Settings, Suggestion, suggest_allowed, suggest_sum,
};
use tribo_trial::AbortReason;

use super::completion::{Completion, TELLING_PART};
use super::{FinishedTrial, LogSource, Origin, Past, Proposal, RunningTrial, Strategy, StrategyError};
use crate::ValidTune;

/// A search by the optimiser's ask and tell on the cost alone.
pub(super) struct Search {
    settings: Settings,
    domain: Domain,
    seed: u64,
    /// Whether every part of the cost has a model of its own.
    by_parts: bool,
    completion: Completion,
}

impl Search {
    pub(super) fn random<const N: usize>(tune: &ValidTune<N>) -> Result<Self, StrategyError> {
        Self::of(tune, Settings::random())
    }

    pub(super) fn sobol<const N: usize>(tune: &ValidTune<N>) -> Result<Self, StrategyError> {
        Self::of(tune, Settings::sobol())
    }

    pub(super) fn paper<const N: usize>(tune: &ValidTune<N>) -> Result<Self, StrategyError> {
        Self::of(tune, Settings { init_trials: tune.config.init, ..Settings::paper() })
    }

    pub(super) fn bo<const N: usize>(tune: &ValidTune<N>) -> Result<Self, StrategyError> {
        Self::of(tune, Settings { init_trials: tune.config.init, ..Settings::bo(tune.space.zero()) })
    }

    pub(super) fn composite<const N: usize>(tune: &ValidTune<N>) -> Result<Self, StrategyError> {
        Ok(Self { by_parts: true, ..Self::bo(tune)? })
    }

    fn of<const N: usize>(tune: &ValidTune<N>, settings: Settings) -> Result<Self, StrategyError> {
        let (domain, seed, completion) = (tune.space.domain()?, tune.config.seed, Completion::new(tune.trial.measure));
        Ok(Self { settings, domain, seed, by_parts: false, completion })
    }

    fn suggestion<const N: usize>(&self, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Suggestion, StrategyError> {
        let finished = self.completion.completed(past.finished, logs)?;
        let (history, parts) = observations_with_parts(&finished, past.running);
        let Self { settings, seed, .. } = self;
        // Length-scales and the trust region are shares of what can be searched.
        let domain = &past.allowed.map_or_else(|| self.domain.clone(), |allowed| self.domain.up_to(allowed.highest()));
        Ok(if self.by_parts {
            suggest_sum(settings, domain, past.allowed, &history, &parts, *seed)?
        } else {
            suggest_allowed(settings, domain, past.allowed, &history, *seed)?
        })
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

    fn propose(&self, _number: usize, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Proposal, StrategyError> {
        let suggestion = self.suggestion(past, logs)?;
        let origin = match suggestion.phase {
            Phase::Design => Origin::Design,
            Phase::Model | Phase::Repeat => Origin::Model,
        };
        Ok(Proposal { theta: suggestion.point, origin })
    }

    fn expected_gain(&self, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Option<ExpectedGain>, StrategyError> {
        Ok(self.suggestion(past, logs)?.evidence.map(|evidence| evidence.expected_gain))
    }
}

/// Trials as the optimiser takes them, by number: an aborted one has failed, its penalised cost beside it. One that was stopped
/// for reasons of its own says nothing against its parameters: what it cost (completed, see `completion.rs`) counts without penalty, and a
/// glimpse counts for nothing.
pub fn observations(finished: &[FinishedTrial], running: &[RunningTrial]) -> History {
    observations_with_parts(finished, running).0
}

/// The same, and beside each trial that has not failed the twelve parts of its cost: maxima, then means.
fn observations_with_parts(finished: &[FinishedTrial], running: &[RunningTrial]) -> (History, Vec<Vec<f64>>) {
    let finished = finished.iter().filter_map(|trial| {
        let cost = &trial.cost;
        let outcome = match trial.aborted {
            None => Outcome::Value(cost.total()),
            Some(AbortReason::Stopped) if cost.part_seen() >= TELLING_PART => {
                Outcome::Value(cost.total() - cost.penalty)
            }
            Some(AbortReason::Stopped) => return None,
            Some(_) => Outcome::Failed { value: Some(cost.total()), part: Some(cost.part_seen()) },
        };
        let parts = match outcome {
            Outcome::Value(_) => cost.max.iter().chain(&cost.mean).copied().collect(),
            _ => Vec::new(),
        };
        Some((trial.number, &trial.theta, outcome, parts))
    });
    let running = running.iter().map(|trial| (trial.number, &trial.theta, Outcome::Pending, Vec::new()));
    let mut trials: Vec<_> = finished.chain(running).collect();
    trials.sort_by_key(|(number, ..)| *number);
    let (observed, parts) = trials
        .into_iter()
        .map(|(_, theta, outcome, parts)| (Observation { point: theta.clone(), outcome }, parts))
        .unzip();
    (History { trials: observed }, parts)
}
