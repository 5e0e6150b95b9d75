//! The point with the largest acquisition.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::Region;
use super::projected_lbfgs::{Bounds, Descent, minimise};
use crate::acquisition::AcquisitionFunction;
use crate::design::scrambled_sobol;
use crate::random::{Purpose, scramble_key, stream};

/// How hard the acquisition is maximised.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchSettings {
    /// Sobol points over the region. Default 1000 (enough on an early prototype).
    pub candidates: usize,
    /// Random perturbations of the incumbent. Default 1000 (enough on an early prototype).
    pub perturbations: usize,
    /// Candidates refined by projected L-BFGS, half of them from the perturbations. Default 4.
    pub refined: usize,
    /// Iterations of each refinement. Default 50.
    pub iterations: usize,
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self { candidates: 1000, perturbations: 1000, refined: 4, iterations: 50 }
    }
}

/// The best point found and its acquisition.
#[derive(Debug, Clone, PartialEq)]
pub struct Maximum {
    /// Unit coordinates.
    pub point: Vec<f64>,
    /// Acquisition there.
    pub value: f64,
}

/// Perturbations have a deviation drawn log-uniformly between these, in unit coordinates:
/// from the polish of a converged run to a fifth of the box.
const PERTURBATION_SD: [f64; 2] = [1e-3, 0.2];
/// Expected number of coordinates moved by a perturbation, as in TuRBO (eriksson2019).
const MOVED_COORDINATES: f64 = 20.0;
/// Descents from one start; each but the first below what the limit cut off the one before.
const DESCENTS: usize = 4;
/// A point this close to a known one, in every coordinate, would teach nothing new.
const SAME_POINT: f64 = 1e-7;
/// A second robot sent this close to where one already is would waste its trial.
const SAME_PENDING: f64 = 1e-2;

/// `argmax a(x)` over `region`: Sobol candidates, perturbations of `incumbent`, then projected L-BFGS from the best of both.
/// Deterministic in (seed, trial), on any number of threads.
///
/// Where the region has a limit inside its box, candidates are held back to it, and so is the end of a descent, which then goes on
/// below what was cut.
///
/// Points that coincide with one of `known`, or lie within 1 % of the box of one of `pending`, are passed over; a point of
/// the region is returned in any case.
pub fn maximise_acquisition(
    acquisition: &dyn AcquisitionFunction,
    region: &Region<'_>,
    incumbent: Option<&[f64]>,
    known: &[Vec<f64>],
    pending: &[Vec<f64>],
    settings: &SearchSettings,
    seed: u64,
    trial: usize,
) -> Maximum {
    let score = |points: Vec<Vec<f64>>| {
        let values = acquisition.values(&points);
        let mut scored: Vec<Maximum> =
            points.into_iter().zip(values).map(|(point, value)| Maximum { point, value }).collect();
        scored.sort_by(|a, b| b.value.total_cmp(&a.value));
        scored
    };
    let (global, local) = rayon::join(
        || score(sobol_candidates(region, settings.candidates.max(1), seed, trial)),
        || incumbent.map_or(vec![], |x| score(perturbations(x, region, settings.perturbations, seed, trial))),
    );

    // Refine the best of both kinds; −a is minimised.
    let descent = Descent {
        iterations: settings.iterations,
        gradient_tolerance: 1e-6,
        value_tolerance: 1e-8,
        first_step: 0.05,
        ..Descent::default()
    };
    let refine = |start: &Maximum| {
        let mut objective = |x: &[f64], gradient: &mut [f64]| {
            let value = acquisition.slope(x, gradient);
            gradient.iter_mut().for_each(|slope| *slope = -*slope);
            -value
        };
        let (mut from, mut bounds) = (start.point.clone(), region.bounds().clone());
        let mut ends = Vec::new();
        for _ in 0..DESCENTS {
            let found = minimise(&mut objective, &from, &bounds, &descent);
            let mut point = found.point.clone();
            if !region.project(&mut point) {
                ends.push(Maximum { point: found.point, value: -found.value });
                break;
            }
            ends.push(Maximum { value: acquisition.values(std::slice::from_ref(&point))[0], point: point.clone() });
            for (i, upper) in bounds.upper.iter_mut().enumerate().filter(|(i, _)| point[*i] < found.point[*i]) {
                *upper = point[i].max(bounds.lower[i]);
            }
            from = point;
        }
        ends
    };
    let from_local = if local.is_empty() { 0 } else { settings.refined / 2 };
    let starts: Vec<&Maximum> =
        global.iter().take(settings.refined - from_local).chain(local.iter().take(from_local)).collect();
    let mut refined: Vec<Maximum> = starts.into_par_iter().flat_map_iter(refine).collect();

    // Best first; a known point is passed over.
    let fallback = global[0].clone();
    refined.extend(global);
    refined.extend(local);
    refined.sort_by(|a, b| b.value.total_cmp(&a.value));
    let is_near = |points: &[Vec<f64>], to: &Maximum, distance| points.iter().any(|x| within(x, &to.point, distance));
    let is_new = |found: &Maximum| !is_near(known, found, SAME_POINT) && !is_near(pending, found, SAME_PENDING);
    refined.into_iter().find(is_new).unwrap_or(fallback)
}

fn sobol_candidates(region: &Region<'_>, count: usize, seed: u64, trial: usize) -> Vec<Vec<f64>> {
    let key = scramble_key(seed, trial, Purpose::Candidates);
    let Bounds { lower, upper } = region.bounds();
    let place = |u: Vec<f64>| {
        let mut x: Vec<f64> = (0..u.len()).map(|i| lower[i] + u[i] * (upper[i] - lower[i])).collect();
        region.project(&mut x);
        x
    };
    (0..count).map(|k| place(scrambled_sobol(lower.len(), k, key))).collect()
}

