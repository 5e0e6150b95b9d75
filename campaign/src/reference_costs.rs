//! Costs that put a result into proportion.

use rayon::prelude::*;
use tribo_friction::{FrictionModel, JointEffects};
use tribo_model::joint_effects;
use tribo_sim::Effect;
use tribo_trial::{AbortReason, EstimatorError, Trial, TrialOutcome};

use crate::ValidTune;
use crate::numbered_trial::{noise_seed, run_estimated};

/// Costs that put a campaign's result into proportion; known only in simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct References {
    /// J without compensation.
    pub uncompensated: f64,
    /// J of a controller that believes the truth: its arm, its steady friction, cold, and all effects it can cancel.
    pub oracle: f64,
    /// J of the same arm, known to the controller, without friction and without what a compensator could cancel.
    pub frictionless: f64,
    /// Why the trial with the true friction was stopped, if it was.
    pub oracle_failed: Option<AbortReason>,
}

impl References {
    /// What there is to say where no compensator can be good: the motion fails with the true friction too.
    pub fn remark(&self) -> Option<String> {
        self.oracle_failed.map(|why| {
            format!(
                "the motion fails with the true friction too ({why}), so no compensator can be judged by it: another pose, or less friction \
                 in the simulated arm, would tell more"
            )
        })
    }
}

/// The three reference costs, on noise of their own.
///
/// # Errors
/// A friction that the estimator cannot work with.
#[inline(never)]
pub fn references<const N: usize>(tune: &ValidTune<N>) -> Result<References, EstimatorError> {
    let none = FrictionModel::none();
    let no_effects = [JointEffects::default(); N];
    let uncompensated = without_compensation(tune);
    let oracle = tune.trial.clone().with_controller_model(&tune.oracle);
    let mut smooth = Trial { effects: no_effects, ..oracle.clone() };
    smooth.truth.friction = none;
    smooth.truth.effects.retain(stays_without_friction::<N>);
    let runs = [(&uncompensated, none), (&oracle, tune.oracle.friction), (&smooth, none)];
    let ended: Vec<(f64, Option<AbortReason>)> = runs
        .par_iter()
        .enumerate()
        .map(|(k, (trial, friction))| {
            let seed = noise_seed(tune.config.seed, stream(k));
            let outcome = run_estimated(tune, trial, friction, seed)?;
            Ok((outcome.cost.total(), outcome.aborted))
        })
        .collect::<Result<_, EstimatorError>>()?;
    let [uncompensated, oracle, frictionless] = [0, 1, 2].map(|run: usize| ended[run].0);
    Ok(References { uncompensated, oracle, frictionless, oracle_failed: ended[1].1 })
}

/// Streams of the noise of the three runs: no trial of a campaign has them.
fn stream(run: usize) -> u64 {
    u64::MAX - run as u64
}

/// J of a compensator that believes this friction, on the noise of [`References::oracle`].
pub(crate) fn compensated_cost<const N: usize>(
    tune: &ValidTune<N>,
    friction: &FrictionModel<N>,
) -> Result<f64, EstimatorError> {
    Ok(run_estimated(tune, &tune.trial, friction, noise_seed(tune.config.seed, stream(1)))?.cost.total())
}

/// The trial of [`References::uncompensated`] with its log: what the arm does when nobody cancels its friction.
///
/// # Errors
/// A campaign whose estimator cannot be had.
pub fn uncompensated_trial<const N: usize>(tune: &ValidTune<N>) -> Result<TrialOutcome<N>, EstimatorError> {
    let none = FrictionModel::none();
    run_estimated(tune, &without_compensation(tune), &none, noise_seed(tune.config.seed, stream(0)))
}

fn without_compensation<const N: usize>(tune: &ValidTune<N>) -> Trial<N> {
    Trial { effects: [JointEffects::default(); N], ..tune.trial.clone() }
}

/// Whether an effect belongs to the arm even when nothing acts in its joints.
fn stays_without_friction<const N: usize>(effect: &Effect) -> bool {
    !matches!(effect, Effect::ThermalFriction { .. })
        && joint_effects(std::slice::from_ref(effect)).0 == [JointEffects::default(); N]
}
