//! Projected L-BFGS beside argmin's L-BFGS on what the optimiser descends: `cargo bench -p tribo-bayesopt --bench descent`.
//!
//! ```text
//! argmin:   x = mid + half sin z,   an infinite value is a large one,   the best point it was shown counts
//! ```
//!
//! Likelihoods of Gaussian processes on samples of the six functions, with and without a prior, with the tolerances of a fit and box and start of one without a prior; and
//! bowls whose minimum lies on the box, as those of friction compensation do. Not a test: its table is in `BENCHMARKS.md`.

#[allow(dead_code, reason = "shared with tests")]
#[path = "../tests/optimiser/common/friction.rs"]
mod friction;
#[allow(dead_code, reason = "shared with tests")]
#[path = "../tests/optimiser/common/random_source.rs"]
mod random_source;
#[allow(dead_code, reason = "shared with tests")]
#[path = "../tests/optimiser/common/standard.rs"]
mod standard;
#[path = "../tests/optimiser/common/standardised.rs"]
mod standardised;

use std::cell::RefCell;
use std::time::{Duration, Instant};

use argmin::core::{CostFunction, Error, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use random_source::RandomSource;
use standardised::standardised;
use tribo_bayesopt::gp::{HyperPrior, Lengthscales, MarginalLikelihood};
use tribo_bayesopt::kernel::KernelFamily;
use tribo_bayesopt::search::{Bounds, Descent, minimise};

/// Samples and seeds of each function.
const SAMPLES: [usize; 2] = [20, 60];
const SEEDS: u64 = 5;
/// What argmin is told of a value that is not finite.
const WALL: f64 = 1e6;
/// Starts in z stay this far from the ends of the sine, where it has no slope.
const INSIDE: f64 = 0.98;
/// Excess over the better of two descents from which on one has missed the minimum; in nats per sample for likelihoods.
const MISSED: f64 = 1e-3;

/// A cost of the unit cube.
type Cost = fn(&[f64]) -> f64;
/// Value of a point; writes its gradient.
type Function<'f> = dyn Fn(&[f64], &mut [f64]) -> f64 + 'f;

struct Problem<'f> {
    function: Box<Function<'f>>,
    start: Vec<f64>,
    bounds: Bounds,
}

/// Where a descent ended and what it took.
struct Ended {
    value: f64,
    evaluations: usize,
    time: Duration,
    failed: bool,
}

fn descent() -> Descent {
    Descent { iterations: 50, gradient_tolerance: 1e-4, value_tolerance: 1e-7, ..Descent::default() }
}

fn ours(problem: &Problem<'_>) -> Ended {
    let mut evaluations = 0;
    let counted = |x: &[f64], gradient: &mut [f64]| {
        evaluations += 1;
        (problem.function)(x, gradient)
    };
    let started = Instant::now();
    let value = minimise(counted, &problem.start, &problem.bounds, &descent()).value;
    Ended { value, evaluations, time: started.elapsed(), failed: !value.is_finite() }
}

/// A problem in z, with the last point it was asked for: argmin asks for value and gradient apart.
struct InSines<'p, 'f> {
    problem: &'p Problem<'f>,
    seen: RefCell<Seen>,
}

struct Seen {
    z: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
    best: f64,
    evaluations: usize,
}

impl InSines<'_, '_> {
    fn box_of(&self, i: usize) -> (f64, f64) {
        let Bounds { lower, upper } = &self.problem.bounds;
        (0.5 * (lower[i] + upper[i]), 0.5 * (upper[i] - lower[i]))
    }

    fn start(&self) -> Vec<f64> {
        let of = |i: usize| {
            let (mid, half) = self.box_of(i);
            ((self.problem.start[i] - mid) / half).clamp(-INSIDE, INSIDE).asin()
        };
        (0..self.problem.start.len()).map(of).collect()
    }

    fn at(&self, z: &[f64]) -> (f64, Vec<f64>) {
        let mut seen = self.seen.borrow_mut();
        if seen.z != z {
            let x: Vec<f64> = (0..z.len()).map(|i| self.box_of(i).0 + self.box_of(i).1 * z[i].sin()).collect();
            let mut gradient = vec![0.0; z.len()];
            let value = (self.problem.function)(&x, &mut gradient);
            gradient.iter_mut().enumerate().for_each(|(i, g)| *g *= self.box_of(i).1 * z[i].cos());
            if value.is_finite() {
                seen.gradient = gradient;
                seen.best = seen.best.min(value);
            }
            seen.evaluations += 1;
            (seen.z, seen.value) = (z.to_vec(), if value.is_finite() { value } else { WALL });
        }
        (seen.value, seen.gradient.clone())
    }
}

impl CostFunction for &InSines<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, z: &Vec<f64>) -> Result<f64, Error> {
        Ok(self.at(z).0)
    }
}

impl Gradient for &InSines<'_, '_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, z: &Vec<f64>) -> Result<Vec<f64>, Error> {
        Ok(self.at(z).1)
    }
}

