//! A column map as a file, with signs and offsets.
//!
//! ```yaml
//! schema: tribo.map/1                     # may be left out
//! time: stamp[ms]                         # as in the text of a map
//! q: {columns: "pos_{joint}", unit: deg, sign: [1, -1, 1, 1, 1, 1], offset: [0, 90, 0, 0, 0, 0]}
//! tau: {columns: [i_base, i_shoulder], unit: "mA*11.1:9.3"}
//! joints: [base, shoulder]                # names in the file, base to tool
//! ```
//!
//! `SI = factor · (sign · x + offset)`: the offset is in the unit of the column. Also `joint`, `episode` (number), `episode_column`,
//! `topic` and `rate`. Unknown keys are errors.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde::Deserialize;
use tribo_files::LogError;

use super::column_map::{ColumnMap, Columns, Entry, allowed_keys, entry, quantity_of};
use super::unit::Unit;

/// The longest file (bytes).
const LONGEST: u64 = 1 << 20;

/// What a file says of a quantity.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Value {
    Number(f64),
    Text(String),
    Texts(Vec<String>),
    Entry(RawEntry),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawEntry {
    columns: Names,
    unit: Option<String>,
    sign: Option<Numbers>,
    offset: Option<Numbers>,
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Names {
    One(String),
    All(Vec<String>),
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Numbers {
    One(f64),
    All(Vec<f64>),
}

impl Numbers {
    fn all(self) -> Vec<f64> {
        match self {
            Self::One(number) => vec![number],
            Self::All(numbers) => numbers,
        }
    }
}

impl ColumnMap {
    /// The map that somebody gave in one word: its text, or the path of a YAML file. What has a `=` and is no file is a text.
    ///
    /// # Errors
    /// Those of the text, or of [`Self::read`].
    pub fn given(word: &str) -> Result<Self, LogError> {
        if word.contains('=') && !Path::new(word).is_file() { word.parse() } else { Self::read(word) }
    }

    /// Reads a map from a YAML file.
    ///
    /// # Errors
    /// [`LogError::NotFound`], [`LogError::Io`], and [`LogError::BadLine`] with line and field.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, LogError> {
        Self::read_file(path.as_ref())
    }

    fn read_file(path: &Path) -> Result<Self, LogError> {
        let file = File::open(path).map_err(|source| LogError::io(path, "open", source))?;
        let mut text = String::new();
        file.take(LONGEST + 1).read_to_string(&mut text).map_err(|source| LogError::io(path, "read", source))?;
        if text.len() as u64 > LONGEST {
            let detail = format!("more than {LONGEST} bytes; no map is that long");
            return Err(LogError::NotRead { path: path.to_path_buf(), detail });
        }
        Self::from_yaml(&text, path)
    }

    /// Reads a map from YAML; `name` is what errors call it.
    ///
    /// # Errors
    /// [`LogError::BadLine`] with line and field.
    pub fn from_yaml(text: &str, name: &Path) -> Result<Self, LogError> {
        let at = |line: u64, detail: String| LogError::BadLine { path: name.to_path_buf(), line, detail };
        let values: BTreeMap<String, Value> = serde_saphyr::from_str(text).map_err(|error| {
            let message = error.to_string();
            let message = message.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned();
            let message = if message.contains("untagged") {
                "is no column, list of columns, or {columns, unit, sign, offset}".to_owned()
            } else {
                message
            };
            at(error.location().map_or(1, |place| place.line()), message)
        })?;
        let line = |key: &str| -> u64 {
            let begins = |line: &str| line.strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with(':'));
            text.lines().position(begins).map_or(1, |line| line as u64 + 1)
        };
        let mut map = Self::default();
        for (key, value) in values {
            map.take_value(&key, value).map_err(|detail| at(line(&key), format!("field `{key}`: {detail}")))?;
        }
        if map == Self::default() {
            return Err(at(1, format!("says nothing; allowed: {}", allowed_keys())));
        }
        Ok(map)
    }

    fn take_value(&mut self, key: &str, value: Value) -> Result<(), String> {
        if let Some(quantity) = quantity_of(key) {
            let entry = match value {
                Value::Text(text) => entry(&text, quantity)?,
                Value::Texts(names) => Entry::of(Columns::List(names)),
                Value::Entry(raw) => {
                    let columns = match raw.columns {
                        Names::One(name) => Columns::Template(name),
                        Names::All(names) => Columns::List(names),
                    };
                    let unit = raw.unit.map(|text| Unit::parse(&text, quantity)).transpose()?;
                    let sign = raw.sign.map(Numbers::all).unwrap_or_default();
                    if let Some(wrong) = sign.iter().find(|sign| sign.abs() != 1.0) {
                        return Err(format!("sign {wrong}; allowed: 1, -1"));
                    }
                    let offset = raw.offset.map(Numbers::all).unwrap_or_default();
                    if let Some(wrong) = offset.iter().find(|offset| !offset.is_finite()) {
                        return Err(format!("offset {wrong}; allowed: finite numbers"));
                    }
                    Entry { columns, unit, sign, offset }
                }
                Value::Number(_) => return Err("is a number; a column is meant".to_owned()),
            };
            return self.insert(quantity, entry);
        }
        match (key, value) {
            ("schema", Value::Text(schema)) if schema == "tribo.map/1" => {}
            ("schema", _) => return Err("allowed: tribo.map/1".to_owned()),
            ("joint", Value::Text(column)) => self.joint = Some(column),
            ("topic", Value::Text(topic)) => self.topic = Some(topic),
            ("joints", Value::Texts(names)) => self.joints = names,
            ("rate", Value::Number(rate)) => self.rate_hz = Some(super::column_map::rate(&rate.to_string())?),
            ("episode", Value::Number(number)) if number.fract() == 0.0 && number.abs() < 9e15 => {
                let column = self.episode.take().and_then(|(column, _)| column);
                self.episode = Some((column, number as i64));
            }
            ("episode_column", Value::Text(column)) => {
                let number = self.episode.take().map_or(0, |(_, number)| number);
                self.episode = Some((Some(column), number));
            }
            ("joint" | "topic" | "joints" | "rate" | "episode" | "episode_column", _) => {
                return Err("is of another kind than it should be".to_owned());
            }
            _ => return Err(format!("is not known; allowed: schema, {}", allowed_keys())),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Quantity;

    #[test]
    fn a_file_says_what_a_text_cannot() {
        let text = "schema: tribo.map/1\ntime: t[ms]\nq: {columns: 'p_{joint}', unit: deg, sign: [1, -1], offset: 90}\n\
                    tau: [a, b]\nepisode: 3\nepisode_column: run\njoints: [u, v]\nrate: 500\n";
        let map = ColumnMap::from_yaml(text, Path::new("map.yaml")).unwrap();
        assert_eq!(map.to_string(), "time=t[ms],q=p_{joint}[deg],tau=a+b,joints=u+v,episode=run:3,rate=500");
        let q = map.entry(Quantity::Position).unwrap();
        assert_eq!((&q.sign[..], &q.offset[..]), (&[1.0, -1.0][..], &[90.0][..]));
    }

    #[test]
    fn what_is_wrong_has_a_line() {
        for (text, expected) in [
            ("q: a\nx: b\n", "map.yaml:2: field `x`: is not known; allowed: schema, time, q"),
            ("time: t\nq: {columns: a, unit: grad}\n", "map.yaml:2: field `q`: unit `grad` is not known"),
            ("q: {columns: a, sign: 2}\n", "map.yaml:1: field `q`: sign 2; allowed: 1, -1"),
            ("q: {columns: a, signs: 2}\n", "map.yaml:1: is no column"),
            ("q: 1\n", "map.yaml:1: field `q`: is a number"),
            ("schema: tribo.tune/1\n", "map.yaml:1: field `schema`: allowed: tribo.map/1"),
            ("{", "map.yaml:1: "),
        ] {
            let error = ColumnMap::from_yaml(text, Path::new("map.yaml")).unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
