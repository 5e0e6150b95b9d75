//! Story: the controller's model is wrong by a payload and its masses, its sensors are worse, and tuning still works.

use tribo_campaign::strategy::{StrategyName, identification_samples};
use tribo_campaign::{TuneConfig, ValidTune, run_in_memory, run_numbered};
use tribo_friction::VelocitySource;
use tribo_friction::identify::{Basis, GlsSettings, fit_from_wrench};
use tribo_trial::scenario::ModelError;
use tribo_trial::{AnyEstimator, run_trial};

const PAYLOAD_KG: f64 = 0.2;

fn tune(seed: u64, velocity: VelocitySource, link_mass_error: f64) -> ValidTune<7> {
    let config = TuneConfig {
        seed,
        strategy: StrategyName::GreyBox,
        velocity,
        trials: 5,
        model_error: ModelError { payload_kg: PAYLOAD_KG, link_mass_error, noise_factor: 3.0 },
        ..TuneConfig::default()
    };
    config.validate().expect("valid settings")
}

/// What the log of the first trial, without compensation, says of the payload: the error of its mass (kg).
fn payload_error(tune: &ValidTune<7>) -> f64 {
    let zero = run_numbered(tune, 0, &tune.space.zero()).expect("a trial");
    let none = tune.space.friction(&tune.space.zero());
    let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, &tune.trial, &none);
    let samples = identification_samples(&tune.trial.model, &zero.log, &estimator.expect("an estimator"));
    let fit = fit_from_wrench(&[&samples], &GlsSettings::new(Basis::CoulombViscous).with_nuisances()).expect("a fit");
    fit.payload_kg - PAYLOAD_KG
}

/// 0.2 kg at the flange, link masses wrong by 3 % (one deviation), three times the noise: what is expected of the best trial is at most 1.05
/// of what the true friction costs the same controller.
#[test]
fn tuning_bears_a_wrong_model() {
    let ratio = |(seed, velocity): (u64, VelocitySource)| {
        let tune = tune(seed, velocity, 0.03);
        let best = run_in_memory(&tune).expect("a campaign").conclusion.best.expect("a best trial");
        let friction = tune.oracle.friction;
        let oracle = |noise: u64| {
            let name = tune.config.residual;
            let estimator = AnyEstimator::for_tuning(name, tune.config.ekf, &tune.trial, &friction);
            run_trial(&tune.trial, &friction, estimator.expect("an estimator"), 880 + noise).cost.total()
        };
        let oracle = (0..3).map(oracle).sum::<f64>() / 3.0;
        best.cost / oracle
    };
    let campaigns = [(1, VelocitySource::Reference), (2, VelocitySource::Hybrid), (3, VelocitySource::Reference)];
    let ratios = campaigns.map(ratio);
    println!("wrong model: best trial over the true friction {ratios:.3?}");
    assert!(ratios.iter().all(|ratio| *ratio <= 1.05), "{ratios:?}");
}

/// With three times the noise one log says what the payload weighs to 0.02 kg. Where the last links' masses are wrong too, nobody can
/// tell them from it: 3 % of links 5 to 7 (3.6 kg) are 0.06 kg.
#[test]
fn the_payload_is_found_as_far_as_the_links_are_known() {
    let errors = |link_mass_error: f64| {
        [1, 2, 3, 4].map(|seed| payload_error(&tune(seed, VelocitySource::Reference, link_mass_error)))
    };
    let (exact, wrong) = (errors(0.0), errors(0.03));
    println!("payload off by {exact:.4?} kg; with link masses 3 % off by {wrong:.4?} kg");
    assert!(exact.iter().all(|error| error.abs() <= 0.02), "{exact:?}");
    assert!(wrong.iter().all(|error| error.abs() <= 0.12), "{wrong:?}");
}