fn argmins(problem: &Problem<'_>) -> Ended {
    let dimension = problem.start.len();
    let seen = Seen { z: Vec::new(), value: WALL, gradient: vec![0.0; dimension], best: f64::INFINITY, evaluations: 0 };
    let in_sines = InSines { problem, seen: RefCell::new(seen) };
    let Descent { iterations, gradient_tolerance, value_tolerance, memory, .. } = descent();
    let started = Instant::now();
    let solved = || -> Result<(), Error> {
        let line_search = MoreThuenteLineSearch::new().with_c(1e-4, 0.9)?;
        let solver = LBFGS::new(line_search, memory)
            .with_tolerance_grad(gradient_tolerance)?
            .with_tolerance_cost(value_tolerance)?;
        let start = in_sines.start();
        Executor::new(&in_sines, solver)
            .configure(|state| state.param(start).max_iters(iterations as u64))
            .run()
            .map(|_| ())
    };
    let failed = solved().is_err();
    let seen = in_sines.seen.borrow();
    Ended { value: seen.best, evaluations: seen.evaluations, time: started.elapsed(), failed }
}

/// Likelihoods of samples of a function, per sample, as a fit descends them.
fn likelihoods(value: Cost, dimension: usize, prior: HyperPrior) -> Vec<Problem<'static>> {
    let problem = |(samples, seed): (usize, u64)| {
        let mut source = RandomSource::seed(1001 + seed);
        let points: Vec<Vec<f64>> = (0..samples).map(|_| source.point(dimension)).collect();
        let costs: Vec<f64> = points.iter().map(|u| value(u)).collect();
        let targets = standardised(&costs);
        let function = move |theta: &[f64], gradient: &mut [f64]| {
            let (shape, lengthscales) = (KernelFamily::Matern52.into(), Lengthscales::Ard);
            let model = MarginalLikelihood { shape, lengthscales, prior, points: &points, targets: &targets };
            let Ok(at) = model.log_posterior(theta) else { return f64::INFINITY };
            gradient.iter_mut().zip(&at.gradient).for_each(|(g, ascent)| *g = -ascent / samples as f64);
            -at.value / samples as f64
        };
        let ranges = [vec![[5e-3_f64, 1e3]; dimension], vec![[1e-2, 1e3], [1e-6, 1.0]]].concat();
        let mut start = vec![(0.5 * (dimension as f64).sqrt()).ln(); dimension];
        start.extend([0.0, 1e-3_f64.ln()]);
        Problem {
            function: Box::new(function),
            start,
            bounds: Bounds {
                lower: ranges.iter().map(|range| range[0].ln()).collect(),
                upper: ranges.iter().map(|range| range[1].ln()).collect(),
            },
        }
    };
    SAMPLES.into_iter().flat_map(|samples| (0..SEEDS).map(move |seed| (samples, seed))).map(problem).collect()
}

/// Bowls of condition 100 in the unit cube whose minimum, unbounded, lies outside of it in half of the coordinates, from its middle.
fn bowls(dimension: usize) -> Vec<Problem<'static>> {
    let problem = |seed: u64| {
        let mut source = RandomSource::seed(seed);
        let middle: Vec<f64> = (0..dimension).map(|_| source.range(-0.5, 1.5)).collect();
        let function = move |x: &[f64], gradient: &mut [f64]| {
            let weight = |i: usize| 100f64.powf(i as f64 / (dimension - 1) as f64);
            gradient.iter_mut().enumerate().for_each(|(i, g)| *g = 2.0 * weight(i) * (x[i] - middle[i]));
            (0..dimension).map(|i| weight(i) * (x[i] - middle[i]).powi(2)).sum()
        };
        Problem { function: Box::new(function), start: vec![0.5; dimension], bounds: Bounds::unit_cube(dimension) }
    };
    (0..2 * SEEDS).map(problem).collect()
}

fn row(name: &str, problems: &[Problem<'_>]) {
    let ended: Vec<[Ended; 2]> = problems.iter().map(|problem| [ours(problem), argmins(problem)]).collect();
    let better = |pair: &[Ended; 2]| pair[0].value.min(pair[1].value);
    let cells = [0, 1].map(|side| {
        let excess = |pair: &[Ended; 2]| pair[side].value - better(pair);
        let missed = ended.iter().filter(|pair| excess(pair) > MISSED).count();
        let failed = ended.iter().filter(|pair| pair[side].failed).count();
        let evaluations: usize = ended.iter().map(|pair| pair[side].evaluations).sum();
        let time: Duration = ended.iter().map(|pair| pair[side].time).sum();
        let worst = ended.iter().map(excess).fold(0.0, f64::max);
        let (mean, each) = (evaluations as f64 / ended.len() as f64, time.as_secs_f64() * 1e3 / ended.len() as f64);
        format!("{missed} | {worst:.1e} | {failed} | {mean:.0} | {each:.2}")
    });
    println!("| {name} | {} | {} | {} |", problems.len(), cells[0], cells[1]);
}

fn main() {
    println!(
        "| descent | n | ours: missed | worst | errors | evaluations | ms | argmin: missed | worst | errors | evaluations | ms |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|");
    let functions: [(&str, Cost, usize); 6] = [
        ("branin2", standard::branin2, 2),
        ("hartmann6", standard::hartmann6, 6),
        ("ackley14", standard::ackley14, 14),
        ("levy14", standard::levy14, 14),
        ("fric14", friction::fric14, 14),
        ("fric35", friction::fric35, 35),
    ];
    for (name, value, dimension) in functions {
        for (with, prior) in [("prior", HyperPrior::DimensionScaled), ("no prior", HyperPrior::Flat)] {
            row(&format!("likelihood of {name}, {with}"), &likelihoods(value, dimension, prior));
        }
    }
    for dimension in [6, 14] {
        row(&format!("bowl on the box, {dimension}"), &bowls(dimension));
    }
}
