//! Campaigns whose trials are chosen several at a time.

use tribo_campaign::strategy::{FinishedTrial, Origin, StrategyName};
use tribo_campaign::{Campaign, StopBelow, TuneConfig, UserTrials, run_in_memory};

fn clock() -> String {
    "2026-01-01T00:00:00.000000+00:00".to_owned()
}

fn config(strategy: StrategyName, batch: usize) -> TuneConfig {
    TuneConfig { strategy, trials: 8, init: 3, batch, stop_below: Some(StopBelow::Never), ..TuneConfig::default() }
}

fn on_threads(threads: usize, config: TuneConfig) -> Vec<FinishedTrial> {
    let directory = tempfile::tempdir().unwrap();
    let campaign = Campaign::create(directory.path(), config.validate::<7>().unwrap(), clock).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| campaign.run(&mut ())).unwrap().trials
}

/// The same bits side by side on several threads, one after the other, and without a disk.
#[test]
fn results_depend_neither_on_threads_nor_on_what_ends_first() {
    for strategy in [StrategyName::GreyBox, StrategyName::Bo] {
        let alone = run_in_memory(&config(strategy, 3).validate::<7>().unwrap()).unwrap().trials;
        assert_eq!(on_threads(1, config(strategy, 3)), alone, "{strategy:?}");
        assert_eq!(on_threads(3, config(strategy, 3)), alone, "{strategy:?}");
        let one_by_one = run_in_memory(&config(strategy, 1).validate::<7>().unwrap()).unwrap().trials;
        assert_ne!(one_by_one, alone, "{strategy:?}");
        assert_eq!(on_threads(1, config(strategy, 1)), one_by_one, "{strategy:?}");
        assert_eq!(on_threads(3, config(strategy, 1)), one_by_one, "{strategy:?}");
        for (k, trial) in alone.iter().enumerate() {
            assert!(alone[..k].iter().all(|other| other.theta != trial.theta), "{strategy:?} repeats trial {k}");
        }
    }
}

/// One fit for each batch, tried once: the others of the batch are corrections of it.
#[test]
fn the_grey_box_tries_a_fit_once_and_corrects_it_beside() {
    let trials = run_in_memory(&config(StrategyName::GreyBox, 2).validate::<7>().unwrap()).unwrap().trials;
    let origins: Vec<Origin> = trials.iter().map(|trial| trial.origin).collect();
    let [fit, corrected] = [Origin::LeastSquares, Origin::Model];
    assert_eq!(origins[..5], [Origin::Constant, fit, corrected, fit, corrected]);
    assert!(trials[1..].iter().all(|trial| trial.cost.total() < 0.3 * trials[0].cost.total()), "{trials:?}");
}

#[test]
fn batches_are_for_trials_that_tribo_runs() {
    let refused = |config: TuneConfig| config.validate::<7>().unwrap_err().to_string();
    assert!(refused(config(StrategyName::Bo, 0)).contains("batch"));
    let elsewhere = TuneConfig { user_trials: Some(UserTrials::default()), ..config(StrategyName::Bo, 2) };
    assert!(refused(elsewhere).contains("ask once for every robot"));
}
