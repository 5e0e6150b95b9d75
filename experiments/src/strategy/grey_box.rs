//! Least squares on the logs of past trials, then local search.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use nalgebra::SVector;
use tribo_bayesopt::{Domain, Settings, suggest};
use tribo_friction::identify::{Basis, GlsError, GlsFit, GlsSample, GlsSettings, SavitzkyGolay, fit_from_wrench};
use tribo_friction::law::CoulombViscous;
use tribo_robot::{Arm, ControlTerms, WrenchEstimator};

use super::bayes::observations;
use super::{FinishedTrial, LawCheck, LogSource, Origin, Past, Proposal, RunningTrial, Strategy, StrategyError};
use crate::{AbortReason, AnyEstimator, ParameterSpace, TrialLog, TunedLaw, ValidTune};

/// Trials whose parameters come straight from least squares, after the first without compensation.
const REFITS: usize = 3;
/// The same where the law does not explain the first log: more fits of it would tell nothing new.
const REFITS_OF_A_WRONG_LAW: usize = 1;
/// Largest correction where the law does not explain the first log, as a part of the parameter and of the width of its box [-].
const WIDE: [f64; 2] = [0.5, 0.05];
/// Logs that the fit looks back on: two track a robot that warms up, and lose nothing on one that does not.
const LOGS: usize = 2;

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
    model: Arm<N>,
    estimator: AnyEstimator<N>,
    gls: GlsSettings,
    seed: u64,
    /// Fits by trial number: each is a pure function of the logs before it, so remembering them changes nothing.
    fits: Mutex<BTreeMap<usize, GlsFit<N>>>,
    /// Checks of the law by the number of the trial whose log they are of.
    checks: Mutex<BTreeMap<usize, LawCheck>>,
}

impl<const N: usize> GreyBox<N> {
    /// The strategy for these settings.
    pub fn new(tune: &ValidTune<N>) -> Result<Self, StrategyError> {
        let space = tune.space.clone();
        let basis = match space.law {
            TunedLaw::CoulombViscous | TunedLaw::GazSigmoid => Basis::CoulombViscous,
            TunedLaw::Stribeck => Basis::Stribeck,
        };
        let mut gls = GlsSettings::new(basis);
        // The fit has one box and one prior for all joints: those of the joint with the widest.
        for (name, low, high) in space.entries().into_iter().take(space.parameters_per_joint()) {
            if let Some(column) = basis_column(name) {
                let widest =
                    space.entries().into_iter().filter(|entry| entry.0 == name).fold(high, |most, it| most.max(it.2));
                (gls.lower[column], gls.upper[column]) = (low, widest);
            }
        }
        let widest = space.box_scale.iter().fold(1.0_f64, |most, scale| most.max(*scale));
        gls.prior_sd = gls.prior_sd.map(|sd| sd * widest);
        gls.stuck_coulomb_nm *= widest;
        Ok(Self {
            domain: space.domain()?,
            model: tune.trial.model.clone(),
            estimator: AnyEstimator::for_tuning(
                tune.config.residual,
                tune.config.ekf,
                &tune.trial.model,
                &space.friction(&space.zero()),
            )?,
            space,
            gls,
            seed: tune.config.seed,
            fits: Mutex::new(BTreeMap::new()),
            checks: Mutex::new(BTreeMap::new()),
        })
    }

    /// Friction identified from the last logs before trial `number`; none without a log. A joint that stuck all the time tells
    /// least squares nothing; its dry friction is at least the largest torque that did not move it, and compensated by that
    /// it will move.
    pub fn identify(&self, number: usize, logs: &dyn LogSource<N>) -> Result<Option<GlsFit<N>>, StrategyError> {
        let mut fits = self.fits.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(fit) = fits.get(&number) {
            return Ok(Some(fit.clone()));
        }
        let (mut samples, mut held) = (Vec::new(), SVector::<f64, N>::zeros());
        let mut taken = 0;
        for trial in (0..number).rev() {
            let Some(log) = logs.log(trial)? else { continue };
            samples.extend(identification_samples(&self.model, &log, &self.estimator));
            held = held.sup(&largest_joint_torque(&log));
            taken += 1;
            if taken == LOGS {
                break;
            }
        }
        if taken == 0 {
            return Ok(None);
        }
        let mut fit = fit_from_wrench(&samples, &self.gls)?;
        for j in 0..N {
            if samples.iter().all(|sample| sample.qd[j].abs() <= self.gls.stuck_rad_s) {
                fit.friction.joints[j] = CoulombViscous { coulomb_nm: held[j], viscous_nm_s_per_rad: 0.0 }.into();
            }
        }
        fits.insert(number, fit.clone());
        Ok(Some(fit))
    }

