//! The judgement of `tribo tell`: options in the first byte, then the log of a trial.

use std::path::Path;
use std::sync::LazyLock;

use tribo_campaign::{RecognisedTrial, SentTorque, TuneConfig, UserTrials, ValidTune, judge_log, recognise_trial};
use tribo_logs::read_log_from;
use tribo_trial::EstimatorName;

/// What errors call the input.
const NAME: &str = "input.log";

/// A campaign about a Panda for each estimator that a campaign may have.
static CAMPAIGNS: LazyLock<Vec<ValidTune<7>>> = LazyLock::new(|| {
    let campaign =
        |residual| TuneConfig { residual, user_trials: Some(UserTrials::default()), ..TuneConfig::default() };
    EstimatorName::ALL.into_iter().filter_map(|residual| campaign(residual).validate::<7>().ok()).collect()
});

/// A trial is refused with a reason, or has a cost: finite, not below zero, told of as many seconds as there were.
pub fn check(input: &[u8]) {
    let Some((&options, log)) = input.split_first() else { return };
    let Ok((log, _)) = read_log_from(log.to_vec(), Path::new(NAME)) else { return };
    let torque = [SentTorque::Commanded, SentTorque::CommandedWithoutGravity, SentTorque::Measured];
    let (torque, failed) = (torque[usize::from(options & 3) % 3], options & 4 != 0);
    let tune = &CAMPAIGNS[usize::from(options >> 3) % CAMPAIGNS.len()];
    // Logs of some kilobytes are milliseconds long.
    let user_trials = UserTrials { judged_from_s: 0.005, judged_s: 0.02, torque };
    let theta = vec![0.25; tune.space.zero().len()];
    // As `tell` does it: what cannot be is left out, then the log and the arm are asked.
    let RecognisedTrial { log, remarks } = recognise_trial(tune, &user_trials, &log, failed);
    for remark in remarks.into_iter().flatten() {
        assert!(!remark.evidence.is_empty() && !remark.remedy.is_empty(), "{remark:?}");
        assert!(remark.joints.iter().all(|joint| *joint < log.joints()), "{remark:?}");
    }
    match judge_log(tune, &user_trials, &theta, &log, failed) {
        Ok(judged) => {
            let cost = judged.cost;
            let all = cost.max.iter().chain(&cost.mean).chain([&cost.penalty]);
            assert!(all.into_iter().all(|part| part.is_finite() && *part >= 0.0), "{cost:?}");
            assert!(cost.total().is_finite(), "{cost:?}");
            assert!(judged.faults <= log.rows() && judged.aborted_at_s.is_some() == failed);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
