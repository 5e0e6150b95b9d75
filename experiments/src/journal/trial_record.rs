//! A finished trial as the journal keeps it.

use std::path::Path;

use serde_json::{Value, json};

use super::JournalTrial;
use crate::files::FileError;
use crate::strategy::{FinishedTrial, Origin};
use crate::{AbortReason, Cost, ParameterSpace};

/// What the journal keeps of a trial besides parameters and J.
pub(crate) fn attributes(trial: &FinishedTrial, aborted_at_s: Option<f64>) -> [(&'static str, Value); 6] {
    [
        ("origin", json!(trial.origin)),
        ("max", json!(trial.cost.max)),
        ("mean", json!(trial.cost.mean)),
        ("penalty", json!(trial.cost.penalty)),
        ("aborted", json!(trial.aborted)),
        ("aborted_at_s", json!(aborted_at_s)),
    ]
}

/// Attribute with the words of whoever reported a failure.
pub(crate) const REPORTED: &str = "reported";

/// What its user said of the failure of a trial.
pub(crate) fn reported(trial: &JournalTrial) -> Option<String> {
    Some(trial.attributes.get(REPORTED)?.as_str()?.to_owned())
}

/// The inverse of [`attributes`].
pub(crate) fn finished_trial(
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
    let names = space.names();
    let theta = names
        .iter()
        .map(|name| trial.params.get(name).copied().ok_or_else(|| broken(name)))
        .collect::<Result<Vec<f64>, _>>()?;
    let cost = Cost {
        max: attribute(trial, "max").ok_or_else(|| broken("max"))?,
        mean: attribute(trial, "mean").ok_or_else(|| broken("mean"))?,
        penalty: attribute(trial, "penalty").ok_or_else(|| broken("penalty"))?,
    };
    let aborted: Option<AbortReason> = attribute(trial, "aborted").ok_or_else(|| broken("aborted"))?;
    let origin: Origin = attribute(trial, "origin").ok_or_else(|| broken("origin"))?;
    Ok(FinishedTrial { number, theta, cost, aborted, origin })
}
