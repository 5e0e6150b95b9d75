//! Friction identified from the logs of past trials.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::SVector;
use tribo_friction::FrictionModel;
use tribo_friction::identify::{Basis, GlsError, GlsFit, GlsSample, GlsSettings, SavitzkyGolay, fit_from_wrench};
use tribo_friction::law::CoulombViscous;
use tribo_robot::{Arm, ControlTerms, WrenchEstimator};
use tribo_trial::{AnyEstimator, CostMeasure, TrialLog};

use super::replay::{Replay, STUCK_RAD_S};
use super::{LawCheck, LogSource, Standing, StrategyError};
use crate::{Batches, TunedLaw, ValidTune};

/// Whole logs that the fit looks back on: two track a robot that warms up, and lose nothing on one that does not.
const LOGS: usize = 2;
/// Part of the judged part from which on a log is a whole one.
const WHOLE: f64 = 0.9;
/// What least squares may believe, as a multiple of what may be tried: a coefficient that the box cut off would push the friction of its joint
/// onto the neighbours, as viscous friction of 24 Nm s/rad. What is tried stays in the box.
const BELIEVED: f64 = 10.0;
/// Trials whose samples are remembered: those of the fit, and of the ones beside it where trials run side by side.
const REMEMBERED: usize = 2 * LOGS;

/// Generalised least squares on the last two logs of a campaign ([`fit_from_wrench`]), for all that ask: the strategy, and the
/// guard's limit.
pub struct Identification<const N: usize> {
    model: Arm<N>,
    estimator: AnyEstimator<N>,
    gls: GlsSettings<N>,
    /// Length of a trial's judged part (s).
    judged_s: f64,
    batches: Batches,
    /// Samples of the last trials asked for: the log of a finished trial never changes.
    samples: Mutex<BTreeMap<usize, Arc<LogSamples<N>>>>,
    /// Lengths of the logs that were asked for, in the judged part (s): so that those of stopped trials are not read again and again.
    lengths_s: Mutex<BTreeMap<usize, f64>>,
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
    /// Length of the log in the judged part (s).
    judged_s: f64,
    /// Largest torque beyond gravity and Coriolis forces that was sent to each joint (Nm).
    largest_torque: SVector<f64, N>,
}

impl<const N: usize> Identification<N> {
    /// The identification for a campaign's settings.
    ///
    /// # Errors
    /// An estimator that cannot be had.
    #[inline(never)]
    pub fn new(tune: &ValidTune<N>) -> Result<Self, StrategyError> {
        let space = &tune.space;
        let basis = match space.law {
            TunedLaw::CoulombViscous | TunedLaw::GazSigmoid => Basis::CoulombViscous,
            TunedLaw::Stribeck => Basis::Stribeck,
        };
        let mut gls = GlsSettings::new(basis);
        for (k, (name, low, high)) in space.entries().into_iter().enumerate() {
            if let Some(column) = basis_column(name) {
                let joint = k / space.parameters_per_joint();
                (gls.lower[joint][column], gls.upper[joint][column]) = (low, BELIEVED * high);
            }
        }
        for (j, times) in tune.friction_scale.iter().enumerate() {
            let times = times.max(1.0);
            gls.prior_sd[j] = gls.prior_sd[j].map(|sd| times * sd);
            gls.stuck_coulomb_nm[j] *= times;
        }
        let friction = space.friction(&space.zero());
        let config = &tune.config;
        Ok(Self {
            model: tune.trial.model.clone(),
            estimator: AnyEstimator::for_tuning(config.residual, config.ekf, &tune.trial, &friction)?,
            gls,
            judged_s: config.user_trials.map_or(tune.trial.reference.duration_s, |trials| trials.judged_s),
            batches: config.batches(),
            samples: Mutex::new(BTreeMap::new()),
            lengths_s: Mutex::new(BTreeMap::new()),
            fits: Mutex::new(BTreeMap::new()),
            checks: Mutex::new(BTreeMap::new()),
        })
    }

