//! The next point to try.

use serde::{Deserialize, Serialize};

use crate::acquisition::{AcquisitionFunction, OfFinished, OneOutput, SumLogEi};
use crate::gp::Fit;
use crate::kernel::KernelShape;
use crate::search::{Bounds, Maximum, Region, maximise_acquisition};
use crate::stop::ExpectedGain;
use crate::surrogate_model::SurrogateModel;
use crate::trust_region::TrustRegion;
use crate::{Allowed, BayesoptError, Domain, History, ModelSettings, Settings};

/// Who chose a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// The design.
    Design,
    /// The model.
    Model,
    /// The model, which is in doubt about the incumbent of noisy costs and has it tried again.
    Repeat,
}

/// A point to try next, with the reasons a critic would ask for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Suggestion {
    /// Index the trial will have in the history.
    pub trial: usize,
    /// The point, real units.
    pub point: Vec<f64>,
    /// Who chose it.
    pub phase: Phase,
    /// Acquisition at the point; none in the design.
    pub acquisition: Option<f64>,
    /// What the model believed; none in the design.
    pub evidence: Option<ModelEvidence>,
}

/// What the model believed when it chose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelEvidence {
    /// The kernel that explained the costs best.
    pub shape: KernelShape,
    /// Hyper-parameters, likelihood and how the fit ended.
    pub fit: Fit,
    /// Jitter on the diagonal, squared standardised targets; 0 in health.
    pub jitter: f64,
    /// Observations behind the posterior, failed ones included.
    pub observations: usize,
    /// Standardised target of the incumbent.
    pub best_target: f64,
    /// Posterior mean at the point, standardised target.
    pub mean: f64,
    /// Posterior deviation at the point, standardised target.
    pub sd: f64,
    /// The cost that `mean` stands for (the median, where the target is a logarithm).
    pub predicted_cost: f64,
    /// What the most promising point promises; `StopRule` judges it.
    pub expected_gain: ExpectedGain,
    /// State of the trust region, where one is used.
    pub trust_region: Option<TrustRegion>,
}

/// `x_{n+1} = argmax a(x | D_n)`, or the next point of the design.
///
/// A pure function of (settings, domain, history, seed): a killed campaign goes on by replaying its
/// history. The index of the trial is the length of the history, pending trials included. Pending
/// trials are believed at their posterior mean (kriging believer, ginsbourger2010).
///
/// # Errors
/// A setting out of range, a history that does not fit the domain, or a kernel matrix beyond repair.
pub fn suggest(
    settings: &Settings,
    domain: &Domain,
    history: &History,
    seed: u64,
) -> Result<Suggestion, BayesoptError> {
    suggest_allowed(settings, domain, None, history, seed)
}

/// [`suggest`], where the model proposes only what is `allowed`.
///
/// # Errors
/// Those of [`suggest`].
pub fn suggest_allowed(
    settings: &Settings,
    domain: &Domain,
    allowed: Option<&dyn Allowed>,
    history: &History,
    seed: u64,
) -> Result<Suggestion, BayesoptError> {
    suggest_by::<SumLogEi>(settings, (domain, allowed), history, seed, |_, _| Ok(None))
}

