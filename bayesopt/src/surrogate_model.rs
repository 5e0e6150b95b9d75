//! What the model believes after the trials so far.

use crate::acquisition::{AcquisitionFunction, Criterion, OfFinished, OneOutput};
use crate::gp::{Contender, FEWEST_SAMPLES, Fit, Gp, fit_best};
use crate::incumbent::{Incumbent, is_noisy};
use crate::kernel::KernelShape;
use crate::settings::ModelSettings;
use crate::transform::Targets;
use crate::{BayesoptError, Domain, Feasibility, History};

/// The Gaussian process from which the next point is chosen, and what undoes its transform.
///
/// [`suggest()`](crate::suggest()) maximises the acquisition on this very surrogate model; [`Self::slice`] shows it.
#[derive(Clone, Debug)]
pub struct SurrogateModel {
    /// The process, on the unit cube and standardised targets.
    pub gp: Gp,
    /// What its kernel is made of.
    pub shape: KernelShape,
    /// Its hyper-parameters and how their fit ended.
    pub fit: Fit,
    /// The targets it was conditioned on.
    pub targets: Targets,
    /// Where trials fail; none where none has, or the settings do not ask.
    pub feasibility: Option<Feasibility>,
    /// The best trial: that with the least target, or, of noisy costs, with the least posterior mean.
    pub incumbent: usize,
    /// Its target, or its posterior mean.
    pub best_target: f64,
    /// Whether costs are noisy: the fitted noise is above 1e-4 of the variance of the targets, and no point that was tried twice cost the
    /// same to rounding.
    pub noisy: bool,
    /// Whether the noise deviation is above a tenth of that of the targets, and the incumbent's lead is within one deviation of its
    /// difference to the runner-up.
    pub doubtful: bool,
    settings: ModelSettings,
    domain: Domain,
    incumbent_unit: Vec<f64>,
}

/// The surrogate model along one coordinate through the incumbent, all others held.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Values of the coordinate, real units.
    pub at: Vec<f64>,
    /// Cost that the posterior mean stands for: the median of the cost, which is transformed monotonically.
    pub median: Vec<f64>,
    /// Lower and upper end of the central 95 % of the noise-free cost.
    pub band95: Vec<[f64; 2]>,
    /// The acquisition; a logarithm where the settings ask for it.
    pub acquisition: Vec<f64>,
}

/// Noise variance of standardised targets above which another trial of the incumbent can tell more than a new point: a deviation of
/// a tenth of theirs. What a kernel does not follow of a repeatable cost seldom looks as large.
const REPEAT_ABOVE: f64 = 1e-2;

/// 97.5 % quantile of the standard normal.
const Z95: f64 = 1.959_963_984_540_054;

impl SurrogateModel {
    /// The surrogate model after `history`; none while there is too little to learn from.
    ///
    /// # Errors
    /// A history that does not fit the domain, or a kernel matrix beyond repair.
    pub fn of(
        settings: &ModelSettings,
        domain: &Domain,
        history: &History,
        seed: u64,
    ) -> Result<Option<Self>, BayesoptError> {
        let unit_points: Vec<Vec<f64>> =
            history.trials.iter().map(|trial| domain.to_unit(&trial.point)).collect::<Result<_, _>>()?;
        let mut candidates = settings.transform.candidates(history);
        let trials = &candidates[0].trials;
        if trials.len() < FEWEST_SAMPLES {
            return Ok(None);
        }
        let observed: Vec<Vec<f64>> = trials.iter().map(|&i| unit_points[i].clone()).collect();

        // Transform, kernel and hyper-parameters from the observations, posterior from these and the pending trials.
        let (chosen, shape, fit) = fit_to_costs(settings, &observed, &candidates, seed, history.len())?;
        let targets = candidates.swap_remove(chosen);
        let gp = condition(shape, &fit, observed.clone(), &targets, history, &unit_points)?;
        let noisy = settings.noise_aware && is_noisy(fit.hyper.noise_variance, &observed, &targets.values);
        let believed = if noisy {
            let did_finish = |&i: &usize| history.trials[targets.trials[i]].outcome.success().is_some();
            let finished: Vec<usize> = (0..observed.len()).filter(did_finish).collect();
            Incumbent::believed(&gp, &observed, &finished)
        } else {
            None
        };
        let Incumbent { at, target: best_target, doubtful } =
            believed.unwrap_or_else(|| Incumbent::observed(&targets.values));
        let doubtful = doubtful && fit.hyper.noise_variance > REPEAT_ABOVE;
        let incumbent = targets.trials[at];
        let incumbent_unit = unit_points[incumbent].clone();
        let feasibility =
            if settings.feasibility { Feasibility::of(&settings.fit, history, &unit_points, seed)? } else { None };
        let (settings, domain) = (settings.clone(), domain.clone());
        Ok(Some(Self {
            gp,
            fit,
            targets,
            shape,
            feasibility,
            incumbent,
            best_target,
            noisy,
            doubtful,
            settings,
            domain,
            incumbent_unit,
        }))
    }

