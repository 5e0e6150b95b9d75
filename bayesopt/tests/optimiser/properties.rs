//! Properties that hold for every input: kernels, acquisition, order and repetition.

use crate::common::random_source::RandomSource;
use faer::Side;
use tribo_bayesopt::acquisition::log_expected_improvement;
use tribo_bayesopt::kernel::{Kernel, KernelFamily, Structure, Trend};
use tribo_bayesopt::{Domain, History, Outcome, Settings, Study, recommend, suggest};

/// Random points, some of them twice, some a rounding apart, some a billionth.
fn crowded(source: &mut RandomSource, dimension: usize) -> Vec<Vec<f64>> {
    let mut points: Vec<Vec<f64>> = (0..12).map(|_| source.point(dimension)).collect();
    for k in 0..4 {
        points.push(points[k].clone());
        points.push(points[k].iter().map(|x| x + f64::EPSILON).collect());
        points.push(points[k].iter().map(|x| x + 1e-9 * source.u()).collect());
    }
    points
}

#[test]
fn kernel_matrices_are_positive_semidefinite_with_duplicates_and_near_duplicates() {
    let mut source = RandomSource::seed(31);
    for dimension in [1, 2, 5, 14, 35, 50] {
        for family in [KernelFamily::Matern52, KernelFamily::SquaredExponential] {
            for structure in [Structure::Joint, Structure::Additive] {
                for trend in [None, Some(Trend { linear: 0.3, quadratic: 2.0 })] {
                    // From nearly independent to nearly constant.
                    for scale in [0.02, 0.3, 30.0] {
                        let lengthscales = (0..dimension).map(|_| scale * source.range(0.3, 3.0)).collect();
                        let kernel = Kernel { family, structure, signal_variance: 1.3, lengthscales, trend };
                        let gram = kernel.gram(&crowded(&mut source, dimension));
                        let n = gram.nrows();
                        let eigenvalues = gram.self_adjoint_eigenvalues(Side::Lower).unwrap();
                        let largest = eigenvalues.iter().copied().fold(0.0, f64::max);
                        // Rounding of an eigenproblem: n · eps · norm.
                        let rounding = n as f64 * f64::EPSILON * largest;
                        assert!(eigenvalues.iter().all(|l| *l >= -rounding), "{kernel:?} {eigenvalues:?}");
                        assert!((0..n).all(|i| (0..n).all(|j| gram[(i, j)] == gram[(j, i)])));
                    }
                }
            }
        }
    }
}

/// Gap and deviation each over sixteen decades, 1e-8 to 1e8, the mean on both sides of the incumbent.
#[test]
fn log_ei_is_finite_and_falls_with_the_mean_over_sixteen_decades() {
    let decades = || (-32..=32).map(|k| 10.0_f64.powf(0.25 * f64::from(k)));
    for sd in decades() {
        let mut means: Vec<f64> = decades().map(|gap| -gap).chain(decades()).collect();
        means.sort_by(f64::total_cmp);
        let mut previous = f64::INFINITY;
        for mean in means {
            let at = log_expected_improvement(mean, sd, 0.0);
            assert!(at.value.is_finite() && at.d_mean.is_finite() && at.d_sd.is_finite(), "{mean} {sd}: {at:?}");
            // Equal where the difference is below the rounding of the value.
            assert!(at.value <= previous && at.d_mean < 0.0 && at.d_sd >= 0.0, "{mean} {sd}: {at:?} {previous}");
            previous = at.value;
        }
    }
}

/// In units of sd the gradient is that of the value, at random gaps and deviations.
#[test]
fn log_ei_has_the_gradient_of_its_value() {
    let mut source = RandomSource::seed(32);
    for _ in 0..2000 {
        let (sd, z) = (10.0_f64.powf(source.range(-8.0, 8.0)), source.range(-30.0, 6.0));
        let mean = -z * sd;
        let value = |dm: f64, ds: f64| log_expected_improvement(mean + dm * sd, sd + ds * sd, 0.0).value;
        let at = log_expected_improvement(mean, sd, 0.0);
        let h = 1e-5;
        let d_mean = (value(h, 0.0) - value(-h, 0.0)) / (2.0 * h * sd);
        let d_sd = (value(0.0, h) - value(0.0, -h)) / (2.0 * h * sd);
        let tolerance = 1e-6 * (1.0 + z * z) / sd;
        assert!((at.d_mean - d_mean).abs() < tolerance, "{z} {sd}: {at:?} {d_mean}");
        assert!((at.d_sd - d_sd).abs() < tolerance, "{z} {sd}: {at:?} {d_sd}");
    }
}

/// Values, failures at some moment, and noise.
fn outcome(point: &[f64], source: &mut RandomSource) -> Outcome {
    let sum: f64 = point.iter().sum();
    if sum > 1.6 {
        return Outcome::Failed { value: Some(900.0), part: Some(source.u()) };
    }
    Outcome::Value(1.0 + point.iter().map(|x| (x - 0.3).powi(2)).sum::<f64>() + 0.05 * source.normal())
}

#[test]
fn neither_the_order_of_telling_nor_repetition_changes_a_bit() {
    let domain = Domain::unit_cube(3).unwrap();
    for seed in 0..4 {
        let told = |order: [usize; 4]| {
            let mut study = Study::new(Settings::bo(vec![0.2; 3]), domain.clone(), seed).unwrap();
            for block in 0..4 {
                let asked: Vec<_> = (0..4).map(|_| study.ask().unwrap()).collect();
                for k in order {
                    let mut source = RandomSource::seed(100 * seed + 4 * block + k as u64);
                    study.tell(asked[k].trial, outcome(&asked[k].point, &mut source)).unwrap();
                }
            }
            (study.ask().unwrap(), study)
        };
        let (first, study) = told([0, 1, 2, 3]);
        assert_eq!(first, told([3, 1, 0, 2]).0);
        assert_eq!(first, told([0, 1, 2, 3]).0);
        let history: &History = study.history();
        let settings = study.settings();
        let ask = || recommend(settings, &domain, history, seed).unwrap();
        assert_eq!(ask(), ask());
        let evidence = suggest(settings, &domain, history, seed).unwrap().evidence.unwrap();
        assert!(evidence.expected_gain.gain >= 0.0 && evidence.expected_gain.gain.is_finite());
    }
}
