//! Reading and writing YAML with errors that name file, line and field.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::FileError;

/// A value outside its range, before the file and line are known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("field `{field}` is {value}; allowed: {allowed}")]
pub struct FieldError {
    /// Dotted path of the field.
    pub field: String,
    /// The value given.
    pub value: String,
    /// The allowed range.
    pub allowed: String,
}

impl FieldError {
    /// An error about `field`.
    pub fn new(field: impl Into<String>, value: impl ToString, allowed: impl Into<String>) -> Self {
        Self { field: field.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// `Ok` if `value` lies in [low, high]; NaN never does.
    pub fn check(field: &str, value: f64, low: f64, high: f64) -> Result<(), Self> {
        if value >= low && value <= high { Ok(()) } else { Err(Self::new(field, value, format!("{low} to {high}"))) }
    }
}

/// The whole text of a file.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    std::fs::read_to_string(path).map_err(FileError::io(path))
}

/// The text of a YAML file, kept for error messages.
#[derive(Clone, Debug)]
pub struct YamlDocument {
    path: PathBuf,
    text: String,
}

impl YamlDocument {
    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        Ok(Self { path: path.to_owned(), text: read_text(path)? })
    }

    /// A document that is part of the program, under a name for messages.
    pub fn embedded(name: &str, text: &str) -> Self {
        Self { path: PathBuf::from(name), text: text.to_owned() }
    }

    /// Parses the document into T; unknown keys are errors where T says so.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, FileError> {
        serde_saphyr::from_str(&self.text).map_err(|error| {
            let (line, column) = error.location().map_or((1, 1), |at| (at.line(), at.column()));
            // The library's message may span lines with a drawing of the source; its first line says it all.
            let message = error.to_string();
            let message = message.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned();
            FileError::Syntax { path: self.path.clone(), line, column, message }
        })
    }

    /// Puts file and line onto a range error.
    pub fn explain(&self, error: FieldError) -> FileError {
        FileError::Range {
            path: self.path.clone(),
            line: self.line_of(&error.field),
            field: error.field,
            value: error.value,
            allowed: error.allowed,
        }
    }

    /// Line (from 1) of the key at a dotted path such as `limits.error_m`, in block style; for a path that cannot be
    /// followed to its end, the line of its deepest key that was found.
    pub fn line_of(&self, path: &str) -> Option<u64> {
        let mut found = None;
        let mut from = 0;
        let mut parent_indent = None;
        for key in path.split('.') {
            let hit = self.text.lines().enumerate().skip(from).find_map(|(index, line)| {
                let indent = line.len() - line.trim_start().len();
                let deeper = parent_indent.is_none_or(|parent| indent > parent);
                let named = line.trim_start().strip_prefix(key).is_some_and(|rest| rest.starts_with(':'));
                (deeper && named).then_some((index, indent))
            });
            let Some((index, indent)) = hit else {
                break;
            };
            found = Some(index as u64 + 1);
            from = index + 1;
            parent_indent = Some(indent);
        }
        found
    }
}

/// Serialises to YAML text.
pub fn to_yaml<T: Serialize>(value: &T) -> Result<String, std::io::Error> {
    serde_saphyr::to_string(value).map_err(std::io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document(text: &str) -> YamlDocument {
        YamlDocument { path: "some.yaml".into(), text: text.into() }
    }

    #[test]
    fn finds_nested_keys() {
        let doc = document("seed: 1\nlimits:\n  # metres\n  error_m: 0.05\nekf:\n  error_m: 7\n");
        assert_eq!(doc.line_of("limits.error_m"), Some(4));
        assert_eq!(doc.line_of("ekf.error_m"), Some(6));
        assert_eq!(doc.line_of("ekf.nothing"), Some(5));
        assert_eq!(doc.line_of("nothing"), None);
        let error = doc.explain(FieldError::check("limits.error_m", -1.0, 0.0, 1.0).unwrap_err());
        assert_eq!(error.to_string(), "some.yaml:4: field `limits.error_m` is -1; allowed: 0 to 1");
    }

    #[test]
    fn unknown_keys_and_wrong_types_name_line_and_column() {
        #[derive(Debug, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Two {
            #[allow(dead_code)]
            a: u32,
        }
        let unknown = document("a: 1\nbee: 2\n").parse::<Two>().unwrap_err().to_string();
        assert!(unknown.starts_with("some.yaml:2:1: ") && unknown.contains("bee"), "{unknown}");
        let wrong = document("\n\na: one\n").parse::<Two>().unwrap_err().to_string();
        assert!(wrong.starts_with("some.yaml:3:4: "), "{wrong}");
    }
}
