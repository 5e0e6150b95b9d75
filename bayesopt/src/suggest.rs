//! The next point to try.

use serde::{Deserialize, Serialize};

use crate::gp::{FEWEST_SAMPLES, Fit, Gp, fit};
use crate::search::{Bounds, maximise_acquisition};
use crate::settings::ModelSettings;
use crate::transform::Targets;
use crate::trust_region::TrustRegion;
use crate::{BayesoptError, Domain, History, Settings};

/// Who chose a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// The design.
    Design,
    /// The model.
    Model,
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
    /// State of the trust region, where one is used.
    pub trust_region: Option<TrustRegion>,
}

/// `x_{n+1} = argmax a(x | D_n)`, or the next point of the design.
///
/// A pure function of (settings, domain, history, seed): a killed campaign goes on by replaying its
/// history. The index of the trial is the length of the history, pending trials included. Pending
/// trials are believed at their posterior mean (kriging believer, Ginsbourger et al. 2010).
///
/// # Errors
/// A setting out of range, a history that does not fit the domain, or a kernel matrix beyond repair.
pub fn suggest(
    settings: &Settings,
    domain: &Domain,
    history: &History,
    seed: u64,
) -> Result<Suggestion, BayesoptError> {
    settings.validate(domain)?;
    let trial = history.len();
    let unit_points: Vec<Vec<f64>> =
        history.trials.iter().map(|trial| domain.to_unit(&trial.point)).collect::<Result<_, _>>()?;

    // The design first; and again while the model has nothing to learn from.
    let model = settings.model.as_ref().filter(|_| trial >= settings.init_trials);
    let targets = model.map(|model| model.transform.targets(history));
    let (Some(model), Some(targets)) = (model, targets.filter(|t| t.values.len() >= FEWEST_SAMPLES)) else {
        let point = settings.design_point(domain, trial, seed)?;
        return Ok(Suggestion { trial, point, phase: Phase::Design, acquisition: None, evidence: None });
    };
    let observed: Vec<Vec<f64>> = targets.trials.iter().map(|&i| unit_points[i].clone()).collect();

    // Hyper-parameters from the observations, posterior from these and the pending trials.
    let fit = fit_hyper_parameters(model, &observed, &targets.values, seed, trial)?;
    let gp = condition(model, &fit, observed, &targets, history, &unit_points)?;

    // The incumbent, and the region around it.
    let (best_at, best_target) = least(&targets.values);
    let incumbent = &unit_points[targets.trials[best_at]];
    let dimension = domain.dimension();
    let trust_region = model
        .trust_region_above
        .filter(|&above| dimension > above)
        .map(|_| TrustRegion::replay(history, settings.init_trials, dimension));
    let region =
        trust_region.map_or_else(|| Bounds::unit_cube(dimension), |tr| tr.bounds(incumbent, &fit.hyper.lengthscales));

    // The most promising point of the region.
    let found = maximise_acquisition(
        &gp,
        model.acquisition,
        best_target,
        &region,
        Some(incumbent),
        &unit_points,
        &model.search,
        seed,
        trial,
    );
    let posterior = gp.posterior_slope(&found.point).at;
    let evidence = ModelEvidence {
        jitter: gp.jitter(),
        observations: targets.values.len(),
        best_target,
        mean: posterior.mean,
        sd: posterior.sd,
        predicted_cost: targets.cost(posterior.mean),
        trust_region,
        fit,
    };
    Ok(Suggestion {
        trial,
        point: domain.from_unit(&found.point)?,
        phase: Phase::Model,
        acquisition: Some(found.value),
        evidence: Some(evidence),
    })
}

/// Fits to all observations, or, above `fit_limit`, to the best half and the latest half of that many.
fn fit_hyper_parameters(
    model: &ModelSettings,
    observed: &[Vec<f64>],
    values: &[f64],
    seed: u64,
    trial: usize,
) -> Result<Fit, BayesoptError> {
    let (n, limit) = (values.len(), model.fit.fit_limit);
    if n <= limit {
        return fit(&model.fit, observed, values, seed ^ trial as u64);
    }
    let mut by_value: Vec<usize> = (0..n).collect();
    by_value.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut kept: Vec<usize> = by_value[..limit / 2].to_vec();
    let latest = (0..n).rev().filter(|i| !by_value[..limit / 2].contains(i)).take(limit - limit / 2);
    kept.extend(latest);
    kept.sort_unstable();
    let points: Vec<Vec<f64>> = kept.iter().map(|&i| observed[i].clone()).collect();
    let targets: Vec<f64> = kept.iter().map(|&i| values[i]).collect();
    fit(&model.fit, &points, &targets, seed ^ trial as u64)
}

/// The posterior given the observations and, at their posterior means, the pending trials.
fn condition(
    model: &ModelSettings,
    fit: &Fit,
    observed: Vec<Vec<f64>>,
    targets: &Targets,
    history: &History,
    unit_points: &[Vec<f64>],
) -> Result<Gp, BayesoptError> {
    let family = model.fit.family;
    let pending: Vec<Vec<f64>> = (0..history.len())
        .filter(|&i| history.trials[i].outcome.is_pending())
        .map(|i| unit_points[i].clone())
        .collect();
    let gp = Gp::new(family, &fit.hyper, observed.clone(), &targets.values)?;
    if pending.is_empty() {
        return Ok(gp);
    }
    let believed = gp.posterior_batch(&pending);
    let values: Vec<f64> = targets.values.iter().copied().chain(believed.iter().map(|p| p.mean)).collect();
    Gp::new(family, &fit.hyper, observed.into_iter().chain(pending).collect(), &values)
}

/// Index and value of the least target; the first of equals.
fn least(values: &[f64]) -> (usize, f64) {
    let first = (0, values[0]);
    values.iter().copied().enumerate().fold(first, |best, (i, v)| if v < best.1 { (i, v) } else { best })
}
