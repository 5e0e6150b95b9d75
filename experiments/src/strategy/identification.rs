//! Friction identified from the logs of past trials.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::SVector;
use tribo_friction::FrictionModel;
use tribo_friction::identify::{Basis, GlsError, GlsFit, GlsSample, GlsSettings, SavitzkyGolay, fit_from_wrench};
use tribo_friction::law::CoulombViscous;
use tribo_robot::{Arm, ControlTerms, WrenchEstimator};

use super::replay::Replay;
use super::{LawCheck, LogSource, StrategyError};
use crate::{AnyEstimator, Batches, CostMeasure, TrialLog, TunedLaw, ValidTune};

/// Logs that the fit looks back on: two track a robot that warms up, and lose nothing on one that does not.
const LOGS: usize = 2;
/// Trials whose samples are remembered: those of the fit, and of the ones beside it where trials run side by side.
const REMEMBERED: usize = 2 * LOGS;

/// Generalised least squares on the last two logs of a campaign ([`fit_from_wrench`]), for all that ask: the strategy, and the
/// guard's limit.
pub struct Identification<const N: usize> {
    model: Arm<N>,
    estimator: AnyEstimator<N>,
    gls: GlsSettings,
    batches: Batches,
    /// Samples of the last trials asked for: the log of a finished trial never changes.
    samples: Mutex<BTreeMap<usize, Arc<LogSamples<N>>>>,
    /// Fits by the first trial of a batch: each is a pure function of the logs before it, so remembering them changes nothing.
    fits: Mutex<BTreeMap<usize, GlsFit<N>>>,
    /// Checks of the law by the number of the trial whose log they are of.
    checks: Mutex<BTreeMap<usize, LawCheck>>,
}

/// What one log says.
pub(super) struct LogSamples<const N: usize> {
    samples: Vec<GlsSample<N>>,
    /// First sample of the judged part.
    judged_from: usize,
    /// Largest torque beyond gravity and Coriolis forces that was sent to each joint (Nm).
    largest_torque: SVector<f64, N>,
}

impl<const N: usize> Identification<N> {
    /// The identification for a campaign's settings.
    ///
    /// # Errors
    /// An estimator that cannot be had.
    pub fn new(tune: &ValidTune<N>) -> Result<Self, StrategyError> {
        let space = &tune.space;
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
        let widest = tune.friction_scale.iter().fold(1.0_f64, |most, scale| most.max(*scale));
        gls.prior_sd = gls.prior_sd.map(|sd| sd * widest);
        gls.stuck_coulomb_nm *= widest;
        let friction = space.friction(&space.zero());
        let (config, model) = (&tune.config, &tune.trial.model);
        Ok(Self {
            model: model.clone(),
            estimator: AnyEstimator::for_tuning(config.residual, config.ekf, model, &friction)?,
            gls,
            batches: config.batches(),
            samples: Mutex::new(BTreeMap::new()),
            fits: Mutex::new(BTreeMap::new()),
            checks: Mutex::new(BTreeMap::new()),
        })
    }

    /// Friction identified from the last logs before trial `number` and those chosen with it, further back where these are too short for a
    /// fit; none where all of them are, or without a log. A joint that stuck all the time tells
    /// least squares nothing; its dry friction is at least the largest torque that did not move it, and compensated by that
    /// it will move.
    ///
    /// # Errors
    /// A log that cannot be read.
    pub fn before(&self, number: usize, logs: &dyn LogSource<N>) -> Result<Option<GlsFit<N>>, StrategyError> {
        let number = self.batches.of(number).start;
        let mut fits = self.fits.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(fit) = fits.get(&number) {
            return Ok(Some(fit.clone()));
        }
        let (mut taken, mut found) = (Vec::with_capacity(LOGS), None);
        for trial in (0..number).rev() {
            taken.extend(self.samples(trial, logs)?);
            if taken.len() >= LOGS || (trial == 0 && !taken.is_empty()) {
                let samples: Vec<&[GlsSample<N>]> = taken.iter().map(|log| log.samples.as_slice()).collect();
                match fit_from_wrench(&samples, &self.gls) {
                    // Trials that were stopped at once: the one before them may tell more.
                    Err(GlsError::TooFewSamples { .. }) => {}
                    fit => {
                        found = Some(fit?);
                        break;
                    }
                }
            }
        }
        let Some(mut fit) = found else { return Ok(None) };
        let samples: Vec<&[GlsSample<N>]> = taken.iter().map(|log| log.samples.as_slice()).collect();
        let held = taken.iter().fold(SVector::<f64, N>::zeros(), |held, log| held.sup(&log.largest_torque));
        for j in 0..N {
            if samples.iter().copied().flatten().all(|sample| sample.qd[j].abs() <= self.gls.stuck_rad_s) {
                fit.friction.joints[j] = CoulombViscous { coulomb_nm: held[j], viscous_nm_s_per_rad: 0.0 }.into();
            }
        }
        fits.insert(number, fit.clone());
        Ok(Some(fit))
    }

