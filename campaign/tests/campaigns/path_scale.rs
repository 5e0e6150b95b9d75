//! A trial whose tool goes further is held to limits that go with it.

use tribo_campaign::TuneConfig;
use tribo_trial::PenaltyLimits;

#[test]
fn limits_of_acceleration_and_error_go_with_the_path() {
    let limits = PenaltyLimits { error_m: 0.04, ..PenaltyLimits::default() };
    let trial = |robot: &str, path_scale: Option<f64>| {
        let config = TuneConfig { robot: Some(robot.to_owned()), path_scale, limits, ..TuneConfig::default() };
        config.validate::<6>().unwrap().trial
    };
    let usual = trial("ur10e", Some(1.0));
    assert_eq!(usual.limits, limits);
    assert_eq!(trial("ur10e", Some(0.1)).limits, limits, "noise and stick-slip are those of a long path");
    let own = trial("ur10e", None);
    assert_eq!(own.limits, PenaltyLimits { acceleration_m_s2: 5.0 * 1.62, error_m: 0.04 * 1.62, ..limits });
    let position = |trial: &tribo_trial::Trial<6>| {
        let from_start = |time_s: f64| {
            (trial.reference.at(time_s).translation.vector - trial.reference.centre.translation.vector).norm()
        };
        (0..3000).map(|k| from_start(0.01 * f64::from(k))).fold(0.0, f64::max)
    };
    let ratio = position(&own) / position(&usual);
    assert!((ratio - 1.62).abs() < 1e-9, "the tool goes {ratio} times as far");
}
