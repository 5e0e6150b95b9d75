//! Hyper-parameters by maximum posterior density.

use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::hyper::{HyperParameters, Lengthscales};
use super::likelihood::MarginalLikelihood;
use super::prior::HyperPrior;
use crate::BayesoptError;
use crate::kernel::{KernelFamily, KernelShape};
use crate::random::{Purpose, stream};
use crate::search::{Bounds, Curvature, Descent, DescentEnd, Minimum, minimise_with};

/// What is fitted and how hard.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitSettings {
    /// ρ of the kernel.
    pub family: KernelFamily,
    /// ARD or isotropic.
    pub lengthscales: Lengthscales,
    /// Prior, or none for ML-II.
    pub prior: HyperPrior,
    /// Starting points of the ascent. Default 2: the mode of the prior and a smoother model.
    pub starts: usize,
    /// Iterations per start. Default 50; most ascents end before.
    pub iterations: usize,
    /// Most observations the hyper-parameters are fitted to; the posterior always uses all. Default 300.
    pub fit_limit: usize,
}

/// What the ascent found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// The best hyper-parameters over all starts.
    pub hyper: HyperParameters,
    /// `ln p(y|θ)` there, without prior.
    pub log_marginal_likelihood: f64,
    /// `ln p(y|θ) + ln p(θ)` there; equal under the flat prior.
    pub log_posterior: f64,
    /// How the ascent of the best start ended.
    pub end: DescentEnd,
    /// Evaluations of the likelihood over all starts.
    pub evaluations: usize,
}

/// Fewest samples whose likelihood says anything about a length-scale.
pub const FEWEST_SAMPLES: usize = 2;

/// Box of θ: ℓ in [5e-3, 1e3] of the unit cube, σ_f² in [1e-2, 1e3], σ_n² from the prior's least to 1 of standardised
/// targets, variances of the trend in [1e-6, 1e3].
/// ML-II needs the box (a flat direction has no maximum); under a prior it is inactive but for σ_n².
const LENGTHSCALE_RANGE: [f64; 2] = [5e-3, 1e3];
const SIGNAL_RANGE: [f64; 2] = [1e-2, 1e3];
const LARGEST_NOISE: f64 = 1.0;
const TREND_RANGE: [f64; 2] = [1e-6, 1e3];
/// Variance of each part of the trend where the ascents begin.
const FIRST_TREND: f64 = 0.1;

/// `θ̂ = argmax ln p(y|θ) + ln p(θ)` by multi-start projected L-BFGS on θ = (ln ℓ …, ln σ_f², ln σ_n²).
///
/// Start 0 is the mode of the prior (ℓ = ½√d, σ_f² = 1 without one), start 1 a model four times smoother,
/// later ones are drawn around start 0 from `seed`.
///
/// # Errors
/// `TooFewSamples`; `NonPositivePivot` when no start could be evaluated.
pub fn fit(settings: &FitSettings, points: &[Vec<f64>], targets: &[f64], seed: u64) -> Result<Fit, BayesoptError> {
    let model = settings.likelihood(points, targets, settings.family.into())?;
    let starts = (0..settings.starts.max(1)).map(|start| start_point(&model, start, seed)).collect();
    Ok(ascend(settings, &model, starts, &Curvature::default())?.0)
}

/// [`fit`] of a large set, in two steps: all starts on `coarse` samples spread evenly over the set, then one ascent on all
/// of it from what they found.
///
/// An evaluation costs n³, so the starts are nearly free and the last ascent begins near its end, with the curvature that
/// the first has learnt. Where the maximum of
/// the subset lies in another basin than that of the whole, the result is a local maximum that [`fit`] might better.
///
/// # Errors
/// As [`fit`].
pub fn fit_coarse_to_fine(
    settings: &FitSettings,
    points: &[Vec<f64>],
    targets: &[f64],
    coarse: usize,
    seed: u64,
) -> Result<Fit, BayesoptError> {
    let (n, coarse) = (points.len(), coarse.max(FEWEST_SAMPLES));
    if n <= coarse {
        return fit(settings, points, targets, seed);
    }
    let chosen = || (0..coarse).map(|k| k * n / coarse);
    let few: Vec<Vec<f64>> = chosen().map(|k| points[k].clone()).collect();
    let few_targets: Vec<f64> = chosen().map(|k| targets[k]).collect();
    let model = settings.likelihood(&few, &few_targets, settings.family.into())?;
    let starts = (0..settings.starts.max(1)).map(|start| start_point(&model, start, seed)).collect();
    let (first, curvature) = ascend(settings, &model, starts, &Curvature::default())?;
    let model = settings.likelihood(points, targets, settings.family.into())?;
    let (second, _) = ascend(settings, &model, vec![first.hyper.to_log(settings.lengthscales)], &curvature)?;
    Ok(Fit { evaluations: first.evaluations + second.evaluations, ..second })
}

