//! What the journal says of a campaign as a whole.

use serde_json::Value;

use super::JournalTrial;
use crate::config::TRIALS;
use crate::strategy::LawChange;
use crate::{Conclusion, StopBelow};

/// Attributes of the study (op_code 2), the last of each name counting:
///
/// ```text
/// settings       what campaign.yaml held when the campaign began, so that a change of the file is found and its field named
/// trials         how many trials the campaign is to have, once that was changed
/// stop_below     when it ends before its last trial, once that was changed
/// friction_law   the law that the campaign went over to, from which trial on, and why
/// conclusion     the best trial and the check of the friction law, of the trials that had finished
/// withdrawn_N    {reason, datetime}: trial N, which has ended, counts for nothing
/// ```
///
/// Attributes by other names belong to other tools.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyRecord {
    /// The settings that the campaign began with; none of a campaign that an earlier version began.
    pub settings: Option<Value>,
    /// Number of trials, where it was changed after the beginning.
    pub trials: Option<usize>,
    /// When it ends early, where that was changed after the beginning.
    pub stop_below: Option<StopBelow>,
    /// The friction law that it went over to, if it did.
    pub law_change: Option<LawChange>,
    /// What the trials amounted to; none where one has been taken back since.
    pub conclusion: Option<Conclusion>,
}

impl StudyRecord {
    /// Name of the settings.
    pub(super) const SETTINGS: &str = "settings";
    /// Name of the number of trials.
    pub(super) const TRIALS: &str = "trials";
    /// Name of the rule that ends a campaign early.
    pub(super) const STOP_BELOW: &str = "stop_below";
    /// Name of the law that the campaign went over to.
    pub(super) const LAW: &str = "friction_law";
    /// Name of what the trials amount to.
    pub(super) const CONCLUSION: &str = "conclusion";
    /// What stands before the number of a trial that was taken back.
    pub(super) const WITHDRAWN: &str = "withdrawn_";

    /// Takes one record in.
    pub(super) fn apply(&mut self, record: &Value, trials: &mut [JournalTrial]) -> Result<(), String> {
        let attributes = record.get("user_attr").and_then(Value::as_object).ok_or("`user_attr` is missing")?;
        for (name, value) in attributes {
            if name == Self::SETTINGS {
                self.settings = Some(value.clone());
            } else if name == Self::TRIALS {
                let number = value.as_u64().and_then(|number| usize::try_from(number).ok());
                let number = number.filter(|number| TRIALS.contains(number));
                self.trials = Some(number.ok_or_else(|| format!("`trials` is {value}; allowed: 1 to 10000"))?);
            } else if name == Self::STOP_BELOW {
                let stop = serde_json::from_value(value.clone()).map_err(|error| format!("`stop_below`: {error}"))?;
                self.stop_below = Some(stop);
            } else if name == Self::LAW {
                let change =
                    serde_json::from_value(value.clone()).map_err(|error| format!("`friction_law`: {error}"))?;
                self.law_change = Some(change);
            } else if name == Self::CONCLUSION {
                let conclusion: Conclusion =
                    serde_json::from_value(value.clone()).map_err(|error| format!("`conclusion`: {error}"))?;
                let known = |trial: usize| trials.get(trial).is_some_and(|trial| trial.state.is_finished());
                if conclusion.best.is_some_and(|best| !known(best.trial)) {
                    return Err("`conclusion` names a best trial that has not ended".to_owned());
                }
                self.conclusion = Some(conclusion);
            } else if let Some(number) = name.strip_prefix(Self::WITHDRAWN).and_then(|number| number.parse().ok()) {
                let number: usize = number;
                let ended = trials.get_mut(number).filter(|trial| trial.state.is_finished());
                let trial = ended.ok_or_else(|| format!("trial {number} is taken back and has not ended"))?;
                let reason = value.get("reason").and_then(Value::as_str);
                self.conclusion = None;
                trial.withdrawn = Some(reason.ok_or_else(|| format!("`{name}` has no `reason`"))?.to_owned());
            }
        }
        Ok(())
    }
}
