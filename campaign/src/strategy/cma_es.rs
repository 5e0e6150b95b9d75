//! CMA-ES, the baseline that knows no model.

use cmaes::{CMAESOptions, DVector};
use tribo_bayesopt::Domain;

use super::{FinishedTrial, LogSource, Origin, Past, Proposal, Strategy, StrategyError};
use crate::ParameterSpace;

/// Standard deviation of the first generation, in parts of the box.
const FIRST_SD: f64 = 0.3;
/// Growth of the cost with the squared distance from the box, in parts of the box.
const WALL: f64 = 10.0;
/// What a trial without cost counts as: worse than any.
const NO_COST: f64 = f64::MAX;

/// Covariance matrix adaptation (hansen2016) from the centre of the box, population `4 + ⌊3 ln d⌋`, points outside the box are put on
/// its wall and cost more, by a factor that grows with the way; else the search would wander off unpunished. An aborted trial counts with its penalty.
///
/// The crate minimises a function; what is wanted is the next point of a search whose costs come from a journal. So the search
/// is run again from its seed, told the costs that are known, and asked for the first point whose cost is not.
pub(super) struct CmaEs {
    domain: Domain,
    seed: u64,
}

impl CmaEs {
    pub(super) fn new(space: &ParameterSpace, seed: u64) -> Result<Self, StrategyError> {
        Ok(Self { domain: space.domain()?, seed })
    }

    fn population(&self) -> usize {
        4 + (3.0 * (self.domain.dimension() as f64).ln()).floor() as usize
    }

    /// The point of trial `number`, the costs of all generations before its own being those of `finished`.
    fn point(&self, number: usize, finished: &[FinishedTrial]) -> Result<Vec<f64>, StrategyError> {
        let dimension = self.domain.dimension();
        let (mut evaluation, mut point) = (0, vec![0.0; dimension]);
        let objective = |x: &DVector<f64>| {
            if evaluation == number {
                point = x.as_slice().iter().map(|u| u.clamp(0.0, 1.0)).collect();
            }
            let known = finished.iter().find(|trial| trial.number == evaluation);
            evaluation += 1;
            let outside: f64 = x.iter().map(|u| (u - u.clamp(0.0, 1.0)).powi(2)).sum();
            known.map_or(NO_COST, |trial| trial.cost.total() * (1.0 + WALL * outside))
        };
        let options = CMAESOptions::new(vec![0.5; dimension], FIRST_SD)
            .population_size(self.population())
            .parallel_update(false)
            .seed(self.seed);
        let mut search = options.build(objective).map_err(|error| StrategyError::CmaEs(format!("{error:?}")))?;
        for _ in 0..=number / self.population() {
            // What the crate takes for the end of a search is none here: the budget is the campaign's.
            let _ = search.next();
        }
        drop(search);
        Ok(self.domain.from_unit(&point)?)
    }
}

impl<const N: usize> Strategy<N> for CmaEs {
    fn design(&self, number: usize) -> Result<Option<Proposal>, StrategyError> {
        if number >= self.population() {
            return Ok(None);
        }
        Ok(Some(Proposal { theta: self.point(number, &[])?, origin: Origin::Design }))
    }

    fn propose(&self, number: usize, past: Past<'_>, _: &dyn LogSource<N>) -> Result<Proposal, StrategyError> {
        Ok(Proposal { theta: self.point(number, past.finished)?, origin: Origin::Model })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bounds, TunedLaw};
    use tribo_trial::Cost;

    fn search(seed: u64) -> CmaEs {
        let space = ParameterSpace { law: TunedLaw::CoulombViscous, bounds: Bounds::Literal, box_scale: vec![1.0; 7] };
        CmaEs::new(&space, seed).unwrap()
    }

    fn told(number: usize, theta: Vec<f64>, max: f64) -> FinishedTrial {
        let cost = Cost { max: [max, 0.0, 0.0, 0.0, 0.0, 0.0], ..Cost::default() };
        FinishedTrial { number, theta, cost, aborted: None, origin: Origin::Design }
    }

    /// On a sphere it comes down twentyfold, and every proposal is the same when it is asked for again.
    #[test]
    fn comes_down_and_is_a_function_of_the_costs_before() {
        let (cma, mut finished) = (search(3), Vec::new());
        let target: Vec<f64> = cma.domain.from_unit(&[0.3; 14]).unwrap();
        for number in 0..800 {
            let theta = cma.point(number, &finished).unwrap();
            assert_eq!(theta, cma.point(number, &finished).unwrap());
            assert!(cma.domain.to_unit(&theta).is_ok(), "outside the box");
            let distance = theta.iter().zip(&target).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            finished.push(told(number, theta, distance));
        }
        let best = |trials: &[FinishedTrial]| trials.iter().map(|t| t.cost.total()).fold(f64::INFINITY, f64::min);
        assert!(best(&finished) < 0.05 * best(&finished[..11]), "{} {}", best(&finished[..11]), best(&finished));
        assert_ne!(search(4).point(0, &[]).unwrap(), cma.point(0, &[]).unwrap());
    }
}