/// A kernel, and the targets it would have to explain.
#[derive(Debug, Clone, Copy)]
pub struct Contender<'a> {
    /// The kernel.
    pub shape: KernelShape,
    /// Targets t(y) of the samples.
    pub targets: &'a [f64],
    /// `Σ ln |dt/dy|`, by which densities of different targets become densities of the same y.
    pub log_jacobian: f64,
}

/// Iterations of every contender before most of them are given up.
const SCREENING: usize = 8;
/// Contenders whose ascent is finished.
const FINALISTS: usize = 3;

/// `argmax_k  max_θ ln p(t_k(y)|θ, k) + ln p(θ) + Σ ln |dt_k/dy|`: which kernel on which targets explains y best.
///
/// All contenders begin at the mode of the prior and ascend a few steps; the best of these go on to their end, and the
/// winner is tried from its other starts too, ascents side by side on the threads of the current rayon pool. Index of the winner
/// and its fit.
///
/// # Errors
/// As [`fit`]; no contenders are `TooFewSamples`.
pub fn fit_best(
    settings: &FitSettings,
    points: &[Vec<f64>],
    contenders: &[Contender<'_>],
    seed: u64,
) -> Result<(usize, Fit), BayesoptError> {
    let likelihood = |k: usize| settings.likelihood(points, contenders[k].targets, contenders[k].shape);
    let ascend_from = |iterations, k: usize, start, curvature: &Curvature| {
        let (fit, curvature) =
            ascend(&FitSettings { iterations, ..*settings }, &likelihood(k)?, vec![start], curvature)?;
        Ok(Ascended { k, fit, curvature })
    };

    // A few steps each; one that cannot be evaluated is out.
    let few = SCREENING.min(settings.iterations);
    let mut standing = Vec::new();
    let mut failure = BayesoptError::TooFewSamples { need: 1, got: 0 };
    let screen = |k| ascend_from(few, k, start_point(&likelihood(k)?, 0, seed), &Curvature::default());
    for screened in side_by_side((0..contenders.len()).collect(), screen) {
        match screened {
            Ok(ascended) => standing.push(ascended),
            Err(error) => failure = error,
        }
    }
    let mut evaluations: usize = standing.iter().map(|ascended| ascended.fit.evaluations).sum();
    let score = |ascended: &Ascended| ascended.fit.log_posterior + contenders[ascended.k].log_jacobian;
    standing.sort_by(|a, b| score(b).total_cmp(&score(a)));
    standing.truncate(FINALISTS);
    let finish = |Ascended { k, fit, curvature }: Ascended| {
        ascend_from(settings.iterations, k, fit.hyper.to_log(settings.lengthscales), &curvature)
    };
    let mut standing = side_by_side(standing, finish).into_iter().collect::<Result<Vec<_>, _>>()?;
    evaluations += standing.iter().map(|ascended| ascended.fit.evaluations).sum::<usize>();
    standing.sort_by(|a, b| score(b).total_cmp(&score(a)));

    // The winner from where it stands and from its other starts.
    let Some(Ascended { k: winner, fit: mut best, .. }) = standing.into_iter().next() else { return Err(failure) };
    let again = |start| {
        let from = start_point(&likelihood(winner)?, start, seed);
        ascend_from(settings.iterations, winner, from, &Curvature::default())
    };
    for ascended in side_by_side((1..settings.starts).collect(), again) {
        let fit = ascended?.fit;
        evaluations += fit.evaluations;
        if fit.log_posterior > best.log_posterior {
            best = fit;
        }
    }
    Ok((winner, Fit { evaluations, ..best }))
}

/// Where the ascent of contender `k` stands, and the curvature it has learnt.
struct Ascended {
    k: usize,
    fit: Fit,
    curvature: Curvature,
}

/// Each task on its own, in the order given; the number of threads changes nothing but the time.
fn side_by_side<T: Send, U: Send>(tasks: Vec<T>, run: impl Fn(T) -> U + Sync + Send) -> Vec<U> {
    tasks.into_par_iter().map(run).collect()
}

impl FitSettings {
    fn likelihood<'a>(
        &self,
        points: &'a [Vec<f64>],
        targets: &'a [f64],
        shape: KernelShape,
    ) -> Result<MarginalLikelihood<'a>, BayesoptError> {
        if points.len() < FEWEST_SAMPLES {
            return Err(BayesoptError::TooFewSamples { need: FEWEST_SAMPLES, got: points.len() });
        }
        let Self { lengthscales, prior, .. } = *self;
        Ok(MarginalLikelihood { shape, lengthscales, prior, points, targets })
    }
}

