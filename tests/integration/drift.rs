//! Story: a robot warms up while it is tuned, and the grey box keeps up.

use tribo_campaign::strategy::StrategyName;
use tribo_campaign::{StopBelow, TuneConfig, run_in_memory};
use tribo_friction::VelocitySource;
use tribo_model::ControllerModel;
use tribo_trial::scenario::TruthName;
use tribo_trial::{AnyEstimator, run_trial};

/// J of a controller that knows the friction of this moment, under the noise of the trial itself: a maximum over 30 s moves
/// by several per cent with the noise alone.
fn instantaneous_oracle(tune: &tribo_campaign::ValidTune<7>, number: usize) -> f64 {
    let (trial, noise) = tune.numbered(number);
    let warm_up = trial.truth.warm_up.expect("a truth that warms up");
    let scale = warm_up.scale(0.5 * trial.reference.total_s());
    let mut truth = trial.truth.clone();
    truth.warm_up = None;
    for joint in &mut truth.friction.joints {
        *joint = joint.scaled(scale);
    }
    let believed = ControllerModel::of(truth);
    let trial = trial.with_controller_model(&believed);
    let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, &trial, &believed.friction);
    run_trial(&trial, &believed.friction, estimator.expect("an estimator"), noise).cost.total()
}

/// Friction falls to 74 % over fifty trials. From trial 3 on (counted from 1) every trial costs at most 1.10 of what knowing the friction of that moment
/// would, by reference velocity, which hides nothing (an independent prototype: frozen parameters end at 2.6).
#[test]
fn grey_box_follows_friction_that_fades() {
    let config = TuneConfig {
        truth: TruthName::Thermal,
        strategy: StrategyName::GreyBox,
        velocity: VelocitySource::Reference,
        trials: 50,
        stop_below: Some(StopBelow::Never),
        ..TuneConfig::default()
    };
    let tune = config.validate::<7>().expect("valid settings");
    let trials = run_in_memory(&tune).expect("a campaign").trials;
    let warm_up = tune.numbered(49).0.truth.warm_up.expect("a truth that warms up");
    assert!((warm_up.scale(16.5) - 0.74).abs() < 0.01, "{}", warm_up.scale(16.5));

    let ratio = |number: usize| trials[number].cost.total() / instantaneous_oracle(&tune, number);
    let ratios: Vec<(usize, f64)> = (2..50).map(|number| (number, ratio(number))).collect();
    let worst = ratios.iter().copied().fold((0, 0.0), |worst, at| if at.1 > worst.1 { at } else { worst });
    let mean = ratios.iter().map(|(_, ratio)| ratio).sum::<f64>() / ratios.len() as f64;
    println!(
        "drift: J over the instantaneous oracle, trials 3 to 50: mean {mean:.3}, worst {:.3} in trial {}",
        worst.1,
        worst.0 + 1
    );
    assert!(trials.iter().all(|trial| trial.aborted.is_none()));
    assert!(worst.1 <= 1.10, "{worst:?}");

    // What the first fit would cost at the end, when nobody looks again.
    let (last, seed) = tune.numbered(49);
    let frozen = tune.space.friction(&trials[1].theta);
    let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, &last, &frozen);
    let cost = run_trial(&last, &frozen, estimator.expect("an estimator"), seed).cost.total();
    assert!(cost > 1.8 * trials[49].cost.total(), "the drift is no drift: {cost}");
}
