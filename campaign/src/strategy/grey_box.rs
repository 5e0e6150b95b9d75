//! Least squares on the logs of past trials, then local search.

use std::sync::{Arc, Mutex, PoisonError};

use tribo_bayesopt::{Domain, ExpectedGain, Settings, suggest};
use tribo_friction::FrictionModel;
use tribo_friction::identify::GlsFit;
use tribo_trial::{AbortReason, CostMeasure};

use super::bayes::observations;
use super::completion::Completion;
use super::identification::{Identification, basis_column};
use super::replay::Replay;
use super::{
    BestTrial, FinishedTrial, LawChange, LogSource, Origin, Past, Proposal, RunningTrial, Strategy, StrategyError,
};
use crate::{ParameterSpace, ValidTune};

/// Trials whose parameters come straight from least squares, after the first without compensation.
const REFITS: usize = 3;
/// Logs that decide which trial is the best: the last ones, as a robot warms up, of trials whose J is at most so many times the least. Where more
/// friction was left the arm moved differently, and its log says little of better parameters.
const DECIDING: usize = 4;
const NEAR: f64 = 1.1;
/// Deviation of J between trials of the same parameters, as a part of J: 2 to 3 % on simulated arms of every friction law. It counts as
/// much as [`TRIALS_WORTH`] trials that show it.
const REPEATABILITY: f64 = 0.025;
const TRIALS_WORTH: f64 = 2.0;
/// Trials near the best without which nobody knows whether another one gains: J has come down and stays there.
const FEWEST: usize = 2;
/// Trials for which two that were stopped make the next ones more careful.
const CAREFUL_FOR: usize = 6;
/// Trials in a row that were stopped, or cost more than [`NEAR`] the best one, after which the next one promises nothing.
const HOPELESS: usize = 5;
/// Part of the largest possible change of J by the next fit that counts as its gain.
const SETTLING: f64 = 0.5;
/// Trials in a row that cost the same, after which fits that still move no longer promise anything.
const STAYS: usize = 3;
/// Part of the repeatability by which another law must lower J in the replays. All are judged on the same noise: where a law is right the other one
/// gains less than a hundredth of that.
const PAYS: f64 = 0.1;
/// The same of a later trial that takes the place of an earlier one as the best: a replay takes the motion as it was, and what it promises below
/// this comes true no more often than not.
const OUTDOES: f64 = 0.4;
/// Trial from which on parameters are fitted to two logs, the second of them of a compensated arm.
const TWO_LOGS: usize = 2;
/// Largest correction where the law does not explain the first log, as a part of the parameter and of its prior deviation [-].
const WIDE: [f64; 2] = [0.5, 0.2];

/// The default strategy.
///
/// ```text
/// trial 0      no compensation
/// trials 1 …   θ_k = generalised least squares on the last two logs (`tribo_friction::identify::fit_from_wrench`)
/// then         θ_k + S δ,  δ in [−1, 1]^d by Bayesian optimisation of J over all δ tried so far
/// ```
///
/// The estimator's wrench in free motion is the friction that was not compensated, seen through a known matrix; one
/// trial therefore tells nearly all there is to know, and 50 blind ones do not. The least-squares part is refitted at
/// every trial and so follows a robot that warms up; the correction δ is what a law of the wrong shape, the estimator's
/// noise and the maxima in J leave to gain. S holds the standard deviations of the first fit, so a correction never
/// leaves what the data allow.
///
/// A campaign hardly ever comes so far: by default it ends once the next fit promises less than J repeats ([`crate::StopBelow`]). What it
/// promises, and which trial is the best, the last logs tell: each is replayed with the parameters of every trial, so that all are judged on
/// the same noise. On simulated arms the fits of trials 1 to 3 differ by less than 1 % of J, whatever the friction law, and
/// corrections by Bayesian optimisation gain nothing but luck: run again, their winners are up to 3 % worse.
///
/// Least squares is as good as its law. [`super::LawCheck`] asks the first log whether the law holds on parts of it that were not fitted;
/// where it does not, S grows to half of each parameter. Where the Stribeck law promises to lower J by a quarter of a percent or more, the campaign
/// goes over to it ([`LawChange`]), unless it was told to keep its law.
///
/// Two trials that were stopped for what their compensators did are followed by smaller steps. One that somebody stopped delays the end of least
/// squares by one. Where trials run elsewhere, several at once, least squares takes the last logs that have come back, and a trial that would
/// repeat one still running gets a correction instead. Before the first log there is nothing but to try without
/// compensation again.
pub struct GreyBox<const N: usize> {
    space: ParameterSpace,
    domain: Domain,
    identification: Arc<Identification<N>>,
    /// The space and identification of the law to go over to, where that is allowed.
    other_law: Option<(ParameterSpace, Identification<N>)>,
    completion: Completion,
    measure: CostMeasure,
    seed: u64,
    /// The best trial, and of how many: replays take as long as trials.
    best_of: Mutex<Option<(usize, Option<BestTrial>)>>,
}

