//! What the journal says of a campaign as a whole.

use serde_json::Value;

use super::JournalTrial;
use crate::config::TRIALS;

/// Attributes of the study (op_code 2), the last of each name counting:
///
/// ```text
/// settings       what campaign.yaml held when the campaign began, so that a change of the file is found and its field named
/// trials         how many trials the campaign is to have, once that was changed
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
}

impl StudyRecord {
    /// Name of the settings.
    pub(super) const SETTINGS: &str = "settings";
    /// Name of the number of trials.
    pub(super) const TRIALS: &str = "trials";
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
            } else if let Some(number) = name.strip_prefix(Self::WITHDRAWN).and_then(|number| number.parse().ok()) {
                let number: usize = number;
                let ended = trials.get_mut(number).filter(|trial| trial.state.is_finished());
                let trial = ended.ok_or_else(|| format!("trial {number} is taken back and has not ended"))?;
                let reason = value.get("reason").and_then(Value::as_str);
                trial.withdrawn = Some(reason.ok_or_else(|| format!("`{name}` has no `reason`"))?.to_owned());
            }
        }
        Ok(())
    }
}
