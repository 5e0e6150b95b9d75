//! Fit of a Gaussian process by marginal likelihood: `cargo bench -p tribo-bayesopt --bench gaussian_process`.
//!
//! The joint-deformation regression of the peers (960 samples, six inputs, six outputs), and how a fit of its second output
//! and a hundred predictions grow with the number of samples. What the fits are worth, the example `gp_fit` tells.

#[path = "../tests/optimiser/common/deformation.rs"]
mod deformation;
#[allow(dead_code, reason = "shared with tests")]
#[path = "../tests/optimiser/common/random_source.rs"]
mod random_source;
#[path = "../tests/optimiser/common/standardised.rs"]
mod standardised;

use deformation::{circle, data};
use divan::Bencher;
use standardised::standardised;
use tribo_bayesopt::gp::{Fit, FitSettings, Gp, HyperPrior, Lengthscales, fit_coarse_to_fine};
use tribo_bayesopt::kernel::KernelFamily;

const TRAIN: usize = 960;
const SETTINGS: FitSettings = FitSettings {
    family: KernelFamily::SquaredExponential,
    lengthscales: Lengthscales::Ard,
    prior: HyperPrior::Flat,
    starts: 1,
    iterations: 100,
    fit_limit: TRAIN,
};

fn main() {
    divan::main();
}

fn fit(points: &[Vec<f64>], targets: &[f64]) -> Fit {
    fit_coarse_to_fine(&SETTINGS, points, targets, points.len() / 2, 1).expect("data that can be fitted")
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn six_outputs_960_samples(bencher: Bencher) {
    let (points, outputs) = data();
    bencher.bench_local(|| {
        outputs.iter().map(|y| fit(&points[..TRAIN], &standardised(&y[..TRAIN])).evaluations).sum::<usize>()
    });
}

#[divan::bench(args = [60, 120, 240, 480, 960], sample_count = 5, sample_size = 1)]
fn one_output(bencher: Bencher, n: usize) {
    let (points, outputs) = data();
    let targets = standardised(&outputs[1][..n]);
    bencher.bench_local(|| fit(&points[..n], &targets));
}

#[divan::bench(args = [60, 120, 240, 480, 960], sample_count = 20)]
fn hundred_predictions(bencher: Bencher, n: usize) {
    let (points, outputs) = data();
    let targets = standardised(&outputs[1][..n]);
    let found = fit(&points[..n], &targets);
    let gp =
        Gp::new(SETTINGS.family, &found.hyper, points[..n].to_vec(), &targets).expect("a positive definite kernel");
    let (at, _) = circle();
    bencher.bench_local(|| gp.posterior_batch(&at));
}