/// [`suggest`] by the acquisition function that `other` makes of the surrogate model about the whole; where it makes none, by the surrogate model's own.
pub(crate) fn suggest_by<W: AcquisitionFunction>(
    settings: &Settings,
    (domain, allowed): (&Domain, Option<&dyn Allowed>),
    history: &History,
    seed: u64,
    other: impl FnOnce(&ModelSettings, &SurrogateModel) -> Result<Option<W>, BayesoptError>,
) -> Result<Suggestion, BayesoptError> {
    settings.validate(domain)?;
    let trial = history.len();
    let unit_points: Vec<Vec<f64>> =
        history.trials.iter().map(|trial| domain.to_unit(&trial.point)).collect::<Result<_, _>>()?;

    // The design first; and again while the model has nothing to learn from.
    let model = settings.model.as_ref().filter(|_| trial >= settings.init_trials);
    let surrogate = model.map(|model| SurrogateModel::of(model, domain, history, seed)).transpose()?.flatten();
    let (Some(model), Some(surrogate)) = (model, surrogate) else {
        let point = settings.design_point(domain, trial, seed)?;
        return Ok(Suggestion { trial, point, phase: Phase::Design, acquisition: None, evidence: None });
    };
    let criterion = surrogate.criterion();
    let other = other(model, &surrogate)?;
    let SurrogateModel {
        gp, shape, fit, targets, feasibility, incumbent: incumbent_trial, best_target, doubtful, ..
    } = surrogate;

    // The incumbent, and the region around it.
    let incumbent = &unit_points[incumbent_trial];
    let dimension = domain.dimension();
    let trust_region = model
        .trust_region_above
        .filter(|&above| dimension > above)
        .map(|_| TrustRegion::replay(history, settings.init_trials, dimension));
    let region =
        trust_region.map_or_else(|| Bounds::unit_cube(dimension), |tr| tr.bounds(incumbent, &fit.hyper.lengthscales));
    let region = match allowed {
        None => Region::of(region),
        Some(allowed) => Region::within(region, domain, allowed),
    };

    // The most promising point of the region, away from where trials are being run.
    let pending: Vec<Vec<f64>> =
        (0..trial).filter(|&i| history.trials[i].outcome.is_pending()).map(|i| unit_points[i].clone()).collect();
    let own = OneOutput { gp: &gp, criterion: &criterion };
    let acquisition = other.as_ref().map_or(&own as &dyn AcquisitionFunction, |acquisition| acquisition);
    let of_finished = feasibility.as_ref().map(|feasibility| OfFinished { acquisition, feasibility });
    let acquisition = of_finished.as_ref().map_or(acquisition, |acquisition| acquisition);
    let found =
        maximise_acquisition(acquisition, &region, Some(incumbent), &unit_points, &pending, &model.search, seed, trial);
    let posterior = gp.posterior_slope(&found.point).at;
    let improvement = match &other {
        // Of a sum the acquisition is the logarithm of just that.
        Some(sum) => sum.values(std::slice::from_ref(&found.point))[0].exp(),
        None => targets.expected_improvement(posterior.mean, model.sd_factor * posterior.sd, best_target),
    };
    let at_found = std::slice::from_ref(&found.point);
    let finishes = feasibility.as_ref().map_or(1.0, |feasibility| feasibility.log_probabilities(at_found)[0].exp());
    let (best, slope) = targets.cost_and_slope(best_target);
    let expected_gain =
        ExpectedGain { gain: improvement * finishes, repeatability: slope * fit.hyper.noise_variance.sqrt(), best };

    // Unless another trial of the incumbent tells more.
    let repeats = doubtful && may_repeat(model, &unit_points, settings.init_trials) && !pending.contains(incumbent);
    let (phase, found, point) = if repeats {
        let value = acquisition.values(std::slice::from_ref(incumbent))[0];
        let found = Maximum { point: incumbent.clone(), value };
        (Phase::Repeat, found, history.trials[incumbent_trial].point.clone())
    } else {
        let point = domain.from_unit(&found.point)?;
        (Phase::Model, found, point)
    };
    let posterior = gp.posterior_slope(&found.point).at;
    let evidence = ModelEvidence {
        shape,
        jitter: gp.jitter(),
        observations: targets.values.len(),
        best_target,
        mean: posterior.mean,
        sd: posterior.sd,
        predicted_cost: targets.cost(posterior.mean),
        expected_gain,
        trust_region,
        fit,
    };
    Ok(Suggestion { trial, point, phase, acquisition: Some(found.value), evidence: Some(evidence) })
}

/// Whether the share of repeated points among the trials of the model leaves room for another.
fn may_repeat(model: &ModelSettings, points: &[Vec<f64>], init_trials: usize) -> bool {
    let repeated = (init_trials..points.len()).filter(|&i| points[..i].contains(&points[i])).count();
    let by_model = (points.len() + 1).saturating_sub(init_trials);
    model.repeat_one_in.is_some_and(|one_in| (repeated + 1) * one_in <= by_model)
}
