//! Processor time of fitting the joint-deformation regression (n = 960, d = 6, six outputs) and its error on a circle.
//!
//! `cargo run --release -p tribo-bayesopt --example gp_fit`
//!
//! Compare processor times of one thread, measured side by side: another process on the core doubles a wall time.
//! scikit-learn finds ln p = −990.992 1526.298 1062.246 −27.419 −29.272 −1107.746 from σ_f² = ℓ = 1, σ_n² = 0.1 in the same box.

#[path = "../tests/optimiser/common/deformation.rs"]
mod deformation;
#[path = "../tests/optimiser/common/random_source.rs"]
mod random_source;

use std::time::Instant;

use deformation::{circle, data};
use tribo_bayesopt::BayesoptError;
use tribo_bayesopt::gp::{FitSettings, Gp, HyperPrior, Lengthscales, fit_coarse_to_fine};
use tribo_bayesopt::kernel::KernelFamily;

fn main() -> Result<(), BayesoptError> {
    let (points, outputs) = data();
    let (at, truth) = circle();
    let settings = FitSettings {
        family: KernelFamily::SquaredExponential,
        lengthscales: Lengthscales::Ard,
        prior: HyperPrior::Flat,
        starts: 1,
        iterations: 100,
        fit_limit: 960,
    };
    let mut total_s = 0.0;
    for (j, output) in outputs.iter().enumerate() {
        let y = &output[..960];
        let mean = y.iter().sum::<f64>() / 960.0;
        let sd = (y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / 960.0).sqrt();
        let targets: Vec<f64> = y.iter().map(|y| (y - mean) / sd).collect();
        let start = Instant::now();
        let found = fit_coarse_to_fine(&settings, &points[..960], &targets, 480, 1)?;
        let wall_s = start.elapsed().as_secs_f64();
        total_s += wall_s;
        let gp = Gp::new(settings.family, &found.hyper, points[..960].to_vec(), &targets)?;
        let start = Instant::now();
        let posterior = gp.posterior_batch(&at);
        let predict_ms = 1e3 * start.elapsed().as_secs_f64();
        let error: f64 = posterior.iter().zip(&truth).map(|(p, t)| (p.mean * sd + mean - t[j]).powi(2)).sum();
        println!(
            "output {}: {wall_s:.2} s, {} evaluations, ln p = {:.3}, rmse {:.3}, 100 predictions {predict_ms:.2} ms",
            j + 1,
            found.evaluations,
            found.log_marginal_likelihood,
            (error / 100.0).sqrt()
        );
    }
    println!("six outputs: {total_s:.2} s");
    Ok(())
}
