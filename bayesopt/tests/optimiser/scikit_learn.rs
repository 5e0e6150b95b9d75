//! Posterior and marginal likelihood of the exact Gaussian process against scikit-learn's `GaussianProcessRegressor`.
//!
//! Both follow rasmussen2006, algorithm 2.1, and share no line: kernels, factorisation and gradients are written
//! twice. Its `alpha` is our σ_n², with which it predicts the noise-free function as we do; its likelihood takes the same
//! number as a `WhiteKernel`, because only then is there a gradient in ln σ_n².

#![allow(clippy::expect_used, reason = "a test fails by panicking, in its helpers too")]

use crate::python_witness::{answer, numbers, python};
use crate::random_source::RandomSource;
use serde_json::{Value, json};
use tribo_bayesopt::gp::{Gp, HyperParameters, HyperPrior, Lengthscales, MarginalLikelihood};
use tribo_bayesopt::kernel::KernelFamily;

/// Of the largest value of each kind in a case. Measured are 9e-12, and 7e-11 for deviations, which are roots of differences.
const TOLERANCE: f64 = 1e-9;

/// Conditions the processes of the file; prints what it finds. θ = (ln σ_f², ln ℓ…, ln σ_n²).
const SCIKIT_LEARN: &str = r#"
import json, sys, numpy as np
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Matern, WhiteKernel
answers = []
for case in json.load(open(sys.argv[1])):
    l = np.array(case["lengthscales"])
    kernel = ConstantKernel(case["signal"]) * (Matern(l, nu=2.5) if case["matern"] else RBF(l))
    x, y, at = (np.array(case[name]) for name in ("points", "targets", "at"))
    mean, sd = GaussianProcessRegressor(kernel, alpha=case["noise"], optimizer=None).fit(x, y).predict(at, return_std=True)
    noisy = GaussianProcessRegressor(kernel + WhiteKernel(case["noise"]), alpha=0.0, optimizer=None).fit(x, y)
    value, slope = noisy.log_marginal_likelihood(noisy.kernel_.theta, eval_gradient=True)
    answers.append({"mean": mean.tolist(), "sd": sd.tolist(), "value": value,
                    "gradient": [*slope[1:-1].tolist(), slope[0], slope[-1]]})
print(json.dumps(answers))
"#;

struct Case {
    family: KernelFamily,
    hyper: HyperParameters,
    points: Vec<Vec<f64>>,
    targets: Vec<f64>,
    /// Where to predict: new points, and points that were observed.
    at: Vec<Vec<f64>>,
}

impl Case {
    fn random(family: KernelFamily, dimension: usize, n: usize, source: &mut RandomSource) -> Self {
        // Correlations in 14 coordinates are neither 0 nor 1 where length-scales grow with the distance of random points.
        let typical = 0.5 * (dimension as f64).sqrt();
        let hyper = HyperParameters {
            lengthscales: (0..dimension).map(|_| typical * 4.0_f64.powf(source.range(-0.5, 0.5))).collect(),
            signal_variance: 10.0_f64.powf(source.range(-1.0, 1.0)),
            noise_variance: 10.0_f64.powf(source.range(-4.0, -1.0)),
            trend: None,
        };
        let points: Vec<Vec<f64>> = (0..n).map(|_| source.point(dimension)).collect();
        let target = |x: &Vec<f64>| x.iter().map(|x| (5.0 * x).sin()).sum::<f64>();
        let targets = points.iter().map(|x| target(x) + 0.1 * source.normal()).collect();
        let at = (0..20).map(|_| source.point(dimension)).chain(points.iter().take(5).cloned()).collect();
        Self { family, hyper, points, targets, at }
    }

    fn question(&self) -> Value {
        json!({
            "matern": self.family == KernelFamily::Matern52, "lengthscales": self.hyper.lengthscales,
            "signal": self.hyper.signal_variance, "noise": self.hyper.noise_variance,
            "points": self.points, "targets": self.targets, "at": self.at,
        })
    }

    /// Mean, deviation, likelihood and its gradient by us and by the witness.
    fn both(&self, witness: &Value) -> [(&'static str, Vec<f64>, Vec<f64>); 4] {
        let gp = Gp::new(self.family, &self.hyper, self.points.clone(), &self.targets).expect("positive definite");
        assert_eq!(gp.jitter(), 0.0);
        let posterior = gp.posterior_batch(&self.at);
        let likelihood = MarginalLikelihood {
            shape: self.family.into(),
            lengthscales: Lengthscales::Ard,
            prior: HyperPrior::Flat,
            points: &self.points,
            targets: &self.targets,
        };
        let likelihood = likelihood.evaluate(&self.hyper.to_log(Lengthscales::Ard)).expect("positive definite");
        let value = witness["value"].as_f64().expect("a number");
        [
            ("mean", posterior.iter().map(|p| p.mean).collect(), numbers(&witness["mean"])),
            ("deviation", posterior.iter().map(|p| p.sd).collect(), numbers(&witness["sd"])),
            ("likelihood", vec![likelihood.value], vec![value]),
            ("gradient", likelihood.gradient, numbers(&witness["gradient"])),
        ]
    }
}

#[test]
fn posterior_and_likelihood_are_those_of_scikit_learn() {
    let Some(python) = python("sklearn", "the Gaussian process is UNTESTED against scikit-learn") else { return };
    let (mut cases, mut source) = (Vec::new(), RandomSource::seed(11));
    for family in [KernelFamily::Matern52, KernelFamily::SquaredExponential] {
        for dimension in [1, 5, 14] {
            for n in [1, 8, 30, 60] {
                cases.push(Case::random(family, dimension, n, &mut source));
            }
        }
    }
    let answers = answer(&python, SCIKIT_LEARN, &cases.iter().map(Case::question).collect());
    let mut worst = [0.0_f64; 4];
    for (case, witness) in cases.iter().zip(answers.as_array().expect("a list")) {
        for (worst, (name, ours, theirs)) in worst.iter_mut().zip(case.both(witness)) {
            assert_eq!(ours.len(), theirs.len(), "{name}");
            let scale = theirs.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
            let off = ours.iter().zip(&theirs).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs())) / scale;
            let (family, d, n) = (case.family, case.hyper.lengthscales.len(), case.points.len());
            assert!(off < TOLERANCE, "{family:?} of {n} points in {d} coordinates: {name} is off by {off:e}");
            *worst = worst.max(off);
        }
    }
    let worst = worst.map(|off| format!("{off:.1e}")).join(", ");
    println!("scikit-learn: mean, deviation, likelihood, gradient of {} processes within {worst}", cases.len());
}
