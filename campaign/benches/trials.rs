//! Trials of 33 s: `cargo bench -p tribo-campaign --bench trials`.
//!
//! One trial by estimator and by sub-steps of the plant, one thread; then batches, serial and on all cores (rayon). Items per
//! second are seconds of robot time: times real time.

use divan::Bencher;
use divan::counter::ItemsCount;
use rayon::prelude::*;
use tribo_campaign::{TuneConfig, ValidTune, run_numbered};
use tribo_trial::{EstimatorName, TrialOutcome};

/// Length of a trial with its pre-roll (s).
const TRIAL_S: usize = 33;

fn main() {
    divan::main();
}

fn tune(config: TuneConfig) -> ValidTune<7> {
    config.validate().expect("valid settings")
}

fn trial(tune: &ValidTune<7>, number: usize) -> TrialOutcome<7> {
    run_numbered(tune, number, &tune.space.zero()).expect("a trial that runs")
}

#[divan::bench(args = EstimatorName::ALL.map(EstimatorName::as_str), sample_count = 5, sample_size = 1)]
fn estimator(bencher: Bencher, name: &str) {
    let residual = EstimatorName::ALL.into_iter().find(|known| known.as_str() == name).unwrap_or_default();
    let tune = tune(TuneConfig { residual, ..TuneConfig::default() });
    bencher.counter(ItemsCount::new(TRIAL_S)).bench_local(|| trial(&tune, 0));
}

#[divan::bench(args = [1, 2, 5, 10, 20], sample_count = 5, sample_size = 1)]
fn sub_steps(bencher: Bencher, sub_steps: usize) {
    let tune = tune(TuneConfig { sub_steps, ..TuneConfig::default() });
    bencher.counter(ItemsCount::new(TRIAL_S)).bench_local(|| trial(&tune, 0));
}

#[divan::bench(args = [1, 2, 4, 8, 16], sample_count = 3, sample_size = 1)]
fn serial(bencher: Bencher, trials: usize) {
    let tune = tune(TuneConfig::default());
    bencher
        .counter(ItemsCount::new(TRIAL_S * trials))
        .bench_local(|| (0..trials).map(|number| trial(&tune, number).cost.total()).sum::<f64>());
}

#[divan::bench(args = [1, 2, 4, 8, 16], sample_count = 3, sample_size = 1)]
fn on_all_cores(bencher: Bencher, trials: usize) {
    let tune = tune(TuneConfig::default());
    bencher.counter(ItemsCount::new(TRIAL_S * trials)).bench_local(|| {
        (0..trials).into_par_iter().map(|number| trial(&tune, number).cost.total()).collect::<Vec<_>>()
    });
}
