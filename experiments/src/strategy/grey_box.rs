//! Least squares on the logs of past trials, then local search.

use std::sync::Arc;

use tribo_bayesopt::{Domain, Settings, suggest};
use tribo_friction::identify::GlsFit;

use super::bayes::observations;
use super::completion::Completion;
use super::identification::{Identification, basis_column};
use super::{FinishedTrial, LawCheck, LogSource, Origin, Past, Proposal, RunningTrial, Strategy, StrategyError};
use crate::{AbortReason, ParameterSpace, ValidTune};

/// Trials whose parameters come straight from least squares, after the first without compensation.
const REFITS: usize = 3;
/// The same where the law does not explain the first log: more fits of it would tell nothing new.
const REFITS_OF_A_WRONG_LAW: usize = 1;
/// Largest correction where the law does not explain the first log, as a part of the parameter and of the width of its box [-].
const WIDE: [f64; 2] = [0.5, 0.05];

/// The default strategy.
///
/// ```text
/// trial 0      no compensation
/// trials 1–3   θ_k = generalised least squares on the last two logs (`tribo_friction::identify::fit_from_wrench`)
/// then         θ_k + S δ,  δ in [−1, 1]^d by Bayesian optimisation of J over all δ tried so far
/// ```
///
/// The estimator's wrench in free motion is the friction that was not compensated, seen through a known matrix; one
/// trial therefore tells nearly all there is to know, and 50 blind ones do not. The least-squares part is refitted at
/// every trial and so follows a robot that warms up; the correction δ is what a law of the wrong shape, the estimator's
/// noise and the maxima in J leave to gain. S holds the standard deviations of the first fit, so a correction never
/// leaves what the data allow.
///
/// Least squares is as good as its law. [`LawCheck`] asks the first log whether the law holds on parts of it that were not fitted;
/// where it does not, there is one fit only, S grows to half of each parameter, and Bayesian optimisation carries the weight.
///
/// A trial that somebody stopped delays the end of least squares by one. Where trials run elsewhere, several at once, least squares takes the last logs that have come back, and a trial that would
/// repeat one still running gets a correction instead. Before the first log there is nothing but to try without
/// compensation again.
pub struct GreyBox<const N: usize> {
    space: ParameterSpace,
    domain: Domain,
    identification: Arc<Identification<N>>,
    completion: Completion,
    seed: u64,
}

impl<const N: usize> GreyBox<N> {
    /// The strategy for these settings, with the identification of the same settings.
    pub fn new(tune: &ValidTune<N>, identification: Arc<Identification<N>>) -> Result<Self, StrategyError> {
        let space = tune.space.clone();
        let completion = Completion::new(tune.trial.measure);
        Ok(Self { domain: space.domain()?, space, identification, completion, seed: tune.config.seed })
    }

    /// Scale S of the correction: the standard deviation of each parameter in the first fit, or [`WIDE`] where the law is
    /// wrong and its deviations mean nothing; zero for parameters that least squares does not touch.
    fn scales(&self, first: &GlsFit<N>, law_holds: bool) -> Vec<f64> {
        let per_joint = self.space.parameters_per_joint();
        let centre = self.space.theta(&first.friction);
        let scale = |(k, (name, low, high)): (usize, &(&str, f64, f64))| {
            let Some(column) = basis_column(name) else { return 0.0 };
            let sd = first.sd[k / per_joint][column];
            if law_holds { sd } else { sd.max(WIDE[0] * centre[k].abs() + WIDE[1] * (high - low)) }
        };
        self.space.entries().iter().enumerate().map(scale).collect()
    }

    /// A trial as the correction δ that it was to its own fit; none before there was a fit.
    fn correction(
        &self,
        (number, theta): (usize, &[f64]),
        (scales, free): (&[f64], &[usize]),
        logs: &dyn LogSource<N>,
    ) -> Result<Option<Vec<f64>>, StrategyError> {
        let Some(fit) = self.identification.before(number, logs)? else { return Ok(None) };
        let centre = self.space.theta(&fit.friction);
        Ok(Some(free.iter().map(|&k| ((theta[k] - centre[k]) / scales[k]).clamp(-1.0, 1.0)).collect()))
    }

    /// `θ + S δ`, inside the domain.
    fn corrected(&self, theta: &[f64], scales: &[f64], delta: &[f64]) -> Vec<f64> {
        let mut delta = delta.iter();
        let moved = theta.iter().zip(scales).map(|(centre, scale)| match scale {
            0.0 => *centre,
            _ => centre + scale * delta.next().copied().unwrap_or(0.0),
        });
        moved
            .zip(self.domain.lower().iter().zip(self.domain.upper()))
            .map(|(x, (low, high))| x.clamp(*low, *high))
            .collect()
    }
}

impl<const N: usize> Strategy<N> for GreyBox<N> {
    fn design(&self, number: usize) -> Result<Option<Proposal>, StrategyError> {
        Ok((number == 0).then(|| Proposal { theta: self.space.zero(), origin: Origin::Constant }))
    }

    fn law_check(&self, number: usize, logs: &dyn LogSource<N>) -> Result<Option<LawCheck>, StrategyError> {
        self.identification.law_check(number, logs)
    }

    fn propose(&self, number: usize, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Proposal, StrategyError> {
        let (Some(fit), Some(first)) =
            (self.identification.before(number, logs)?, self.identification.first_before(number, logs)?)
        else {
            return Ok(Proposal { theta: self.space.zero(), origin: Origin::Constant });
        };
        let known = self.identification.known_before(number);
        let law_holds = self.identification.law_check(known, logs)?.is_none_or(|check| check.passed());
        let refits = if law_holds { REFITS } else { REFITS_OF_A_WRONG_LAW };
        let theta = self.space.theta(&fit.friction);
        // A fit that was never seen to its end is not tried yet.
        let stopped = past.finished.iter().filter(|trial| trial.aborted == Some(AbortReason::Stopped)).count();
        if number <= refits + stopped && past.running.iter().all(|trial| trial.theta != theta) {
            return Ok(Proposal { theta, origin: Origin::LeastSquares });
        }
        let scales = self.scales(&first, law_holds);
        let free: Vec<usize> = (0..scales.len()).filter(|&k| scales[k] > 0.0).collect();
        let names = free.iter().map(|&k| self.domain.names()[k].clone()).collect();
        let box_of_corrections = Domain::new(names, vec![-1.0; free.len()], vec![1.0; free.len()])?;

        let (mut tried, mut running) = (Vec::new(), Vec::new());
        for trial in self.completion.completed(past.finished, logs)? {
            if let Some(theta) = self.correction((trial.number, &trial.theta), (&scales, &free), logs)? {
                tried.push(FinishedTrial { theta, ..trial });
            }
        }
        for trial in past.running {
            if let Some(theta) = self.correction((trial.number, &trial.theta), (&scales, &free), logs)? {
                running.push(RunningTrial { theta, ..trial.clone() });
            }
        }
        let settings = Settings { init_trials: 0, ..Settings::bo(vec![0.0; free.len()]) };
        let delta = suggest(&settings, &box_of_corrections, &observations(&tried, &running), self.seed)?.point;
        Ok(Proposal { theta: self.corrected(&theta, &scales, &delta), origin: Origin::Model })
    }
}
