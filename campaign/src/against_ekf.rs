//! What a choice of estimator costs or gains.

use tribo_trial::EstimatorName;

use crate::numbered_trial::{noise_seed, run_estimated};
use crate::{CampaignError, CampaignResult, TuneConfig, ValidTune, run_in_memory};

/// The parameters that a campaign of another estimator found, judged by the EKF beside those that the EKF finds itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgainstEkf {
    /// J by the EKF of the campaign's best parameters.
    pub cost: f64,
    /// J by the EKF of the best parameters of the same campaign with the EKF as its estimator.
    pub cost_of_ekf_campaign: f64,
}

impl AgainstEkf {
    /// `cost / cost_of_ekf_campaign − 1`: above 0 the choice of estimator costs, below it gains.
    pub fn excess(&self) -> f64 {
        self.cost / self.cost_of_ekf_campaign - 1.0
    }
}

/// Runs the same campaign in memory with the EKF and judges both results on noise that neither has seen; `None` for a
/// campaign of the EKF, or one without a finished trial.
///
/// # Errors
/// [`CampaignError`] of the second campaign.
pub fn against_ekf<const N: usize>(
    tune: &ValidTune<N>,
    result: &CampaignResult,
) -> Result<Option<AgainstEkf>, CampaignError> {
    let Some(best) = result.conclusion.best else { return Ok(None) };
    if tune.config.residual == EstimatorName::Ekf {
        return Ok(None);
    }
    let config = TuneConfig { residual: EstimatorName::Ekf, ..result.config.clone() };
    let ekf = config.validate::<N>()?;
    let of_ekf = run_in_memory(&ekf)?;
    let Some(ekf_best) = of_ekf.conclusion.best else { return Ok(None) };
    let judged = |theta: &[f64]| {
        let seed = noise_seed(ekf.config.seed, UNSEEN);
        run_estimated(&ekf, &ekf.trial, &ekf.space.friction(theta), seed).map(|outcome| outcome.cost.total())
    };
    Ok(Some(AgainstEkf {
        cost: judged(&result.trials[best.trial].theta)?,
        cost_of_ekf_campaign: judged(&of_ekf.trials[ekf_best.trial].theta)?,
    }))
}

/// Stream of noise that no trial and no reference cost uses.
const UNSEEN: u64 = u64::MAX - 100;
