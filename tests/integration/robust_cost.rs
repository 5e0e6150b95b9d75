//! The robust cost beside the paper's.

use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_friction::VelocitySource;
use tribo_sim::Truth;
use tribo_tests::tuning_trial;
use tribo_trial::{CostMeasure, run_trial, run_trial_observed};

const ROBUST: CostMeasure = CostMeasure::Robust { lever_arm_m: 0.15 };

fn ekf() -> WrenchEkf {
    WrenchEkf::new(WrenchEkfSettings::default())
}

/// Witness: sorted samples of the estimator, not the accumulator.
#[test]
fn it_is_the_sum_of_quantiles_and_means_of_the_wrench() {
    let truth = Truth::panda_coulomb_viscous();
    let mut trial = tuning_trial(truth.clone(), VelocitySource::Hybrid);
    trial.measure = ROBUST;
    let mut series: [Vec<f64>; 6] = Default::default();
    let judged_from = (trial.reference.pre_roll_s() / trial.dt_s).round() as usize;
    let mut tick = 0;
    let outcome = run_trial_observed(&trial, &truth.friction, ekf(), 3, |record, _| {
        if tick >= judged_from {
            for (samples, value) in series.iter_mut().zip(record.estimate.wrench_base.to_force_moment()) {
                samples.push(value.abs());
            }
        }
        tick += 1;
    });
    let expected: f64 = series
        .iter_mut()
        .enumerate()
        .map(|(axis, samples)| {
            samples.sort_by(f64::total_cmp);
            let exceeded_by_a_hundredth = samples[samples.len() - samples.len() / 100 - 1];
            let mean = samples.iter().sum::<f64>() / samples.len() as f64;
            (exceeded_by_a_hundredth + mean) / if axis < 3 { 1.0 } else { 0.15 }
        })
        .sum();
    assert_eq!(outcome.cost.penalty, 0.0);
    assert!((outcome.cost.total() - expected).abs() < 1e-9 * expected, "{:?} {expected}", outcome.cost);
}

/// Deviation over mean of J at the true friction, over the sensor noise of ten trials.
#[test]
fn it_repeats_better_than_the_papers() {
    let truth = Truth::panda_coulomb_viscous();
    let [paper, robust] = [CostMeasure::Paper, ROBUST].map(|measure| {
        let mut trial = tuning_trial(truth.clone(), VelocitySource::Hybrid);
        trial.measure = measure;
        let costs: Vec<f64> =
            (0..10).map(|seed| run_trial(&trial, &truth.friction, ekf(), seed).cost.total()).collect();
        let mean = costs.iter().sum::<f64>() / 10.0;
        let variance = costs.iter().map(|cost| (cost - mean).powi(2)).sum::<f64>() / 9.0;
        println!("{measure:?}: J = {mean:.3}, deviation {:.2} %", 100.0 * variance.sqrt() / mean);
        variance.sqrt() / mean
    });
    assert!(robust < 0.7 * paper, "{robust} {paper}");
}