/// The best of the ascents from `starts`, all of which begin with `curvature`, and the curvature that it ended with.
fn ascend(
    settings: &FitSettings,
    model: &MarginalLikelihood<'_>,
    starts: Vec<Vec<f64>>,
    curvature: &Curvature,
) -> Result<(Fit, Curvature), BayesoptError> {
    let points = model.points;
    let bounds = hyper_bounds(model);
    let scale = 1.0 / points.len() as f64;

    // The objective per sample, so that one tolerance fits all sizes; a failed factorisation is a wall.
    let (mut evaluations, mut work) = (0, model.workspace());
    let mut objective = |theta: &[f64], gradient: &mut [f64]| {
        evaluations += 1;
        match model.log_posterior_in(theta, &mut work) {
            Ok(at) => {
                for (g, ascent) in gradient.iter_mut().zip(&at.gradient) {
                    *g = -ascent * scale;
                }
                -at.value * scale
            }
            Err(_) => f64::INFINITY,
        }
    };
    let descent = Descent {
        iterations: settings.iterations,
        gradient_tolerance: 1e-4,
        value_tolerance: 1e-7,
        ..Descent::default()
    };

    let mut best: Option<(Minimum, Curvature)> = None;
    for start in &starts {
        let mut learnt = curvature.clone();
        let found = minimise_with(&mut objective, start, &bounds, &descent, &mut learnt);
        if found.value.is_finite() && best.as_ref().is_none_or(|(b, _)| found.value < b.value) {
            best = Some((found, learnt));
        }
    }
    // No start could be evaluated: report the pivot that stopped the first one.
    let Some((best, learnt)) = best else {
        let first = starts.first().map(|start| model.evaluate(start));
        return Err(first.and_then(Result::err).unwrap_or(BayesoptError::NonPositivePivot { index: 0 }));
    };
    let log_marginal_likelihood = model.evaluate(&best.point)?.value;
    let hyper = HyperParameters::from_log(&best.point, model.lengthscales, model.dimension());
    let log_posterior = -best.value / scale;
    Ok((Fit { hyper, log_marginal_likelihood, log_posterior, end: best.end, evaluations }, learnt))
}

fn hyper_bounds(model: &MarginalLikelihood<'_>) -> Bounds {
    let mut ranges = vec![LENGTHSCALE_RANGE; model.lengthscale_count()];
    ranges.extend([SIGNAL_RANGE, [model.prior.least_noise(), LARGEST_NOISE]]);
    ranges.resize(model.parameter_count(), TREND_RANGE);
    Bounds { lower: ranges.iter().map(|r| r[0].ln()).collect(), upper: ranges.iter().map(|r| r[1].ln()).collect() }
}

