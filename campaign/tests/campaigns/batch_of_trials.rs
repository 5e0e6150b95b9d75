//! A batch of trials on all cores is the batch run one after the other, bit for bit.
//!
//! Costs, parts, log, reason and time of an abort are compared as they print, where every bit of a number shows (0 and −0 differ too).

use rayon::prelude::*;
use tribo_campaign::{TuneConfig, ValidTune, run_numbered};
use tribo_trial::{EstimatorName, TrialOutcome};

/// More than cores, so that threads take several and in any order.
const TRIALS: usize = 8;

/// Short trials: the half without motion and five seconds of motion.
fn tune(config: TuneConfig) -> ValidTune<7> {
    let mut tune = config.validate::<7>().expect("valid settings");
    tune.trial.reference.duration_s = 5.0;
    tune
}

/// Trial `number` with parameters of its own, from none to more than there is.
fn trial(tune: &ValidTune<7>, number: usize) -> TrialOutcome<7> {
    let share = number as f64 / TRIALS as f64;
    let theta: Vec<f64> =
        tune.space.zero().iter().zip(0..).map(|(zero, i)| zero + share * (0.4 + 0.02 * f64::from(i))).collect();
    run_numbered(tune, number, &theta).expect("a trial that runs")
}

fn bits(outcome: &TrialOutcome<7>) -> String {
    format!("{outcome:?}")
}

fn same_bits(config: TuneConfig) {
    let tune = tune(config);
    let serial: Vec<String> = (0..TRIALS).map(|number| bits(&trial(&tune, number))).collect();
    assert!(serial.windows(2).all(|pair| pair[0] != pair[1]), "every trial is another");
    // As many threads as cores, and more than the computer has.
    for threads in [0, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let parallel: Vec<String> =
            pool.install(|| (0..TRIALS).into_par_iter().map(|number| bits(&trial(&tune, number))).collect());
        for (number, (a, b)) in serial.iter().zip(&parallel).enumerate() {
            assert!(a == b, "trial {number} with {threads} threads");
        }
    }
}

#[test]
fn with_the_filter() {
    same_bits(TuneConfig::default());
}

/// The estimator with the most memory between ticks.
#[test]
fn with_the_friction_band() {
    same_bits(TuneConfig { residual: EstimatorName::Qp, ..TuneConfig::default() });
}
