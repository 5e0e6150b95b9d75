//! A trial as a function of the campaign's settings and its number.

use tribo_friction::FrictionModel;
use tribo_trial::{AnyEstimator, EstimatorError, Trial, TrialOutcome, run_trial};

use crate::ValidTune;

/// Runs trial `number` with parameters θ: the noise depends on the campaign's seed and the number alone, and a truth
/// that warms up has run all trials before.
///
/// # Errors
/// Parameters that the estimator cannot work with.
pub fn run_numbered<const N: usize>(
    tune: &ValidTune<N>,
    number: usize,
    theta: &[f64],
) -> Result<TrialOutcome<N>, EstimatorError> {
    let (trial, seed) = tune.numbered(number);
    run_estimated(tune, &trial, &tune.space.friction(theta), seed)
}

impl<const N: usize> ValidTune<N> {
    /// The trial of that number, and the seed of its noise.
    pub fn numbered(&self, number: usize) -> (Trial<N>, u64) {
        let mut trial = self.trial.clone();
        if let Some(warm_up) = &mut trial.truth.warm_up {
            warm_up.operated_s = number as f64 * trial.reference.total_s();
        }
        let seed = noise_seed(self.config.seed, number as u64);
        // Two further draws of the same stream: whether somebody stops this trial, and when.
        let [whether, when] = [1, 2].map(|draw| unit(noise_seed(seed, draw)));
        if whether < self.config.failure_rate {
            trial.stopped_at_s = Some(when * trial.reference.duration_s);
        }
        (trial, seed)
    }
}

#[inline(never)]
pub(crate) fn run_estimated<const N: usize>(
    tune: &ValidTune<N>,
    trial: &Trial<N>,
    friction: &FrictionModel<N>,
    seed: u64,
) -> Result<TrialOutcome<N>, EstimatorError> {
    let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, trial, friction)?;
    Ok(run_trial(trial, friction, estimator, seed))
}

/// The upper 53 bits as a number in [0, 1).
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

/// SplitMix64 of seed and stream: neighbouring trials get unrelated noise.
pub fn noise_seed(seed: u64, stream: u64) -> u64 {
    let mut z = seed.wrapping_add(stream.wrapping_mul(0x9E37_79B9_7F4A_7C15)).wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