    /// What the next point maximises, feasibility apart.
    pub fn criterion(&self) -> Criterion {
        let ModelSettings { acquisition, sd_factor, .. } = self.settings;
        Criterion { acquisition, best: self.best_target, sd_factor }
    }

    /// The surrogate model at `points` values of `coordinate`, evenly over its range, with the incumbent's own value among them.
    ///
    /// # Errors
    /// `DimensionMismatch` of a coordinate that the domain does not have.
    pub fn slice(&self, coordinate: usize, points: usize) -> Result<Slice, BayesoptError> {
        let dimension = self.domain.dimension();
        if coordinate >= dimension {
            return Err(BayesoptError::DimensionMismatch { need: dimension, got: coordinate });
        }
        let mut along: Vec<f64> = (0..points).map(|k| k as f64 / (points.max(2) - 1) as f64).collect();
        along.push(self.incumbent_unit[coordinate]);
        along.sort_by(f64::total_cmp);
        let at: Vec<Vec<f64>> = along
            .iter()
            .map(|u| {
                let mut point = self.incumbent_unit.clone();
                point[coordinate] = *u;
                point
            })
            .collect();
        let posterior = self.gp.posterior_batch(&at);
        let cost = |target: f64| self.targets.cost(target);
        let criterion = self.criterion();
        let own = OneOutput { gp: &self.gp, criterion: &criterion };
        let acquisition = match &self.feasibility {
            Some(feasibility) => OfFinished { acquisition: &own, feasibility }.values(&at),
            None => own.values(&at),
        };
        Ok(Slice {
            at: at.iter().map(|u| Ok(self.domain.from_unit(u)?[coordinate])).collect::<Result<_, BayesoptError>>()?,
            median: posterior.iter().map(|p| cost(p.mean)).collect(),
            band95: posterior.iter().map(|p| [cost(p.mean - Z95 * p.sd), cost(p.mean + Z95 * p.sd)]).collect(),
            acquisition,
        })
    }
}

/// Which candidate, which kernel and its fit: to all observations, or, above `fit_limit`, to the best half and the latest
/// half of that many.
fn fit_to_costs(
    model: &ModelSettings,
    observed: &[Vec<f64>],
    candidates: &[Targets],
    seed: u64,
    trial: usize,
) -> Result<(usize, KernelShape, Fit), BayesoptError> {
    let kept = kept_for_fit(&candidates[0].values, model.fit.fit_limit);
    let points: Vec<Vec<f64>> = kept.iter().map(|&i| observed[i].clone()).collect();
    let values: Vec<Vec<f64>> = candidates.iter().map(|c| kept.iter().map(|&i| c.values[i]).collect()).collect();
    let shapes = if model.shapes.is_empty() { vec![model.fit.family.into()] } else { model.shapes.clone() };
    let share = kept.len() as f64 / observed.len() as f64;
    let contenders: Vec<Contender<'_>> = (0..candidates.len())
        .flat_map(|k| shapes.iter().map(move |shape| (k, *shape)))
        .map(|(k, shape)| Contender { shape, targets: &values[k], log_jacobian: share * candidates[k].log_jacobian })
        .collect();
    let (winner, fit) = fit_best(&model.fit, &points, &contenders, seed ^ trial as u64)?;
    Ok((winner / shapes.len(), contenders[winner].shape, fit))
}