    /// The first fit before trial `number`: its deviations are the scale of the corrections.
    fn first_fit(&self, number: usize, logs: &dyn LogSource<N>) -> Result<Option<GlsFit<N>>, StrategyError> {
        for trial in 1..=number {
            if let Some(fit) = self.identify(trial, logs)? {
                return Ok(Some(fit));
            }
        }
        Ok(None)
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
        let Some(fit) = self.identify(number, logs)? else { return Ok(None) };
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
        for trial in 0..number {
            let mut checks = self.checks.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(check) = checks.get(&trial) {
                return Ok(Some(*check));
            }
            if let Some(log) = logs.log(trial)? {
                let samples = identification_samples(&self.model, &log, &self.estimator);
                let check = match LawCheck::of(&samples, &self.gls) {
                    // Stopped too early to tell.
                    Err(GlsError::TooFewSamples { .. }) => continue,
                    check => check?,
                };
                checks.insert(trial, check);
                return Ok(Some(check));
            }
        }
        Ok(None)
    }

    fn propose(&self, number: usize, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Proposal, StrategyError> {
        let (Some(fit), Some(first)) = (self.identify(number, logs)?, self.first_fit(number, logs)?) else {
            return Ok(Proposal { theta: self.space.zero(), origin: Origin::Constant });
        };
        let law_holds = self.law_check(number, logs)?.is_none_or(|check| check.passed());
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
        for trial in past.finished {
            if let Some(theta) = self.correction((trial.number, &trial.theta), (&scales, &free), logs)? {
                tried.push(FinishedTrial { theta, ..trial.clone() });
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

/// Column of [`Basis`] that a parameter is the coefficient of.
fn basis_column(name: &str) -> Option<usize> {
    match name {
        "viscous_nm_s_per_rad" => Some(0),
        "coulomb_nm" => Some(1),
        "breakaway_minus_coulomb_nm" => Some(2),
        _ => None,
    }
}

/// Largest torque beyond gravity and Coriolis forces that was sent to each joint (Nm).
fn largest_joint_torque<const N: usize>(log: &TrialLog<N>) -> SVector<f64, N> {
    let sent = |k: usize| log.tau_task[k] + log.tau_nullspace[k] + log.tau_friction[k];
    (0..log.len()).fold(SVector::zeros(), |most, k| most.sup(&sent(k).abs()))
}

/// Time the estimator is given to forget its start (s).
const SETTLE_S: f64 = 0.5;
/// Half-width of the Savitzky–Golay window, in samples of 10 ms.
const DERIVATIVE_HALF_WIDTH: usize = 10;

/// Regression samples of one trial: wrench and W now, velocity and compensation one estimator delay earlier.
///
/// W is [`AnyEstimator::wrench_from_torque`] with the controller's model at the measured configuration (J̄ᵀ = Λ J B⁻¹ for the
/// filter); velocity by zero-phase differentiation.
pub fn identification_samples<const N: usize>(
    model: &Arm<N>,
    log: &TrialLog<N>,
    estimator: &AnyEstimator<N>,
) -> Vec<GlsSample<N>> {
    let filter = SavitzkyGolay { half_width: DERIVATIVE_HALF_WIDTH };
    let qd: Vec<Vec<f64>> =
        (0..N).map(|j| filter.derivative(&log.q.iter().map(|q| q[j]).collect::<Vec<_>>(), log.period_s)).collect();
    let delay = (estimator.delay_s() / log.period_s).round() as usize;
    let settle = (SETTLE_S / log.period_s).round() as usize;
    let still = SVector::zeros();
    (settle.max(delay)..log.len())
        .filter_map(|k| {
            let terms = ControlTerms::at(model, &log.q[k], &still);
            let (qd, tau_compensation) = (SVector::from_fn(|j, _| qd[j][k - delay]), log.tau_friction[k - delay]);
            let wrench_from_torque = estimator.wrench_from_torque(&terms, &qd, &tau_compensation)?;
            Some(GlsSample { wrench: log.wrench[k], wrench_from_torque, qd, tau_compensation })
        })
        .collect()
}
