//! Least squares on the logs of past trials, then local search.

use tribo_bayesopt::{Domain, Settings, suggest};
use tribo_friction::identify::{Basis, GlsFit, GlsSample, GlsSettings, SavitzkyGolay, fit_from_wrench};
use tribo_robot::{Arm, ControlTerms};

use super::bayes::observations;
use super::{FinishedTrial, LogSource, Origin, Proposal, Strategy, StrategyError};
use crate::{ParameterSpace, TrialLog, TunedLaw, ValidTune};

/// Trials whose parameters come straight from least squares, after the first without compensation.
const REFITS: usize = 3;
/// Logs that the fit looks back on: two track a robot that warms up, and lose nothing on one that does not.
const LOGS: usize = 2;

/// The default strategy.
///
/// ```text
/// trial 0      no compensation
/// trials 1–3   θ = generalised least squares on the last two logs (see `tribo_friction::identify::fit_from_wrench`)
/// then         Bayesian optimisation in a small box around that θ
/// ```
///
/// The estimator's wrench in free motion is the friction that was not compensated, seen through a known matrix; one
/// trial therefore tells nearly all there is to know, and 50 blind ones do not.
pub struct GreyBox {
    space: ParameterSpace,
    domain: Domain,
    model: Arm<7>,
    delay_s: f64,
    gls: GlsSettings,
    seed: u64,
}

impl GreyBox {
    /// The strategy for these settings.
    pub fn new(tune: &ValidTune) -> Result<Self, StrategyError> {
        let space = tune.space;
        let basis = match space.law {
            TunedLaw::CoulombViscous | TunedLaw::GazSigmoid => Basis::CoulombViscous,
            TunedLaw::Stribeck => Basis::Stribeck,
        };
        let mut gls = GlsSettings::new(basis);
        for (name, low, high) in space.entries() {
            let column = match *name {
                "viscous_nm_s_per_rad" => 0,
                "coulomb_nm" => 1,
                "breakaway_minus_coulomb_nm" => 2,
                _ => continue,
            };
            (gls.lower[column], gls.upper[column]) = (*low, *high);
        }
        Ok(Self {
            space,
            domain: space.domain()?,
            model: tune.trial.model.clone(),
            delay_s: estimator_delay_s(tune),
            gls,
            seed: tune.config.seed,
        })
    }

    /// Friction identified from the logs of the last trials.
    pub fn identify(&self, history: &[FinishedTrial], logs: &dyn LogSource) -> Result<GlsFit<7>, StrategyError> {
        let mut samples = Vec::new();
        for trial in history.iter().rev().take(LOGS) {
            samples.extend(identification_samples(&self.model, &logs.log(trial.number)?, self.delay_s));
        }
        Ok(fit_from_wrench(&samples, &self.gls)?)
    }

    /// Box of half-width `max(2 sd, 2 % of the domain)` around θ, inside the domain.
    fn neighbourhood(&self, theta: &[f64], fit: &GlsFit<7>) -> Result<Domain, StrategyError> {
        let per_joint = self.space.entries().len();
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        for (k, &centre) in theta.iter().enumerate() {
            let (low, high) = (self.domain.lower()[k], self.domain.upper()[k]);
            let sd = fit.sd[k / per_joint].get(k % per_joint).copied().unwrap_or(0.0);
            let half = (2.0 * sd).max(0.02 * (high - low));
            lower.push((centre - half).max(low));
            upper.push((centre + half).min(high));
        }
        Ok(Domain::new(self.domain.names().to_vec(), lower, upper)?)
    }
}

impl Strategy for GreyBox {
    fn design(&self, number: usize) -> Result<Option<Proposal>, StrategyError> {
        Ok((number == 0).then(|| Proposal { theta: self.space.zero(), origin: Origin::Constant }))
    }

    fn propose(
        &self,
        number: usize,
        history: &[FinishedTrial],
        logs: &dyn LogSource,
    ) -> Result<Proposal, StrategyError> {
        let fit = self.identify(history, logs)?;
        let theta = self.space.theta(&fit.friction);
        if number <= REFITS {
            return Ok(Proposal { theta, origin: Origin::LeastSquares });
        }
        let near = self.neighbourhood(&theta, &fit)?;
        let inside = |trial: &&FinishedTrial| {
            trial.theta.iter().enumerate().all(|(k, x)| (near.lower()[k]..=near.upper()[k]).contains(x))
        };
        let seen: Vec<FinishedTrial> = history.iter().filter(inside).cloned().collect();
        let settings = Settings { init_trials: 0, ..Settings::bo(theta) };
        let suggestion = suggest(&settings, &near, &observations(&seen), self.seed.wrapping_add(number as u64))?;
        Ok(Proposal { theta: suggestion.point, origin: Origin::Model })
    }
}

fn estimator_delay_s(tune: &ValidTune) -> f64 {
    let ekf = tribo_ekf::WrenchEkf::new(tune.config.ekf);
    tribo_robot::WrenchEstimator::<7>::delay_s(&ekf)
}

/// Time the estimator is given to forget its start [s].
const SETTLE_S: f64 = 0.5;
/// Half-width of the Savitzky–Golay window, in samples of 10 ms.
const DERIVATIVE_HALF_WIDTH: usize = 10;

/// Regression samples of one trial: wrench and W now, velocity and compensation one estimator delay earlier.
///
/// W = J̄ᵀ = Λ J B⁻¹ of the controller's model at the measured configuration; velocity by zero-phase differentiation.
pub fn identification_samples(model: &Arm<7>, log: &TrialLog<7>, delay_s: f64) -> Vec<GlsSample<7>> {
    let filter = SavitzkyGolay { half_width: DERIVATIVE_HALF_WIDTH };
    let qd: Vec<Vec<f64>> = (0..7)
        .map(|j| filter.derivative(&log.q.iter().map(|q| q[j]).collect::<Vec<_>>(), log.period_s))
        .collect();
    let delay = (delay_s / log.period_s).round() as usize;
    let settle = (SETTLE_S / log.period_s).round() as usize;
    let still = nalgebra::SVector::zeros();
    (settle.max(delay)..log.len())
        .filter_map(|k| {
            let terms = ControlTerms::at(model, &log.q[k], &still);
            let b_inverse_jt = terms.mass_matrix.cholesky()?.solve(&terms.jacobian.transpose());
            let lambda = (terms.jacobian * b_inverse_jt).cholesky()?;
            Some(GlsSample {
                wrench: log.wrench[k],
                wrench_from_torque: lambda.solve(&b_inverse_jt.transpose()),
                qd: nalgebra::SVector::from_fn(|j, _| qd[j][k - delay]),
                tau_compensation: log.tau_friction[k - delay],
            })
        })
        .collect()
}
