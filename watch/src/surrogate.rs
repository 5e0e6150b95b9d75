//! The Gaussian process over the trials of a campaign.

use tribo_bayesopt::{BayesoptError, Settings, Slice, SurrogateModel};

use super::CampaignSnapshot;
use tribo_campaign::strategy::{FinishedTrial, StrategyName, observations};

/// The surrogate model of J after the trials so far: slices through the incumbent, and how much each parameter matters.
#[derive(Clone, Debug, PartialEq)]
pub struct Surrogate {
    /// Whose surrogate it is, as a sentence.
    pub whose: &'static str,
    /// Trials behind it.
    pub trials: usize,
    /// The cheapest of them, as the process counts failures.
    pub incumbent: usize,
    /// Names of the parameters.
    pub names: Vec<String>,
    /// One slice per parameter.
    pub slices: Vec<Slice>,
    /// Value of each parameter at the incumbent.
    pub incumbent_theta: Vec<f64>,
    /// Length-scale of each parameter, in widths of its range [-]: short is relevant.
    pub lengthscales: Vec<f64>,
    /// Whether the acquisition is a logarithm.
    pub log_acquisition: bool,
}

/// Points of a slice.
const POINTS: usize = 81;
/// Latest trials behind the process at most: a fit costs their cube.
const MOST_TRIALS: usize = 300;

impl Surrogate {
    /// The surrogate model of a campaign; none where fewer than three different parameter vectors were tried.
    ///
    /// # Errors
    /// A kernel matrix beyond repair.
    pub fn of(campaign: &CampaignSnapshot) -> Result<Option<Self>, BayesoptError> {
        let tune = &campaign.tune;
        let (space, config) = (tune.space(), tune.config());
        let first = campaign.trials.len().saturating_sub(MOST_TRIALS);
        let history: Vec<FinishedTrial> =
            campaign.trials[first..].iter().map(|watched| watched.trial.clone()).collect();
        let mut different: Vec<&[f64]> = Vec::new();
        for trial in &history {
            if different.len() < 3 && !different.contains(&trial.theta.as_slice()) {
                different.push(&trial.theta);
            }
        }
        let (settings, whose) = match config.strategy {
            StrategyName::Paper => (Settings::paper(), "the process that chooses the trials"),
            StrategyName::Bo => (Settings::bo(space.zero()), "the process that chooses the trials"),
            StrategyName::GreyBox => (
                Settings::bo(space.zero()),
                "a process over the parameters; the strategy's own one lives on corrections to its least-squares fits",
            ),
            _ => (Settings::bo(space.zero()), "a process fitted for this view; the strategy does not look at it"),
        };
        let domain = space.domain()?;
        let Some(model) = settings.model.filter(|_| different.len() == 3) else { return Ok(None) };
        let Some(surrogate) = SurrogateModel::of(&model, &domain, &observations(&history, &[]), config.seed)? else {
            return Ok(None);
        };
        let slices = (0..domain.dimension()).map(|k| surrogate.slice(k, POINTS)).collect::<Result<_, _>>()?;
        let incumbent = &history[surrogate.incumbent];
        Ok(Some(Self {
            whose,
            trials: history.len(),
            incumbent: incumbent.number,
            names: domain.names().to_vec(),
            slices,
            incumbent_theta: incumbent.theta.clone(),
            lengthscales: surrogate.fit.hyper.lengthscales,
            log_acquisition: model.acquisition == tribo_bayesopt::acquisition::Acquisition::LogEi,
        }))
    }
}
