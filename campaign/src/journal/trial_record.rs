//! A finished trial as the journal keeps it.

use std::path::Path;

use serde_json::json;
use tribo_model::FileError;
use tribo_trial::{AbortReason, Cost};

use super::{Journal, JournalTrial, TrialState};
use crate::strategy::{FinishedTrial, Origin};
use crate::{ParameterSpace, TunedLaw};

/// What there is to say of a trial that has ended, besides its parameters and cost.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ended<'a> {
    /// Time of the failure since the start of the judged part (s), where it is known.
    pub aborted_at_s: Option<f64>,
    /// Seal of its log ([`tribo_files::seal_of`]); none of a trial that left no log.
    pub seal: Option<String>,
    /// The words of whoever reported a failure.
    pub reported: Option<&'a str>,
}

/// Ends a trial in the journal, the one way there is. A cost that is no number stays out: nothing could be learnt from it, and nobody
/// could read it back.
///
/// # Errors
/// A cost that is not finite; a journal that cannot be written.
pub(crate) fn finish(journal: &mut Journal, trial: &FinishedTrial, ended: &Ended) -> Result<(), FileError> {
    let parts = trial.cost.max.iter().chain(&trial.cost.mean).chain([&trial.cost.penalty]);
    let total = trial.cost.total();
    if !total.is_finite() || parts.into_iter().any(|part| !part.is_finite()) {
        let message = format!("the cost of trial {} is no finite number; nothing is recorded", trial.number);
        return Err(FileError::Campaign { path: journal.path().to_owned(), message });
    }
    let mut known = vec![
        ("origin", json!(trial.origin)),
        ("max", json!(trial.cost.max)),
        ("mean", json!(trial.cost.mean)),
        ("penalty", json!(trial.cost.penalty)),
        ("aborted", json!(trial.aborted)),
        ("aborted_at_s", json!(ended.aborted_at_s)),
    ];
    known.extend(ended.seal.as_ref().map(|seal| (SEAL, json!(seal))));
    known.extend(ended.reported.map(|words| (REPORTED, json!(words))));
    journal.finish(trial.number, &known, TrialState::Complete, Some(total))
}

/// Attribute with the words of whoever reported a failure.
const REPORTED: &str = "reported";
/// Attribute with the seal of the trial's log.
const SEAL: &str = "log_seal";

/// Seal of the log that a trial left, where the journal has it.
pub fn seal(trial: &JournalTrial) -> Option<String> {
    Some(trial.attributes.get(SEAL)?.as_str()?.to_owned())
}

/// What its user said of the failure of a trial.
pub fn reported(trial: &JournalTrial) -> Option<String> {
    Some(trial.attributes.get(REPORTED)?.as_str()?.to_owned())
}

/// The parameters of a trial; those of one from before its campaign went over to another law are [`ParameterSpace::embedded`].
///
/// # Errors
/// The name of the first parameter that is missing.
pub(crate) fn theta(space: &ParameterSpace, trial: &JournalTrial) -> Result<Vec<f64>, String> {
    let of = |space: &ParameterSpace| -> Result<Vec<f64>, String> {
        space.names().into_iter().map(|name| trial.params.get(&name).copied().ok_or(name)).collect()
    };
    let simple = ParameterSpace { law: TunedLaw::CoulombViscous, ..space.clone() };
    match of(space) {
        Err(_) if space.law == TunedLaw::Stribeck => Ok(space.embedded(&simple, &of(&simple)?)),
        theta => theta,
    }
}

/// The trial as its strategy knows it: what was written when it ended.
pub fn finished_trial(
    space: &ParameterSpace,
    path: &Path,
    number: usize,
    trial: &JournalTrial,
) -> Result<FinishedTrial, FileError> {
    let broken = |what: &str| FileError::Campaign {
        path: path.to_owned(),
        message: format!("trial {number} has no usable `{what}`; the journal was not written by this campaign"),
    };
    fn attribute<T: serde::de::DeserializeOwned>(trial: &JournalTrial, key: &str) -> Option<T> {
        serde_json::from_value(trial.attributes.get(key)?.clone()).ok()
    }
    let theta = theta(space, trial).map_err(|name| broken(&name))?;
    let cost = Cost {
        max: attribute(trial, "max").ok_or_else(|| broken("max"))?,
        mean: attribute(trial, "mean").ok_or_else(|| broken("mean"))?,
        penalty: attribute(trial, "penalty").ok_or_else(|| broken("penalty"))?,
    };
    let aborted: Option<AbortReason> = attribute(trial, "aborted").ok_or_else(|| broken("aborted"))?;
    let origin: Origin = attribute(trial, "origin").ok_or_else(|| broken("origin"))?;
    Ok(FinishedTrial { number, theta, cost, aborted, origin })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever part of a cost is no number, the journal stays as it is, byte for byte.
    #[test]
    fn a_cost_that_is_no_number_never_enters() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("journal.log");
        let mut journal = Journal::create(&path, || "2026-01-01T00:00:00.000000+00:00".to_owned()).unwrap();
        journal.create_trial().unwrap();
        let before = std::fs::read(&path).unwrap();
        let cost = Cost { max: [1.0; 6], mean: [0.1; 6], penalty: 0.0 };
        let trial =
            |cost| FinishedTrial { number: 0, theta: Vec::new(), cost, aborted: None, origin: Origin::Constant };
        for broken in [
            Cost { penalty: f64::NAN, ..cost },
            Cost { max: [1.0, f64::INFINITY, 1.0, 1.0, 1.0, 1.0], ..cost },
            Cost { mean: [0.1, 0.1, 0.1, 0.1, 0.1, f64::NAN], ..cost },
            // Infinite only in the sum.
            Cost { max: [f64::MAX; 6], ..cost },
        ] {
            let refused = finish(&mut journal, &trial(broken), &Ended::default()).unwrap_err().to_string();
            assert!(refused.contains("the cost of trial 0 is no finite number; nothing is recorded"), "{refused}");
            assert_eq!(std::fs::read(&path).unwrap(), before);
        }
        finish(&mut journal, &trial(cost), &Ended::default()).unwrap();
        assert!(std::fs::read(&path).unwrap().len() > before.len());
    }
}
