//! Logs of good trials are believed: one that is refused for nothing costs a robot's time, a warning for nothing an engineer's.

use rayon::prelude::*;
use tribo_campaign::{AnyTune, Phases, TuneConfig, UserTrials, ValidTune, judge_log, noise_seed, recognise_trial};
use tribo_diagnose::Diagnosable;
use tribo_logs::recognise::Fault;
use tribo_regression::Nominal;
use tribo_trial::scenario::TruthName;
use tribo_trial::{AnyEstimator, simulate_log};

/// What is said of the log of a trial whose compensator believes this share of the true friction; none of one that was stopped.
fn said<const N: usize>(tune: &ValidTune<N>, share: f64) -> Option<Vec<String>>
where
    Nominal<N>: Diagnosable,
{
    let theta: Vec<f64> = match tune.true_parameters() {
        Some(truth) => truth.iter().map(|parameter| share * parameter).collect(),
        None => tune.space.zero(),
    };
    let (friction, trial) = (tune.space.friction(&theta), &tune.trial);
    let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, trial, &friction).unwrap();
    let (outcome, log) = simulate_log(trial, &friction, estimator, noise_seed(tune.config.seed, 0)).unwrap();
    if outcome.aborted.is_some() {
        return None;
    }
    let seen = recognise_trial(tune, &UserTrials::default(), &log, false);
    // That a joint stands is true of some.
    let remarks = seen.remarks.iter().flatten().filter(|remark| remark.fault != Fault::Standstill);
    let mut said: Vec<String> = remarks.map(ToString::to_string).collect();
    said.extend(judge_log(tune, &UserTrials::default(), &theta, &seen.log, false).err().map(|error| error.to_string()));
    Some(said)
}

#[test]
fn good_trials_of_any_arm_are_believed() {
    let arms = ["panda", "fr3", "ur3e", "ur5e", "ur10e", "xarm6", "xarm7", "kinova_gen3", "iiwa14"];
    let usual = arms.iter().flat_map(|arm| (0..3).map(move |pose| (*arm, "coulomb_viscous", pose)));
    let others = ["frictionless", "stribeck", "lugre", "gaz", "soft", "thermal"].map(|truth| ("panda", truth, 0));
    let trials: Vec<(&str, &str, usize)> = usual.chain(others).collect();
    let judged = trials.par_iter().enumerate().map(|(seed, (arm, truth, pose))| {
        let share = [0.0, 0.8][seed % 2];
        let config = TuneConfig {
            robot: Some((*arm).to_owned()),
            truth: TruthName::from((*truth).to_owned()),
            pose: *pose,
            seed: seed as u64 + 1,
            phases: Phases::Random,
            ..TuneConfig::default()
        };
        let said = match config.validate_any().unwrap() {
            AnyTune::Six(tune) => said(&tune, share),
            AnyTune::Seven(tune) => said(&tune, share),
        };
        said.map(|said| said.into_iter().map(|said| format!("{arm}, {truth}, pose {pose}, {share}: {said}")).collect())
    });
    let judged: Vec<Option<Vec<String>>> = judged.collect();
    let ended = judged.iter().flatten().count();
    let alarms: Vec<String> = judged.into_iter().flatten().flatten().collect();
    println!("{ended} of {} trials ended, {} alarms", trials.len(), alarms.len());
    assert!(alarms.is_empty(), "{}", alarms.join("\n"));
    assert!(10 * ended > 9 * trials.len(), "{ended} of {}", trials.len());
}
