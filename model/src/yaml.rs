//! Reading and writing YAML with errors that name file, line and field.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::{FieldError, FileError};

/// The largest text that is read (bytes), a thousand times that of any file of ours: `/dev/zero` has no end.
const LARGEST: u64 = 64 << 20;

/// The whole text of a file; bytes that are no text are named by their place.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(FileError::io(path))?;
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(FileError::io(path))?;
    if bytes.len() as u64 > LARGEST {
        let message = format!("more than {LARGEST} bytes; no file of this kind is that large");
        return Err(FileError::Syntax { path: path.to_owned(), line: 1, column: 1, message });
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = good.iter().filter(|&&byte| byte == b'\n').count() as u64 + 1;
        let column = good.iter().rev().take_while(|&&byte| byte != b'\n').count() as u64 + 1;
        FileError::Syntax { path: path.to_owned(), line, column, message: "not UTF-8 text".to_owned() }
    })
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
    #[inline(never)]
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, FileError> {
        let mut parsed = None;
        self.parse_into(&mut |yaml| {
            parsed = Some(erased_serde::deserialize(yaml)?);
            Ok(())
        })?;
        parsed.ok_or_else(|| self.refused("nothing was read", 1, 1))
    }

    /// The parser, compiled once whatever it reads: of its own it makes a tenth of a megabyte for each type.
    fn parse_into(
        &self,
        read: &mut dyn FnMut(&mut dyn erased_serde::Deserializer<'_>) -> Result<(), erased_serde::Error>,
    ) -> Result<(), FileError> {
        let parsed = serde_saphyr::with_deserializer_from_str(&self.text, |yaml| {
            read(&mut <dyn erased_serde::Deserializer<'_>>::erase(yaml)).map_err(serde::de::Error::custom)
        });
        parsed.map_err(|error| {
            let text = error.to_string();
            let (text, within) = without_places(&text);
            let place = within.or_else(|| error.location().map(|at| (at.line(), at.column())));
            let (line, column) = place.unwrap_or((1, 1));
            self.refused(text, line, column)
        })
    }

    /// The parser's error with its place.
    fn refused(&self, text: &str, line: u64, column: u64) -> FileError {
        let message = self.message(text, line);
        FileError::Syntax { path: self.path.clone(), line, column, message }
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

    /// The parser's message for people, with the field it is about.
    fn message(&self, message: &str, line: u64) -> String {
        // The library's message may span lines with a drawing of the source; its first line says it all but the field.
        let message = message.lines().next().unwrap_or_default().trim_start_matches("error: ");
        let message = match message.split_once(": ") {
            Some((place, rest)) if place.starts_with("line ") => rest,
            _ => message,
        };
        let message = match message.strip_prefix("invalid ") {
            Some("u8" | "u16" | "u32" | "u64" | "usize") => "not a whole number",
            Some("floating point") => "not a number",
            _ if message.starts_with("non-finite float") => "not a finite number",
            _ => message,
        };
        match self.field_at(line) {
            Some(field) if !message.contains('`') || message.starts_with("unknown variant") => {
                format!("field `{field}`: {message}")
            }
            _ => message.to_owned(),
        }
    }

    /// Dotted path of the key on a line (from 1), in block style.
    fn field_at(&self, line: u64) -> Option<String> {
        let lines: Vec<(usize, &str)> = self.text.lines().take(line as usize).filter_map(key).collect();
        let last = self.text.lines().nth(line.checked_sub(1)? as usize).and_then(key)?;
        let mut path = vec![last.1];
        let mut column = last.0;
        for (outer, name) in lines.into_iter().rev() {
            if outer < column {
                path.push(name);
                column = outer;
            }
        }
        path.reverse();
        Some(path.join("."))
    }

    /// Line (from 1) of the key at a dotted path such as `limits.error_m` or `friction.joints[2].coulomb_nm`, in block
    /// style; for a path that cannot be followed to its end, the line of its deepest part that was found.
    pub fn line_of(&self, path: &str) -> Option<u64> {
        let lines: Vec<&str> = self.text.lines().collect();
        let mut found = None;
        let mut block = 0..lines.len();
        for part in path.split('.') {
            let (name, item) = match part.strip_suffix(']').and_then(|part| part.split_once('[')) {
                Some((name, item)) => (name, item.parse::<usize>().ok()),
                None => (part, None),
            };

            // The key, among its siblings: the keys in the column of the first one.
            let siblings = block.clone().find_map(|k| key(lines[k])).map(|(column, _)| column);
            let Some(at) =
                block.clone().find(|&k| key(lines[k]).is_some_and(|it| (Some(it.0), it.1) == (siblings, name)))
            else {
                break;
            };
            found = Some(at as u64 + 1);

            // What belongs to it: everything deeper, and the items of a list even in its own column.
            let own = siblings.unwrap_or(0);
            let outside = |k: &usize| column(lines[*k]).is_some_and(|c| c < own || (c == own && !is_item(lines[*k])));
            block = at + 1..(at + 1..block.end).find(outside).unwrap_or(block.end);
            if let Some(item) = item {
                let bullet = block.clone().find(|&k| is_item(lines[k])).and_then(|k| column(lines[k]));
                let mut items = block.clone().filter(|&k| is_item(lines[k]) && column(lines[k]) == bullet);
                let Some(start) = items.nth(item) else {
                    break;
                };
                found = Some(start as u64 + 1);
                block = start..items.next().unwrap_or(block.end);
            }
        }
        found
    }
}

/// A message without the places that every level of the document appended to it, and the innermost one of them.
fn without_places(mut message: &str) -> (&str, Option<(u64, u64)>) {
    let mut innermost = None;
    while let Some((before, place)) = message.rsplit_once(" at line ") {
        let place = place.split_once(", column ");
        let Some((Ok(line), Ok(column))) = place.map(|(line, column)| (line.parse(), column.parse())) else { break };
        (message, innermost) = (before, Some((line, column)));
    }
    (message, innermost)
}

/// Column of the first character of a line with content.
fn column(line: &str) -> Option<usize> {
    let content = line.trim_start();
    (!content.is_empty() && !content.starts_with('#')).then(|| line.len() - content.len())
}

/// Whether a line begins an item of a list.
fn is_item(line: &str) -> bool {
    line.trim_start().starts_with("- ")
}

/// Column and name of the key on a line, behind the bullet if there is one.
fn key(line: &str) -> Option<(usize, &str)> {
    let content = line.trim_start_matches([' ', '-']);
    let name = content.split_once(':').map(|(name, _)| name)?;
    let plain = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    plain.then(|| (line.len() - content.len(), name))
}

/// Serialises to YAML text.
pub fn to_yaml<T: Serialize>(value: &T) -> Result<String, std::io::Error> {
    written(value)
}

/// The writer, compiled once whatever it writes.
fn written(value: &dyn erased_serde::Serialize) -> Result<String, std::io::Error> {
    serde_saphyr::to_string(&value).map_err(std::io::Error::other)
}

/// The name that a setting has in files.
pub fn file_name(value: &impl Serialize) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(name)) => name,
        Ok(other) => other.to_string(),
        Err(_) => String::new(),
    }
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
        let doc = document("a:\n- x: 1\n  y: 2\n- x: 3\n  y: 4\nb:\n  - x: 5\n\n  -  x: 6\n     y: 7\ny: 8\n");
        let lines = ["a[0].x", "a[0].y", "a[1].x", "a[1].y", "b[0].x", "b[0].y", "b[1].y", "y", "a[2].x"];
        let expected = [2, 3, 4, 5, 7, 7, 10, 11, 1];
        assert_eq!(lines.map(|path| doc.line_of(path)), expected.map(Some));
        let doc = document("limits:\n  error_m: 0.05\nother:\n  seed: 5\nseed: 1\n");
        assert_eq!(doc.line_of("seed"), Some(5));
        let doc = document("seed: 1\nlimits:\n  # metres\n  error_m: 0.05\nekf:\n  error_m: 7\n");
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
        assert_eq!(wrong, "some.yaml:3:4: field `a`: not a whole number");
    }

    #[test]
    fn a_wrong_type_deep_inside_names_its_path() {
        #[derive(Debug, Default, serde::Deserialize)]
        #[allow(dead_code)]
        struct Outer {
            inner: Inner,
        }
        #[derive(Debug, Default, serde::Deserialize)]
        #[allow(dead_code)]
        struct Inner {
            x: f64,
        }
        let wrong = document("# c\ninner:\n  # d\n  x: wide\n").parse::<Outer>().unwrap_err().to_string();
        assert_eq!(wrong, "some.yaml:4:6: field `inner.x`: not a number");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_without_end_is_refused() {
        let message = read_text(Path::new("/dev/zero")).unwrap_err().to_string();
        assert_eq!(message, "/dev/zero:1:1: more than 67108864 bytes; no file of this kind is that large");
    }

    #[test]
    fn bytes_that_are_no_text_are_named_by_their_place() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.yaml");
        std::fs::write(&path, b"a: 1\nb: \xff\n").unwrap();
        let message = read_text(&path).unwrap_err().to_string();
        assert!(message.ends_with("a.yaml:2:4: not UTF-8 text"), "{message}");
    }
}
