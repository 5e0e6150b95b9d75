//! From the lines of a journal to the state of the study.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::{JournalTrial, StudyRecord, TrialState};
use tribo_model::FileError;

/// The state of a study, line by line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replay {
    studies: usize,
    lines: u64,
    study: StudyRecord,
    trials: Vec<JournalTrial>,
}

impl Replay {
    /// Takes further complete lines of the journal at `path`; anything unexpected, bytes that are no text too, names its line.
    pub fn extend(&mut self, path: &Path, lines: &[u8]) -> Result<(), FileError> {
        for line in lines.split_inclusive(|byte| *byte == b'\n') {
            self.lines += 1;
            let corrupt = |message: String| FileError::Journal { path: path.to_owned(), line: self.lines, message };
            let text = std::str::from_utf8(line)
                .map_err(|error| corrupt(format!("not UTF-8 text at byte {}", error.valid_up_to() + 1)))?;
            let record: Value = serde_json::from_str(text).map_err(|error| corrupt(format!("not JSON: {error}")))?;
            apply(&record, (&mut self.studies, &mut self.study), &mut self.trials).map_err(corrupt)?;
        }
        Ok(())
    }

    /// The trials so far, by number.
    pub fn trials(&self) -> &[JournalTrial] {
        &self.trials
    }

    /// The trials, by number.
    pub fn into_trials(self) -> Vec<JournalTrial> {
        self.trials
    }

    /// What the lines so far say of the campaign as a whole.
    pub fn study(&self) -> &StudyRecord {
        &self.study
    }
}

/// Replays the complete lines of a journal. An empty text has no study yet; anything unexpected names its line.
pub fn replay(path: &Path, lines: &[u8]) -> Result<Vec<JournalTrial>, FileError> {
    let mut replay = Replay::default();
    replay.extend(path, lines)?;
    Ok(replay.trials)
}

fn apply(
    record: &Value,
    (studies, study): (&mut usize, &mut StudyRecord),
    trials: &mut Vec<JournalTrial>,
) -> Result<(), String> {
    let number = |key: &str| record.get(key).and_then(Value::as_u64).ok_or_else(|| format!("`{key}` is missing"));
    let op_code = number("op_code")?;
    if op_code == 0 {
        *studies += 1;
        return if *studies == 1 { Ok(()) } else { Err("a second study; a campaign has one".to_owned()) };
    }
    if *studies == 0 {
        return Err("no study has been created yet".to_owned());
    }
    if op_code == 4 {
        trials.push(JournalTrial {
            state: TrialState::Running,
            params: BTreeMap::new(),
            value: None,
            attributes: BTreeMap::new(),
            withdrawn: None,
        });
        return Ok(());
    }
    if op_code == 2 {
        return study.apply(record, trials);
    }
    // System attributes of the study (3), intermediate values (7) and system attributes (9) may be added by other tools.
    if matches!(op_code, 3 | 7 | 9) {
        return Ok(());
    }
    if !matches!(op_code, 5 | 6 | 8) {
        return Err(format!("unexpected op_code {op_code}"));
    }
    let trial_id = number("trial_id")? as usize;
    let trial = trials.get_mut(trial_id).ok_or_else(|| format!("trial {trial_id} has not been created"))?;
    if trial.state.is_finished() {
        return Err(format!("trial {trial_id} has ended already"));
    }
    match op_code {
        5 => {
            let name = record.get("param_name").and_then(Value::as_str).ok_or("`param_name` is missing")?;
            let value = record
                .get("param_value_internal")
                .and_then(Value::as_f64)
                .ok_or("`param_value_internal` is missing or not a number")?;
            trial.params.insert(name.to_owned(), value);
        }
        8 => {
            let attributes = record.get("user_attr").and_then(Value::as_object).ok_or("`user_attr` is missing")?;
            trial.attributes.extend(attributes.iter().map(|(key, value)| (key.clone(), value.clone())));
        }
        _ => {
            let code = number("state")?;
            trial.state = TrialState::of_code(code).ok_or_else(|| format!("unknown state {code}"))?;
            trial.value = match record.get("values") {
                None | Some(Value::Null) => None,
                Some(values) => Some(values.get(0).and_then(Value::as_f64).ok_or("`values` holds no number")?),
            };
            if trial.state == TrialState::Complete && trial.value.is_none() {
                return Err("a complete trial without a value".to_owned());
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"{"op_code":0,"worker_id":"w","study_name":"tribo","directions":[1]}
{"op_code":4,"worker_id":"w","study_id":0,"datetime_start":"2026-01-01T00:00:00.000000+00:00"}
{"op_code":5,"worker_id":"w","trial_id":0,"param_name":"x","param_value_internal":0.25,"distribution":"{}"}
{"op_code":8,"worker_id":"w","trial_id":0,"user_attr":{"reason":null}}
{"op_code":6,"worker_id":"w","trial_id":0,"state":1,"values":[3.5],"datetime_complete":"2026-01-01T00:00:01.000000+00:00"}
"#;

    #[test]
    fn replays_a_trial() {
        let trials = replay(Path::new("journal.log"), GOOD.as_bytes()).unwrap();
        assert_eq!(trials.len(), 1);
        assert_eq!((trials[0].state, trials[0].value, trials[0].params["x"]), (TrialState::Complete, Some(3.5), 0.25));
    }

    fn study(key: &str, value: &str) -> String {
        format!("{{\"op_code\":2,\"worker_id\":\"w\",\"study_id\":0,\"user_attr\":{{\"{key}\":{value}}}}}\n")
    }

    /// Attributes of the study say what holds for the campaign; those of other tools are theirs.
    #[test]
    fn a_trial_is_taken_back_and_the_campaign_grows() {
        let taken_back = study("withdrawn_0", "{\"reason\":\"the cable slipped\"}");
        let text = [GOOD, &taken_back, &study("trials", "7"), &study("trials", "9"), &study("note", "[1]")].concat();
        let mut replay = Replay::default();
        replay.extend(Path::new("journal.log"), text.as_bytes()).unwrap();
        assert_eq!(replay.study().trials, Some(9));
        assert_eq!(replay.trials()[0].withdrawn.as_deref(), Some("the cable slipped"));
        assert_eq!(replay.trials()[0].value, Some(3.5), "what was told stays");
    }

    #[test]
    fn every_kind_of_damage_names_its_line() {
        for (damage, line) in [
            ("nonsense\n", 1),
            (&GOOD.replace("\"op_code\":4", "\"op_code\":5")[..], 2),
            (&GOOD.replace("0.25", "\"a\"")[..], 3),
            (&GOOD.replace("[3.5]", "null")[..], 5),
            (&GOOD.replace("\"state\":1", "\"state\":12")[..], 5),
            (&format!("{GOOD}{}\n", GOOD.lines().nth(3).unwrap())[..], 6),
            (&GOOD.replace("{\"op_code\":8", "{\"op_code\":99")[..], 4),
            (&format!("{GOOD}{}", study("withdrawn_1", "{\"reason\":\"slip\"}"))[..], 6),
            (&format!("{GOOD}{}", study("withdrawn_0", "{}"))[..], 6),
            (&format!("{GOOD}{}", study("trials", "0"))[..], 6),
        ] {
            let message = replay(Path::new("journal.log"), damage.as_bytes()).unwrap_err().to_string();
            assert!(message.starts_with(&format!("journal.log:{line}: ")), "{message}");
        }
    }
}