    /// Friction identified from the last two whole logs before trial `number` and those chosen with it, and from what trials since then left
    /// that were stopped; none without a log that is long enough. A joint that stood all the time tells least squares nothing: its dry
    /// friction is taken for the largest torque that did not move it. To compensate more until it moves costs more than it gains: on the
    /// wrist of an xarm7 J was up to twice that of the joint at rest.
    ///
    /// # Errors
    /// A log that cannot be read.
    #[inline(never)]
    pub fn before(&self, number: usize, logs: &dyn LogSource<N>) -> Result<Option<GlsFit<N>>, StrategyError> {
        let number = self.batches.of(number).start;
        let mut fits = self.fits.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(fit) = fits.get(&number) {
            return Ok(Some(fit.clone()));
        }
        let taken = self.taken(number, logs)?;
        let samples: Vec<&[GlsSample<N>]> = taken.iter().map(|log| log.samples.as_slice()).collect();
        let mut fit = match fit_from_wrench(&samples, &self.gls) {
            Err(GlsError::TooFewSamples { .. }) => return Ok(None),
            fit => fit?,
        };
        fit.friction = cautious(&fit, &self.gls);
        for Standing { joint, held_nm } in standing(&taken) {
            fit.friction.joints[joint] = CoulombViscous { coulomb_nm: held_nm, viscous_nm_s_per_rad: 0.0 }.into();
        }
        fits.insert(number, fit.clone());
        Ok(Some(fit))
    }

    /// Joints that stood still in all logs that the fit before trial `number` looks at.
    ///
    /// # Errors
    /// A log that cannot be read.
    pub fn standing(&self, number: usize, logs: &dyn LogSource<N>) -> Result<Vec<Standing>, StrategyError> {
        let taken = self.taken(self.batches.of(number).start, logs)?;
        Ok(standing(&taken))
    }

    /// The logs that the fit before trial `number` looks at.
    fn taken(&self, number: usize, logs: &dyn LogSource<N>) -> Result<Vec<Arc<LogSamples<N>>>, StrategyError> {
        let (mut taken, mut whole, mut stopped_s) = (Vec::with_capacity(LOGS), 0, 0.0);
        for trial in (0..number).rev() {
            // Logs of trials that were stopped count until they make up a whole one: where one log after the other is cut short, the last
            // that was not says more.
            let is_whole = |judged_s: f64| judged_s >= WHOLE * self.judged_s;
            let enough = stopped_s >= self.judged_s;
            let known_s = self.lengths_s.lock().unwrap_or_else(PoisonError::into_inner).get(&trial).copied();
            // One that does not count is not read again to find out.
            if enough && known_s.is_some_and(|known_s| !is_whole(known_s)) {
                continue;
            }
            match self.samples(trial, logs)? {
                Some(log) if is_whole(log.judged_s) => {
                    whole += 1;
                    taken.push(log);
                }
                Some(log) if !enough => {
                    stopped_s += log.judged_s;
                    taken.push(log);
                }
                _ => {}
            }
            if whole == LOGS {
                break;
            }
        }
        Ok(taken)
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

    /// Prior standard deviation of a coefficient of a joint, by its column of [`Basis`].
    pub(super) fn prior_sd(&self, joint: usize, column: usize) -> f64 {
        self.gls.prior_sd[joint][column]
    }

    /// The first trial of the batch of trial `number`, which is chosen by the trials before that one.
    pub fn known_before(&self, number: usize) -> usize {
        self.batches.of(number).start
    }

    /// What the first log before trial `number` that is long enough says of the friction law; none without one.
    ///
    /// # Errors
    /// A log that cannot be read.
    #[inline(never)]
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
    #[inline(never)]
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
        let judged_s = log.time_s.last().map_or(0.0, |end_s| (end_s + log.period_s).max(0.0));
        let largest_torque = largest_joint_torque(&log);
        self.lengths_s.lock().unwrap_or_else(PoisonError::into_inner).insert(trial, judged_s);
        let samples = Arc::new(LogSamples { samples, judged_from, judged_s, largest_torque });
        remembered.insert(trial, Arc::clone(&samples));
        if remembered.len() > REMEMBERED {
            remembered.pop_first();
        }
        Ok(Some(samples))
    }
}

