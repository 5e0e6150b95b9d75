//! A trial as the journal tells it.

use std::collections::BTreeMap;

use serde_json::Value;

/// State of a trial in Optuna's numbering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialState {
    /// Created, not ended.
    Running,
    /// Ended with a value.
    Complete,
    /// Ended early, possibly with a value.
    Pruned,
    /// Ended without a value.
    Fail,
    /// Put in the queue.
    Waiting,
}

impl TrialState {
    /// The number in the file.
    pub fn code(self) -> u64 {
        match self {
            Self::Running => 0,
            Self::Complete => 1,
            Self::Pruned => 2,
            Self::Fail => 3,
            Self::Waiting => 4,
        }
    }

    pub(super) fn of_code(code: u64) -> Option<Self> {
        [Self::Running, Self::Complete, Self::Pruned, Self::Fail, Self::Waiting]
            .into_iter()
            .find(|state| state.code() == code)
    }

    /// Whether the trial has ended.
    pub fn is_finished(self) -> bool {
        matches!(self, Self::Complete | Self::Pruned | Self::Fail)
    }
}

/// One trial as the journal tells it; its number is its place.
#[derive(Clone, Debug, PartialEq)]
pub struct JournalTrial {
    /// State.
    pub state: TrialState,
    /// Parameters by name.
    pub params: BTreeMap<String, f64>,
    /// The objective, if any.
    pub value: Option<f64>,
    /// User attributes by name.
    pub attributes: BTreeMap<String, Value>,
    /// Why it was taken back after its end, if it was: it counts for nothing.
    pub withdrawn: Option<String>,
}
