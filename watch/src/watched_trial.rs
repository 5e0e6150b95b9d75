//! A finished trial of a campaign that is watched.

use tribo_campaign::strategy::FinishedTrial;
use tribo_figure::number::fixed;

/// A finished trial as the journal tells it.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchedTrial {
    /// Parameters, cost, reason.
    pub trial: FinishedTrial,
    /// Time of the violation since the start of the judged part (s), if there was one.
    pub aborted_at_s: Option<f64>,
    /// What its user said of its failure, of a trial that ran elsewhere.
    pub reported: Option<String>,
    /// Seal of its log, where the journal has it.
    pub seal: Option<String>,
}

impl WatchedTrial {
    /// Why it failed; empty if it did not.
    pub fn reason(&self) -> String {
        match (&self.reported, self.trial.aborted) {
            (Some(reported), _) => reported.clone(),
            (None, Some(reason)) => reason.to_string(),
            (None, None) => String::new(),
        }
    }

    /// `failed at 3.20 s: tool error`, or `complete`; times before 0 are those of the run-in.
    pub fn state(&self) -> String {
        match (self.trial.aborted, self.aborted_at_s) {
            (None, _) => "complete".to_owned(),
            (Some(_), Some(at_s)) => format!("failed at {} s: {}", fixed(at_s, 2), self.reason()),
            (Some(_), None) => format!("failed: {}", self.reason()),
        }
    }
}
