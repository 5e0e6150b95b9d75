//! Log marginal likelihood of the joint-deformation regression, reference numbers of `reference/FUNCTIONS.md` §3
//! (n = 960, d = 6; agreed upon by scikit-learn, GPy and GPyTorch).

mod common;

use common::random_source::RandomSource;
use tribo_bayesopt::gp::{HyperPrior, Lengthscales, MarginalLikelihood};
use tribo_bayesopt::kernel::KernelFamily;

const HALF_RANGE: [f64; 6] = [2.8, 1.2, 1.5, 2.5, 1.9, 2.8];
const NOISE_SD: [f64; 6] = [1.0, 0.8, 0.6, 0.4, 0.4, 0.5];
/// σ_n² = 0.1, and the 1e-10 that scikit-learn adds to every diagonal by default: without it the
/// reference is missed by up to 6e-7, with it hit within 5e-13.
const NOISE_VARIANCE: f64 = 0.1 + 1e-10;
const REFERENCE: [f64; 6] = [
    -1952.474414095915,
    -582.5986168105629,
    -587.1032379292576,
    -682.0682906756897,
    -755.1577393828061,
    -1438.179273673174,
];

fn torque(q: &[f64]) -> [f64; 6] {
    let (a, b) = (q[1] + q[2], q[1] + q[2] + q[4]);
    [
        1.5 * (3.0 * q[0]).sin() + 0.8 * (q[0] + q[1]).cos(),
        25.0 * q[1].sin() + 12.0 * a.sin() + 3.0 * b.sin() + 1.5 * (2.0 * q[0]).sin(),
        14.0 * a.sin() + 4.0 * q[3].cos() * b.sin(),
        3.0 * q[3].sin() * a.cos() + 1.2 * (q[3] + q[5]).sin(),
        6.0 * q[3].cos() * b.sin() + q[5].sin(),
        0.8 * q[5].sin() * q[4].sin(),
    ]
}

#[test]
fn likelihood_equals_the_reference_of_six_outputs() {
    let mut source = RandomSource::seed(4242);
    let (mut points, mut outputs) = (vec![], vec![vec![]; 6]);
    for _ in 0..960 {
        let q: Vec<f64> = HALF_RANGE.iter().map(|h| source.range(-h, *h)).collect();
        for (j, t) in torque(&q).into_iter().enumerate() {
            outputs[j].push(t + NOISE_SD[j] * source.normal());
        }
        points.push(q.iter().zip(HALF_RANGE).map(|(q, h)| q / (h / 3.0_f64.sqrt())).collect::<Vec<f64>>());
    }
    let theta = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, NOISE_VARIANCE.ln()];
    for (output, want) in outputs.iter().zip(REFERENCE) {
        let mean = output.iter().sum::<f64>() / 960.0;
        let sd = (output.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / 960.0).sqrt();
        let targets: Vec<f64> = output.iter().map(|y| (y - mean) / sd).collect();
        let model = MarginalLikelihood {
            family: KernelFamily::SquaredExponential,
            lengthscales: Lengthscales::Ard,
            prior: HyperPrior::Flat,
            points: &points,
            targets: &targets,
        };
        let at = model.evaluate(&theta).unwrap();
        // Condition number below 1e4 leaves twelve digits.
        assert!((at.value - want).abs() < 1e-9, "{} {want}", at.value);
        assert_eq!(at.jitter, 0.0);
    }
}