impl<const N: usize> GreyBox<N> {
    /// The strategy for these settings, with the identification of the same settings.
    pub fn new(tune: &ValidTune<N>, identification: Arc<Identification<N>>) -> Result<Self, StrategyError> {
        let space = tune.space.clone();
        let completion = Completion::new(tune.trial.measure);
        let (measure, seed) = (tune.trial.measure, tune.config.seed);
        let other_law = match tune.with_richer_law() {
            Some(richer) => Some((richer.space.clone(), Identification::new(&richer)?)),
            None => None,
        };
        let (domain, best_of) = (space.domain()?, Mutex::new(None));
        Ok(Self { space, domain, identification, other_law, completion, measure, seed, best_of })
    }

    /// Scale S of the correction: the standard deviation of each parameter in the first fit, or [`WIDE`] where the law is
    /// wrong and its deviations mean nothing; zero for parameters that least squares does not touch.
    fn scales(&self, first: &GlsFit<N>, law_holds: bool) -> Vec<f64> {
        let per_joint = self.space.parameters_per_joint();
        let centre = self.space.theta(&first.friction);
        let scale = |(k, (name, _, _)): (usize, &(&str, f64, f64))| {
            let Some(column) = basis_column(name) else { return 0.0 };
            let sd = first.sd[k / per_joint][column];
            if law_holds {
                sd
            } else {
                sd.max(WIDE[0] * centre[k].abs() + WIDE[1] * self.identification.prior_sd(k / per_joint, column))
            }
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

    /// J of each of these compensators in each of the last logs, scaled to what the trial of the log cost; none before there is a log of
    /// a trial with compensation that was seen to its end.
    #[inline(never)]
    fn replayed(
        &self,
        frictions: &[FrictionModel<N>],
        finished: &[FinishedTrial],
        logs: &dyn LogSource<N>,
    ) -> Result<Vec<Vec<f64>>, StrategyError> {
        let mut costs = vec![Vec::new(); frictions.len()];
        self.each_replay(finished, logs, |trial, replay| {
            let scale = trial.cost.total() / replay.cost(&replay.compensated);
            if scale.is_finite() {
                for (costs, friction) in costs.iter_mut().zip(frictions) {
                    costs.push(scale * replay.cost(friction));
                }
            }
        })?;
        Ok(costs)
    }

    /// The most by which J can differ between two compensators, in the mean over the last logs.
    fn largest_change(
        &self,
        [one, other]: &[FrictionModel<N>; 2],
        finished: &[FinishedTrial],
        logs: &dyn LogSource<N>,
    ) -> Result<f64, StrategyError> {
        let mut changes = Vec::new();
        self.each_replay(finished, logs, |_, replay| changes.push(replay.largest_change(one, other)))?;
        Ok(if changes.is_empty() { 0.0 } else { mean(&changes) })
    }

    /// Shows each of the last logs, with its trial, to `look`.
    fn each_replay(
        &self,
        finished: &[FinishedTrial],
        logs: &dyn LogSource<N>,
        mut look: impl FnMut(&FinishedTrial, &Replay<'_, N>),
    ) -> Result<(), StrategyError> {
        for trial in self.deciding(finished) {
            if let Some(samples) = self.identification.samples(trial.number, logs)? {
                let own = self.space.friction(&trial.theta);
                look(trial, &samples.replay(own, self.measure));
            }
        }
        Ok(())
    }

    /// The trials with compensation that were seen to their end and cost little more than the cheapest of them.
    fn near_the_best<'a>(&self, finished: &'a [FinishedTrial]) -> Vec<&'a FinishedTrial> {
        let zero = self.space.zero();
        let compensated = || finished.iter().filter(|trial| trial.aborted.is_none() && trial.theta != zero);
        let least = compensated().map(|trial| trial.cost.total()).fold(f64::INFINITY, f64::min);
        compensated().filter(|trial| trial.cost.total() <= NEAR * least).collect()
    }

    /// The last of these, whose logs tell what other parameters cost.
    fn deciding<'a>(&self, finished: &'a [FinishedTrial]) -> Vec<&'a FinishedTrial> {
        self.near_the_best(finished).into_iter().rev().take(DECIDING).collect()
    }

    /// Least squares, moved back towards the last compensator that held: half of the way for each of the last few trials but one that was
    /// stopped for what its compensator did. The log of the first one says what was wrong, as a rule.
    fn backed_off(&self, mut theta: Vec<f64>, finished: &[FinishedTrial]) -> Vec<f64> {
        let failures = finished.iter().rev().take(CAREFUL_FOR).filter(|trial| trial.failed()).count();
        let held = finished.iter().rev().find(|trial| trial.aborted.is_none());
        if let Some(held) = held.filter(|_| failures > 1) {
            let part = 0.5_f64.powi(failures as i32 - 1);
            for (theta, held) in theta.iter_mut().zip(&held.theta) {
                *theta = held + part * (*theta - held);
            }
        }
        theta
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

    #[inline(never)]
    fn better_law(&self, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Option<LawChange>, StrategyError> {
        let Some((space, identification)) = &self.other_law else { return Ok(None) };
        let next = next(past);
        if self.deciding(past.finished).is_empty() || !past.running.is_empty() {
            return Ok(None);
        }
        let (Some(own), Some(other)) = (self.identification.before(next, logs)?, identification.before(next, logs)?)
        else {
            return Ok(None);
        };
        // A law that its box cuts off is not the wrong law.
        let theta = self.space.theta(&own.friction);
        if !self.space.at_bounds(&theta).is_empty() {
            return Ok(None);
        }
        let frictions = [self.space.friction(&theta), space.friction(&space.theta(&other.friction))];
        let costs = self.replayed(&frictions, past.finished, logs)?;
        if costs[0].is_empty() {
            return Ok(None);
        }
        let [cost, other_cost] = [&costs[0], &costs[1]].map(|costs| mean(costs));
        let expected_gain = cost - other_cost;
        let change = LawChange { law: space.law, from_trial: next, cost, expected_gain };
        Ok((expected_gain > PAYS * repeatability(&costs[0])).then_some(change))
    }

    #[inline(never)]
    fn best(&self, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Option<BestTrial>, StrategyError> {
        let mut known = self.best_of.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, best)) = known.filter(|(trials, _)| *trials == past.finished.len()) {
            return Ok(best);
        }
        // A trial that cost much more is not the best, whatever the others' logs say of its parameters.
        let complete = self.near_the_best(past.finished);
        let frictions: Vec<FrictionModel<N>> = complete.iter().map(|trial| self.space.friction(&trial.theta)).collect();
        let costs = self.replayed(&frictions, past.finished, logs)?;
        let expected = complete.iter().zip(&costs).filter(|(_, costs)| !costs.is_empty());
        let expected = expected.map(|(trial, costs)| (trial, mean(costs), costs));
        let least = expected.clone().min_by(|a, b| a.1.total_cmp(&b.1));
        // Of equals the earliest that two logs speak for: nothing is known to be gained by the later ones.
        let best = least.and_then(|(_, least, costs)| {
            let equal = least + OUTDOES * repeatability(costs);
            let mut equals = expected.filter(|(_, cost, _)| *cost <= equal);
            let on_two_logs = equals.clone().find(|(trial, ..)| trial.number >= TWO_LOGS);
            on_two_logs.or_else(|| equals.next())
        });
        let best = best.map(|(trial, cost, costs)| BestTrial {
            trial: trial.number,
            cost,
            sd: Some(repeatability(costs) / (costs.len() as f64).sqrt()),
            seen: trial.cost.total(),
        });
        *known = Some((past.finished.len(), best));
        Ok(best)
    }

    #[inline(never)]
    fn expected_gain(&self, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Option<ExpectedGain>, StrategyError> {
        if !past.running.is_empty() {
            return Ok(None);
        }
        // Where one trial after the other is stopped, or worse than one before, the next one gains nothing that is worth it.
        let best = past.finished.iter().map(|trial| trial.cost.total()).fold(f64::INFINITY, f64::min);
        let in_vain =
            |trial: &&FinishedTrial| trial.failed() || trial.aborted.is_none() && trial.cost.total() > NEAR * best;
        if past.finished.iter().rev().take_while(in_vain).count() >= HOPELESS {
            return Ok(Some(ExpectedGain { gain: 0.0, repeatability: REPEATABILITY * best, best }));
        }
        if self.deciding(past.finished).len() < FEWEST {
            return Ok(None);
        }
        let next = next(past);
        let (Some(best), Some(fit)) = (self.best(past, logs)?, self.identification.before(next, logs)?) else {
            return Ok(None);
        };
        let mut theta = self.backed_off(self.space.theta(&fit.friction), past.finished);
        if let Some(allowed) = past.allowed {
            allowed.hold_back(&mut theta);
        }
        let Some(incumbent) = past.finished.iter().find(|trial| trial.number == best.trial) else { return Ok(None) };
        let frictions = [&incumbent.theta, &theta].map(|theta| self.space.friction(theta));
        let costs = self.replayed(&frictions, past.finished, logs)?;
        let repeatability = repeatability(&costs[0]);
        // Fits that still move have not settled, even where the replay of an estimator that bends the wrench sees no gain in it; on a robot
        // that warms up they go on moving, and J stays where it is.
        let unsettled = match stays(past.finished, repeatability) {
            true => 0.0,
            false => SETTLING * self.largest_change(&frictions, past.finished, logs)?,
        };
        let gain = (mean(&costs[0]) - mean(&costs[1])).max(unsettled);
        Ok(Some(ExpectedGain { gain, repeatability, best: best.cost }))
    }

    #[inline(never)]
    fn propose(&self, number: usize, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Proposal, StrategyError> {
        let (Some(fit), Some(first)) =
            (self.identification.before(number, logs)?, self.identification.first_before(number, logs)?)
        else {
            return Ok(Proposal { theta: self.space.zero(), origin: Origin::Constant });
        };
        let known = self.identification.known_before(number);
        let law_holds = self.identification.law_check(known, logs)?.is_none_or(|check| check.passed());
        let theta = self.backed_off(self.space.theta(&fit.friction), past.finished);
        // A fit that was never seen to its end is not tried yet.
        let settled = match self.expected_gain(past, logs)? {
            Some(at) => at.gain < at.repeatability,
            None => false,
        };
        let stopped = past.finished.iter().filter(|trial| trial.aborted == Some(AbortReason::Stopped)).count();
        if (!settled && past.running.is_empty() || number <= REFITS + stopped)
            && past.running.iter().all(|trial| trial.theta != theta)
        {
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

/// The trial after those that have finished.
fn next(past: Past<'_>) -> usize {
    past.finished.iter().map(|trial| trial.number + 1).max().unwrap_or(0)
}

/// Whether the last trials were all seen to their end and cost the same, within what J repeats.
fn stays(finished: &[FinishedTrial], repeatability: f64) -> bool {
    let last = &finished[finished.len().saturating_sub(STAYS)..];
    let costs = last.iter().map(|trial| trial.cost.total());
    let (least, most) = costs.fold((f64::INFINITY, 0.0_f64), |(least, most), cost| (least.min(cost), most.max(cost)));
    last.len() == STAYS && last.iter().all(|trial| trial.aborted.is_none()) && most - least < 2.0 * repeatability
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Deviation of J between trials of the same parameters, from what they show and from what is usual.
fn repeatability(costs: &[f64]) -> f64 {
    let mean = mean(costs);
    let seen = costs.iter().map(|cost| (cost - mean).powi(2)).sum::<f64>();
    let usual = TRIALS_WORTH * (REPEATABILITY * mean).powi(2);
    ((seen + usual) / (TRIALS_WORTH + costs.len() as f64 - 1.0)).sqrt()
}
