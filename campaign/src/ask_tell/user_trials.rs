//! What the trials of a campaign are like when the user runs them.

use serde::{Deserialize, Serialize};

use tribo_model::FieldError;

/// Which torque of a log acted on the arm during a trial.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SentTorque {
    /// `tau_J_d`, the motor torque that was commanded, gravity included.
    #[default]
    Commanded,
    /// `tau_J_d` of robots that add gravity themselves (libfranka).
    CommandedWithoutGravity,
    /// `tau_J`, measured in the motors: current times torque constant and gear ratio.
    Measured,
}

/// Trials that run elsewhere: which part of their logs is judged, and what is the torque in them.
///
/// ```text
/// J over [judged_from_s, judged_from_s + judged_s) since the first row of the log;   T = judged_s in eqs. (29)–(32)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct UserTrials {
    /// Run-in at the beginning of every log (s): the estimator settles, the motion begins.
    pub judged_from_s: f64,
    /// Length of the judged part, T (s).
    pub judged_s: f64,
    /// The torque that acted.
    pub torque: SentTorque,
}

impl Default for UserTrials {
    /// Those of a simulated trial: 3 s of run-in, 30 s judged.
    fn default() -> Self {
        Self { judged_from_s: 3.0, judged_s: 30.0, torque: SentTorque::default() }
    }
}

impl UserTrials {
    /// Checks both times.
    ///
    /// # Errors
    /// The field out of its range.
    pub(crate) fn check(&self) -> Result<(), FieldError> {
        FieldError::check("user_trials.judged_from_s", self.judged_from_s, 0.0, 3600.0)?;
        FieldError::check("user_trials.judged_s", self.judged_s, 1.0, 36_000.0)
    }
}