impl<const N: usize> LogSamples<N> {
    /// The judged part, taken with a compensator that believed this friction.
    pub fn replay(&self, compensated: FrictionModel<N>, measure: CostMeasure) -> Replay<'_, N> {
        Replay { samples: &self.samples[self.judged_from..], compensated, measure }
    }
}

/// The friction of a fit with one standard deviation less of viscous friction in each joint, and as much dry friction as the logs then
/// speak for: at the speeds that they show the torque hardly changes.
///
/// Too much viscous compensation is negative damping, of which a light joint shakes; too little costs next to nothing. On simulated arms
/// J is 1 % lower with it than without.
fn cautious<const N: usize>(fit: &GlsFit<N>, settings: &GlsSettings<N>) -> FrictionModel<N> {
    let joints = std::array::from_fn(|j| {
        let (mut coefficients, covariance) = (fit.coefficients[j], &fit.covariance[j]);
        let variance = covariance[VISCOUS][VISCOUS];
        if variance > 0.0 {
            let less = variance.sqrt().min(coefficients[VISCOUS] - settings.lower[j][VISCOUS]);
            for c in 0..fit.basis.columns() {
                let moved = coefficients[c] - less * covariance[c][VISCOUS] / variance;
                coefficients[c] = moved.clamp(settings.lower[j][c], settings.upper[j][c]);
            }
        }
        fit.basis.law(&coefficients)
    });
    FrictionModel { joints }
}

/// Joints that no sample of these logs shows moving; none where there is no sample.
fn standing<const N: usize>(logs: &[Arc<LogSamples<N>>]) -> Vec<Standing> {
    if logs.iter().all(|log| log.samples.is_empty()) {
        return Vec::new();
    }
    let held = logs.iter().fold(SVector::<f64, N>::zeros(), |held, log| held.sup(&log.largest_torque));
    let stands = |j: &usize| logs.iter().flat_map(|log| &log.samples).all(|sample| sample.qd[*j].abs() <= STUCK_RAD_S);
    (0..N).filter(stands).map(|joint| Standing { joint, held_nm: held[joint] }).collect()
}

fn is_finite<const N: usize>(sample: &GlsSample<N>) -> bool {
    let numbers = sample.wrench.iter().chain(sample.wrench_from_torque.iter());
    numbers.chain(sample.qd.iter()).chain(sample.tau_compensation.iter()).all(|value| value.is_finite())
}

/// Column of viscous friction in [`Basis`].
const VISCOUS: usize = 0;

/// Column of [`Basis`] that a parameter is the coefficient of.
pub(crate) fn basis_column(name: &str) -> Option<usize> {
    match name {
        "viscous_nm_s_per_rad" => Some(VISCOUS),
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
    let slides: Vec<Vec<bool>> = qd.iter().map(|qd| sliding(qd)).collect();
    let delay = (estimator.delay_s() / log.period_s).round() as usize;
    let settle = (SETTLE_S / log.period_s).round() as usize;
    let still = SVector::zeros();
    (settle.max(delay)..log.len())
        .filter_map(|k| {
            let terms = ControlTerms::at(model, &log.q[k], &still);
            let (qd, tau_compensation) = (SVector::from_fn(|j, _| qd[j][k - delay]), log.tau_friction[k - delay]);
            let wrench_from_torque = estimator.wrench_from_torque(&terms, &qd, &tau_compensation)?;
            // A sample that is no number tells nothing; one of them must not silence a whole log.
            let slides = std::array::from_fn(|j| slides[j][k - delay]);
            let sample = GlsSample { wrench: log.wrench[k], wrench_from_torque, qd, slides, tau_compensation };
            is_finite(&sample).then_some((log.time_s[k], sample))
        })
        .collect()
}

/// Where a joint slides, by its averaged velocity [rad/s], in the whole window that this is averaged over.
fn sliding(qd: &[f64]) -> Vec<bool> {
    let window = |k: usize| k.saturating_sub(DERIVATIVE_HALF_WIDTH)..(k + DERIVATIVE_HALF_WIDTH + 1).min(qd.len());
    (0..qd.len()).map(|k| qd[window(k)].iter().all(|qd| qd.abs() >= STUCK_RAD_S)).collect()
}
