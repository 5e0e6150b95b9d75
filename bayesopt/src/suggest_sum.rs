//! The next point to try, where the cost is a sum of which every part is known.

use crate::acquisition::{Part, SumLogEi};
use crate::surrogate_model::SurrogateModel;
use crate::{Allowed, BayesoptError, Domain, History, ModelSettings, Observation, Outcome, Settings, Suggestion};

/// [`suggest()`](crate::suggest()) for `y = Σ_k c_k`, all c_k >= 0: one Gaussian process per part and Monte-Carlo LogEI of the sum
/// ([`SumLogEi`]) in the trust region of the whole. `parts` has the parts of every trial of the history that did not fail, and
/// nothing for the others; the evidence is that of the whole. Only what is `allowed` is proposed by the model.
///
/// # Errors
/// Those of [`suggest()`](crate::suggest()); `DimensionMismatch` where a trial has other parts than the first, or `parts` another length than
/// the history.
pub fn suggest_sum(
    settings: &Settings,
    domain: &Domain,
    allowed: Option<&dyn Allowed>,
    history: &History,
    parts: &[Vec<f64>],
    seed: u64,
) -> Result<Suggestion, BayesoptError> {
    settings.validate(domain)?;
    let count = parts.iter().map(Vec::len).max().unwrap_or(0);
    if parts.len() != history.len() {
        return Err(BayesoptError::DimensionMismatch { need: history.len(), got: parts.len() });
    }
    let of_part = |k: usize| -> Result<History, BayesoptError> {
        let trials = history.trials.iter().zip(parts).map(|(trial, parts)| {
            let outcome = match trial.outcome {
                Outcome::Value(_) => match parts.get(k) {
                    Some(part) => Outcome::Value(*part),
                    None => return Err(BayesoptError::DimensionMismatch { need: count, got: parts.len() }),
                },
                Outcome::Failed { .. } => Outcome::FAILED,
                Outcome::Pending => Outcome::Pending,
            };
            Ok(Observation { point: trial.point.clone(), outcome })
        });
        Ok(History { trials: trials.collect::<Result<_, _>>()? })
    };
    crate::suggest::suggest_by(settings, (domain, allowed), history, seed, |model, whole| {
        // Where trials fail is the whole's to know.
        let model = &ModelSettings { feasibility: false, ..model.clone() };
        let mut parts = Vec::with_capacity(count);
        for k in 0..count {
            match SurrogateModel::of(model, domain, &of_part(k)?, seed)? {
                Some(SurrogateModel { gp, targets, .. }) => parts.push(Part { gp, targets }),
                None => return Ok(None),
            }
        }
        let best = whole.targets.cost(whole.best_target);
        Ok(Some(SumLogEi::new(parts, best, model.sd_factor, seed, history.len())))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six maxima of many, each a function of two of six coordinates: what one model of the sum sees as a tangle.
    fn parts(x: &[f64]) -> Vec<f64> {
        (0..6).map(|k| 0.02 + (x[k] - 0.3).abs() + 0.5 * (x[k] - x[(k + 1) % 6]).abs()).collect()
    }

    #[test]
    fn finds_more_than_the_whole_alone() {
        let domain = Domain::unit_cube(6).unwrap();
        let settings = Settings::bo(vec![0.05; 6]);
        let run = |by_parts: bool, seed: u64| -> f64 {
            let (mut history, mut known) = (History::new(), Vec::new());
            for _ in 0..25 {
                let suggestion = if by_parts {
                    suggest_sum(&settings, &domain, None, &history, &known, seed)
                } else {
                    crate::suggest(&settings, &domain, &history, seed)
                };
                let point = suggestion.unwrap().point;
                known.push(parts(&point));
                history.push(point.clone(), Outcome::Value(parts(&point).iter().sum()));
            }
            history.incumbent().unwrap().1
        };
        let total = |by_parts| (1..=4).map(|seed| run(by_parts, seed)).sum::<f64>() / 4.0;
        let (sum, whole) = (total(true), total(false));
        assert!(sum < whole && sum < 1.0, "{sum} {whole}");
        assert_eq!(run(true, 1).to_bits(), run(true, 1).to_bits());
    }

    #[test]
    fn parts_must_fit_the_history() {
        let domain = Domain::unit_cube(2).unwrap();
        let settings = Settings { init_trials: 2, ..Settings::bo(vec![0.5; 2]) };
        let mut history = History::new();
        for k in 0..4 {
            history.push(settings.design_point(&domain, k, 1).unwrap(), Outcome::Value(1.0 + k as f64));
        }
        assert!(suggest_sum(&settings, &domain, None, &history, &[], 1).is_err());
        let uneven = [vec![1.0, 2.0], vec![1.0], vec![1.0, 2.0], vec![1.0, 2.0]];
        assert!(suggest_sum(&settings, &domain, None, &history, &uneven, 1).is_err());
        history.push(vec![0.1, 0.9], Outcome::FAILED);
        let even: Vec<Vec<f64>> = (0..5).map(|k| if k == 4 { vec![] } else { vec![0.5, 0.5 + k as f64] }).collect();
        let suggestion = suggest_sum(&settings, &domain, None, &history, &even, 1).unwrap();
        assert!(suggestion.point.iter().all(|u| (0.0..=1.0).contains(u)) && suggestion.evidence.is_some());
    }
}