fn start_point(model: &MarginalLikelihood<'_>, start: usize, seed: u64) -> Vec<f64> {
    let count = model.lengthscale_count();
    let half_diagonal = (0.5 * (model.dimension() as f64).sqrt()).ln();
    let mut theta: Vec<f64> =
        model.priors().iter().map(|prior| prior.map_or(half_diagonal, |p| p.log_mode())).collect();
    theta[count] = 0.0;
    if model.prior == HyperPrior::Flat {
        theta[count + 1] = 1e-3_f64.ln();
    }
    theta[count + 2..].fill(FIRST_TREND.ln());
    match start {
        0 => {}
        1 => {
            theta[..count].iter_mut().for_each(|l| *l += 4.0_f64.ln());
            theta[count + 1] = 1e-4_f64.ln();
        }
        _ => {
            let mut rng = stream(seed, start, Purpose::FitStarts);
            theta.iter_mut().for_each(|t| {
                let z: f64 = StandardNormal.sample(&mut rng);
                *t += z;
            });
        }
    }
    theta
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{sobol_point, uniform_random_point};
    use crate::kernel::Structure;

    fn settings(prior: HyperPrior, lengthscales: Lengthscales) -> FitSettings {
        let family = KernelFamily::SquaredExponential;
        FitSettings { family, lengthscales, prior, starts: 3, iterations: 100, fit_limit: 300 }
    }

    #[test]
    fn relevance_is_determined() {
        let points: Vec<_> = (0..40).map(|i| sobol_point(3, i, 2)).collect();
        let targets: Vec<f64> = points.iter().map(|x| (6.0 * x[0]).sin()).collect();
        for prior in [HyperPrior::Flat, HyperPrior::DimensionScaled] {
            let fit = fit(&settings(prior, Lengthscales::Ard), &points, &targets, 1).unwrap();
            let l = &fit.hyper.lengthscales;
            assert!(l[0] < 0.6 && l[1] > 4.0 * l[0] && l[2] > 4.0 * l[0], "{fit:?}");
            assert!(fit.hyper.noise_variance < 1e-2, "{fit:?}");
        }
    }

    #[test]
    fn the_found_point_is_stationary_inside_the_box() {
        let points: Vec<_> = (0..40).map(|i| sobol_point(2, i, 3)).collect();
        let noise = uniform_random_point(40, 0, 3);
        let targets: Vec<f64> =
            points.iter().zip(noise).map(|(x, e)| (4.0 * x[0]).sin() + x[1] + 0.5 * (e - 0.5)).collect();
        let chosen = settings(HyperPrior::DimensionScaled, Lengthscales::Ard);
        let found = fit(&chosen, &points, &targets, 1).unwrap();
        let FitSettings { family, lengthscales, prior, .. } = chosen;
        let model =
            MarginalLikelihood { shape: family.into(), lengthscales, prior, points: &points, targets: &targets };
        let gradient = model.log_posterior(&found.hyper.to_log(lengthscales)).unwrap().gradient;
        assert!(gradient.iter().all(|g| g.abs() < 0.05), "{gradient:?} {found:?}");
    }

    /// The maximum of the whole set, from the other side: far more evaluations of [`fit`] find no better one.
    #[test]
    fn coarse_to_fine_ends_where_the_whole_set_does() {
        let points: Vec<_> = (0..160).map(|i| sobol_point(3, i, 5)).collect();
        let noise = uniform_random_point(160, 0, 5);
        let targets: Vec<f64> =
            points.iter().zip(noise).map(|(x, e)| (5.0 * x[0]).sin() + x[1] * x[1] + 0.2 * (e - 0.5)).collect();
        let settings = settings(HyperPrior::Flat, Lengthscales::Ard);
        let whole = fit(&settings, &points, &targets, 1).unwrap();
        let fast = fit_coarse_to_fine(&settings, &points, &targets, 40, 1).unwrap();
        // The ascents stop at 1e-7 per sample; flat directions (relevance zero) differ more than the value does.
        assert!((fast.log_marginal_likelihood - whole.log_marginal_likelihood).abs() < 0.05, "{fast:?} {whole:?}");
        assert!((fast.hyper.noise_variance / whole.hyper.noise_variance).ln().abs() < 0.05, "{fast:?} {whole:?}");
        assert_eq!(fit_coarse_to_fine(&settings, &points, &targets, 200, 1).unwrap(), whole);
    }

    #[test]
    fn the_evidence_finds_sums_and_outliers() {
        let points: Vec<_> = (0..40).map(|i| sobol_point(6, i, 7)).collect();
        let settings = settings(HyperPrior::DimensionScaled, Lengthscales::Ard);
        let shape = |structure| KernelShape { structure, ..KernelFamily::SquaredExponential.into() };
        let wins = |targets: &[f64]| {
            let contenders = [Structure::Joint, Structure::Additive].map(|structure| Contender {
                shape: shape(structure),
                targets,
                log_jacobian: 0.0,
            });
            fit_best(&settings, &points, &contenders, 1).unwrap().0
        };
        let sum: Vec<f64> = points.iter().map(|x| x.iter().map(|x| (9.0 * x).sin()).sum::<f64>() / 1.8).collect();
        let together: Vec<f64> = points.iter().map(|x| 1.5 * (3.0 * x.iter().sum::<f64>()).sin()).collect();
        assert_eq!((wins(&sum), wins(&together)), (1, 0));

        // Costs of 1000 beside costs near 1 are better seen through the logarithm, whose Jacobian says so.
        let mut history = crate::History::new();
        for x in &points {
            history.push(x.clone(), crate::Outcome::Value((6.0 * x[0] - 2.0).exp()));
        }
        let candidates = crate::CostTransform::ByEvidence { cap_factor: 1.3 }.candidates(&history);
        let contenders: Vec<_> = candidates
            .iter()
            .map(|c| Contender { shape: shape(Structure::Joint), targets: &c.values, log_jacobian: c.log_jacobian })
            .collect();
        let (winner, _) = fit_best(&settings, &points, &contenders, 1).unwrap();
        assert!(candidates[winner].logarithmic && candidates[winner].bend.is_none());
    }

    #[test]
    fn one_sample_is_too_few() {
        let got = fit(&settings(HyperPrior::Flat, Lengthscales::Isotropic), &[vec![0.5]], &[1.0], 0);
        assert_eq!(got.unwrap_err(), BayesoptError::TooFewSamples { need: 2, got: 1 });
    }
}