fn perturbations(incumbent: &[f64], region: &Region<'_>, count: usize, seed: u64, trial: usize) -> Vec<Vec<f64>> {
    let mut rng = stream(seed, trial, Purpose::Perturbations);
    let dimension = incumbent.len();
    let share = (MOVED_COORDINATES / dimension as f64).min(1.0);
    let [least, most] = PERTURBATION_SD.map(f64::ln);
    let mut perturb = |_| {
        let sd = rng.random_range(least..most).exp();
        let always = rng.random_range(0..dimension);
        let mut x = incumbent.to_vec();
        for (i, x) in x.iter_mut().enumerate() {
            let z: f64 = StandardNormal.sample(&mut rng);
            if rng.random::<f64>() < share || i == always {
                *x += sd * z;
            }
        }
        region.project(&mut x);
        x
    };
    (0..count).map(&mut perturb).collect()
}

/// No coordinate differs by `distance` or more.
fn within(a: &[f64], b: &[f64], distance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::acquisition::{Acquisition, Criterion, OneOutput};
    use crate::gp::{Gp, HyperParameters};
    use crate::kernel::KernelFamily;
    use crate::{Allowed, Domain};

    fn gp() -> Gp {
        let hyper =
            HyperParameters { lengthscales: vec![0.3, 0.3], signal_variance: 1.0, noise_variance: 1e-6, trend: None };
        let points = vec![vec![0.1, 0.1], vec![0.9, 0.2], vec![0.5, 0.8]];
        Gp::new(KernelFamily::Matern52, &hyper, points, &[1.0, -0.5, 0.2]).unwrap()
    }

    #[test]
    fn no_point_of_a_fine_grid_is_better() {
        let gp = gp();
        for acquisition in [Acquisition::Ei, Acquisition::LogEi] {
            let region = Region::of(Bounds::unit_cube(2));
            let incumbent = [0.9, 0.2];
            let found = maximise_acquisition(
                &OneOutput { gp: &gp, criterion: &Criterion { acquisition, best: -0.5, sd_factor: 1.0 } },
                &region,
                Some(&incumbent),
                &[],
                &[],
                &SearchSettings::default(),
                1,
                3,
            );
            let grid: Vec<Vec<f64>> =
                (0..=100).flat_map(|i| (0..=100).map(move |j| vec![0.01 * i as f64, 0.01 * j as f64])).collect();
            let best = gp
                .posterior_batch(&grid)
                .iter()
                .map(|p| acquisition.evaluate(p.mean, p.sd, -0.5).value)
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(found.value >= best - 1e-9, "{acquisition:?} {found:?} {best}");
        }
    }

    #[test]
    fn known_points_are_passed_over_and_the_region_is_kept() {
        let gp = gp();
        let region = Region::of(Bounds { lower: vec![0.8, 0.1], upper: vec![1.0, 0.3] });
        let settings = SearchSettings::default();
        let criterion = Criterion { acquisition: Acquisition::LogEi, best: -0.5, sd_factor: 1.0 };
        let ask = |known: &[Vec<f64>], pending: &[Vec<f64>]| {
            let acquisition = OneOutput { gp: &gp, criterion: &criterion };
            maximise_acquisition(&acquisition, &region, Some(&[0.9, 0.2]), known, pending, &settings, 1, 3)
        };
        let first = ask(&[], &[]);
        let second = ask(std::slice::from_ref(&first.point), &[]);
        assert!(!within(&first.point, &second.point, SAME_POINT));
        let third = ask(&[], std::slice::from_ref(&first.point));
        assert!(!within(&first.point, &third.point, SAME_PENDING));
        for found in [first, second, third] {
            assert!((0.8..=1.0).contains(&found.point[0]) && (0.1..=0.3).contains(&found.point[1]));
        }
    }

    /// x₀ + x₁ ≤ 0.8, by scaling both.
    #[derive(Debug)]
    struct Budget;

    impl Allowed for Budget {
        fn highest(&self) -> &[f64] {
            &[0.8, 0.8]
        }

        fn hold_back(&self, point: &mut [f64]) {
            let sum: f64 = point.iter().sum();
            if sum > 0.8 {
                point.iter_mut().for_each(|x| *x *= 0.8 / sum);
            }
        }
    }

    #[test]
    fn no_allowed_point_of_a_fine_grid_is_better() {
        let (gp, domain) = (gp(), Domain::unit_cube(2).unwrap());
        let region = Region::within(Bounds::unit_cube(2), &domain, &Budget);
        let criterion = Criterion { acquisition: Acquisition::LogEi, best: -0.5, sd_factor: 1.0 };
        let acquisition = OneOutput { gp: &gp, criterion: &criterion };
        let incumbent = [0.6, 0.1];
        let found =
            maximise_acquisition(&acquisition, &region, Some(&incumbent), &[], &[], &SearchSettings::default(), 1, 3);
        assert!(found.point.iter().sum::<f64>() <= 0.8 + 1e-12, "{found:?}");
        let grid: Vec<Vec<f64>> =
            (0..=80).flat_map(|i| (0..=80 - i).map(move |j| vec![0.01 * f64::from(i), 0.01 * f64::from(j)])).collect();
        let best = acquisition.values(&grid).into_iter().fold(f64::NEG_INFINITY, f64::max);
        // Unlimited, it is beyond the limit.
        let free = Region::of(Bounds::unit_cube(2));
        let free =
            maximise_acquisition(&acquisition, &free, Some(&incumbent), &[], &[], &SearchSettings::default(), 1, 3);
        assert!(free.point.iter().sum::<f64>() > 0.85, "{free:?}");
        assert!(found.value >= best - 0.02 * best.abs(), "{found:?} {best}");
    }
}