    /// The first fit that trials before trial `number` allow.
    ///
    /// # Errors
    /// As [`Self::before`].
    pub fn first_before(&self, number: usize, logs: &dyn LogSource<N>) -> Result<Option<GlsFit<N>>, StrategyError> {
        for trial in 1..=number {
            if let Some(fit) = self.before(trial, logs)? {
                return Ok(Some(fit));
            }
        }
        Ok(None)
    }

    /// Speed below which a joint counts as standing [rad/s].
    pub(super) fn stuck_rad_s(&self) -> f64 {
        self.gls.stuck_rad_s
    }

    /// Prior standard deviation of a coefficient, by its column of [`Basis`].
    pub(super) fn prior_sd(&self, column: usize) -> f64 {
        self.gls.prior_sd[column]
    }

    /// The first trial of the batch of trial `number`, which is chosen by the trials before that one.
    pub fn known_before(&self, number: usize) -> usize {
        self.batches.of(number).start
    }

    /// What the first log before trial `number` that is long enough says of the friction law; none without one.
    ///
    /// # Errors
    /// A log that cannot be read.
    pub fn law_check(&self, number: usize, logs: &dyn LogSource<N>) -> Result<Option<LawCheck>, StrategyError> {
        for trial in 0..number {
            let mut checks = self.checks.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(check) = checks.get(&trial) {
                return Ok(Some(*check));
            }
            if let Some(log) = self.samples(trial, logs)? {
                let check = match LawCheck::of(&log.samples, &self.gls) {
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

    /// What the log of a finished trial says; none of one that left no log.
    ///
    /// # Errors
    /// A log that cannot be read.
    pub(super) fn samples(
        &self,
        trial: usize,
        logs: &dyn LogSource<N>,
    ) -> Result<Option<Arc<LogSamples<N>>>, StrategyError> {
        let mut remembered = self.samples.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(samples) = remembered.get(&trial) {
            return Ok(Some(Arc::clone(samples)));
        }
        let Some(log) = logs.log(trial)? else { return Ok(None) };
        let timed = timed_samples(&self.model, &log, &self.estimator);
        let judged_from = timed.iter().take_while(|(time_s, _)| *time_s < 0.0).count();
        let samples = timed.into_iter().map(|(_, sample)| sample).collect();
        let samples = Arc::new(LogSamples { samples, judged_from, largest_torque: largest_joint_torque(&log) });
        remembered.insert(trial, Arc::clone(&samples));
        if remembered.len() > REMEMBERED {
            remembered.pop_first();
        }
        Ok(Some(samples))
    }
}

impl<const N: usize> LogSamples<N> {
    /// The judged part, taken with a compensator that believed this friction.
    pub fn replay(&self, compensated: FrictionModel<N>, measure: CostMeasure, stuck_rad_s: f64) -> Replay<'_, N> {
        Replay { samples: &self.samples[self.judged_from..], compensated, measure, stuck_rad_s }
    }
}

fn is_finite<const N: usize>(sample: &GlsSample<N>) -> bool {
    let numbers = sample.wrench.iter().chain(sample.wrench_from_torque.iter());
    numbers.chain(sample.qd.iter()).chain(sample.tau_compensation.iter()).all(|value| value.is_finite())
}

/// Column of [`Basis`] that a parameter is the coefficient of.
pub(crate) fn basis_column(name: &str) -> Option<usize> {
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
    timed_samples(model, log, estimator).into_iter().map(|(_, sample)| sample).collect()
}

/// The same, each with its time since the start of the judged part (s).
fn timed_samples<const N: usize>(
    model: &Arm<N>,
    log: &TrialLog<N>,
    estimator: &AnyEstimator<N>,
) -> Vec<(f64, GlsSample<N>)> {
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
            // A sample that is no number tells nothing; one of them must not silence a whole log.
            let sample = GlsSample { wrench: log.wrench[k], wrench_from_torque, qd, tau_compensation };
            is_finite(&sample).then_some((log.time_s[k], sample))
        })
        .collect()
}