/// Indices, in order, of the observations that the hyper-parameters are fitted to. Transforms are monotone, so the targets
/// of any candidate will do.
fn kept_for_fit(values: &[f64], limit: usize) -> Vec<usize> {
    let n = values.len();
    if n <= limit {
        return (0..n).collect();
    }
    let mut by_value: Vec<usize> = (0..n).collect();
    by_value.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut kept: Vec<usize> = by_value[..limit / 2].to_vec();
    let latest = (0..n).rev().filter(|i| !by_value[..limit / 2].contains(i)).take(limit - limit / 2);
    kept.extend(latest);
    kept.sort_unstable();
    kept
}

/// The posterior given the observations and, at their posterior means, the pending trials.
fn condition(
    shape: KernelShape,
    fit: &Fit,
    observed: Vec<Vec<f64>>,
    targets: &Targets,
    history: &History,
    unit_points: &[Vec<f64>],
) -> Result<Gp, BayesoptError> {
    let pending: Vec<Vec<f64>> = (0..history.len())
        .filter(|&i| history.trials[i].outcome.is_pending())
        .map(|i| unit_points[i].clone())
        .collect();
    let mut gp = Gp::new(shape, &fit.hyper, observed, &targets.values)?;
    if pending.is_empty() {
        return Ok(gp);
    }
    // To believe one at its mean leaves the means of the others as they were.
    let believed = gp.posterior_batch(&pending);
    pending.into_iter().zip(believed).try_for_each(|(point, at)| gp.observe(point, at.mean))?;
    Ok(gp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Outcome, Settings, suggest};

    fn tried() -> (Settings, Domain, History) {
        let domain = Domain::new(vec!["a".into(), "b".into()], vec![-1.0, 0.0], vec![1.0, 4.0]).unwrap();
        let settings = Settings { init_trials: 4, ..Settings::bo(vec![0.0, 1.0]) };
        let mut history = History::new();
        for k in 0..9 {
            let point = settings.design_point(&domain, k, 3).unwrap();
            let cost = 1.0 + (point[0] - 0.2).powi(2) + 0.05 * (point[1] - 1.0).powi(2);
            history.push(
                point,
                if k == 5 { Outcome::Failed { value: Some(50.0), part: None } } else { Outcome::Value(cost) },
            );
        }
        (settings, domain, history)
    }

    /// The surrogate model that is shown is the one that chooses: same posterior at the suggested point.
    #[test]
    fn is_what_suggest_uses() {
        let (settings, domain, history) = tried();
        let evidence = suggest(&settings, &domain, &history, 3).unwrap();
        let surrogate = SurrogateModel::of(settings.model.as_ref().unwrap(), &domain, &history, 3).unwrap().unwrap();
        let at = domain.to_unit(&evidence.point).unwrap();
        let posterior = &surrogate.gp.posterior_batch(&[at])[0];
        let of_suggestion = evidence.evidence.unwrap();
        assert_eq!(surrogate.fit, of_suggestion.fit);
        assert!((posterior.mean - of_suggestion.mean).abs() < 1e-9 && (posterior.sd - of_suggestion.sd).abs() < 1e-9);
    }

    /// At the incumbent the slice passes through its cost; the band holds the median and closes at a trial.
    #[test]
    fn slices_pass_through_the_incumbent() {
        let (settings, domain, history) = tried();
        let surrogate = SurrogateModel::of(settings.model.as_ref().unwrap(), &domain, &history, 3).unwrap().unwrap();
        let (trial, cost) = history.incumbent().unwrap();
        assert_eq!(trial, surrogate.incumbent);
        for coordinate in 0..2 {
            let slice = surrogate.slice(coordinate, 41).unwrap();
            let own = history.trials[trial].point[coordinate];
            let k =
                (0..slice.at.len()).min_by(|a, b| (slice.at[*a] - own).abs().total_cmp(&(slice.at[*b] - own).abs()));
            let k = k.unwrap();
            assert!((slice.at[k] - own).abs() < 1e-12 && (slice.median[k] - cost).abs() < 0.05 * cost);
            let width = |k: usize| slice.band95[k][1] - slice.band95[k][0];
            assert!(width(k) < 0.5 * width(0).max(width(40)));
            assert!(
                (0..slice.at.len())
                    .all(|k| slice.band95[k][0] <= slice.median[k] && slice.median[k] <= slice.band95[k][1])
            );
        }
        assert!(surrogate.slice(2, 41).is_err());
    }
}
