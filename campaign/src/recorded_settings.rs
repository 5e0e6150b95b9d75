//! The settings in `campaign.yaml` against those that the journal has seen.

use std::path::Path;

use serde_json::{Value, json};

use crate::TuneConfig;
use tribo_model::{FieldError, FileError, YamlDocument};

/// Refuses a `campaign.yaml` that is not the one its campaign began with: emptied, cut or edited. Comments and layout may change.
///
/// # Errors
/// The first field that differs or is missing, with its line; settings in the journal that this version does not know.
pub fn check_unchanged(began: &Value, document: &YamlDocument, journal: &Path) -> Result<(), FileError> {
    let recorded: TuneConfig = serde_json::from_value(began.clone()).map_err(|error| FileError::Campaign {
        path: journal.to_owned(),
        message: format!("holds settings of another version of Tribo: {error}"),
    })?;
    let (was, is) = (json!(recorded), json!(document.parse::<TuneConfig>()?));
    // Where a field was cut out, its default stands in: nothing differs, and yet the file is not whole.
    let written: Value = document.parse()?;
    let Some(field) = first_difference(&was, &is).or_else(|| first_missing(began, &written)) else { return Ok(()) };
    let value = |of: &Value| shown(at(of, &field));
    let found = if at(&written, &field).is_none() { "missing".to_owned() } else { value(&is) };
    let allowed =
        format!("{}, with which this campaign began; undo the change, or begin another campaign", value(&was));
    Err(document.explain(FieldError::new(field, found, allowed)))
}

/// Refuses settings that a later version wrote.
///
/// # Errors
/// The field `tribo_version`.
pub(crate) fn check_version(config: &TuneConfig, document: &YamlDocument) -> Result<(), FileError> {
    let own = env!("CARGO_PKG_VERSION");
    if numbers(&config.tribo_version) > numbers(own) {
        let allowed = format!("at most {own}, the version of this program");
        return Err(document.explain(FieldError::new("tribo_version", &config.tribo_version, allowed)));
    }
    Ok(())
}

/// `0.1.0` as numbers; what is none ends them.
fn numbers(version: &str) -> Vec<u64> {
    version.split('.').map_while(|part| part.parse().ok()).collect()
}

/// Dotted path of the first field in which two documents differ, the empty one where they differ as a whole.
pub fn first_difference(a: &Value, b: &Value) -> Option<String> {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            a.keys().chain(b.keys()).find_map(|key| match (a.get(key), b.get(key)) {
                (Some(a), Some(b)) => first_difference(a, b).map(|below| joined(key, &below)),
                _ => Some(key.clone()),
            })
        }
        _ => (a != b).then(String::new),
    }
}

/// Dotted path of the first field of `a` that `b` does not have.
fn first_missing(a: &Value, b: &Value) -> Option<String> {
    let Value::Object(a) = a else { return None };
    a.iter().find_map(|(key, value)| match b.get(key) {
        Some(there) => first_missing(value, there).map(|below| joined(key, &below)),
        None => Some(key.clone()),
    })
}

fn joined(key: &str, below: &str) -> String {
    if below.is_empty() { key.to_owned() } else { format!("{key}.{below}") }
}

/// The value at a dotted path.
fn at<'a>(document: &'a Value, path: &str) -> Option<&'a Value> {
    path.split('.').try_fold(document, |value, key| value.get(key))
}

/// A value in a sentence; of much, that it is much.
fn shown(value: Option<&Value>) -> String {
    match value {
        None => "missing".to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(value) if value.is_object() || value.is_array() => "another content".to_owned(),
        Some(value) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_model::to_yaml;

    fn refusal(text: &str) -> Option<String> {
        let config = TuneConfig { seed: 8, ..TuneConfig::default() };
        let document = YamlDocument::embedded("campaign.yaml", text);
        check_unchanged(&json!(config), &document, Path::new("journal.log")).err().map(|error| error.to_string())
    }

    #[test]
    fn every_edit_names_its_field_and_line() {
        let text = to_yaml(&TuneConfig { seed: 8, ..TuneConfig::default() }).unwrap();
        assert_eq!(refusal(&text), None);
        assert_eq!(refusal(&format!("# mine\n\n{text}")), None, "a comment is no change");
        let edited = refusal(&text.replace("seed: 8", "seed: 9")).unwrap();
        assert!(edited.starts_with("campaign.yaml:3: field `seed` is 9; allowed: 8, with which"), "{edited}");
        let lines: Vec<&str> = text.lines().collect();
        for cut in 0..lines.len() {
            // The last line of a block may be the field alone: then it is no YAML of ours, which is named as well.
            let cut = lines[..cut].join("\n") + "\n";
            assert!(refusal(&cut).is_some_and(|message| message.contains("field")), "{cut}: {:?}", refusal(&cut));
        }
    }

    #[test]
    fn a_later_version_is_refused() {
        for (version, refused) in [("", false), ("0.1.0", false), ("0.0.9", false), ("99.0.0", true), ("0.99", true)] {
            let config = TuneConfig { tribo_version: version.to_owned(), ..TuneConfig::default() };
            let document = YamlDocument::embedded("campaign.yaml", "");
            assert_eq!(check_version(&config, &document).is_err(), refused, "{version}");
        }
    }
}
