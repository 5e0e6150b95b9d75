//! ROS 2 message definitions (`ros2msg`), as MCAP stores them, expanded into one tree of fields.
//!
//! ```text
//! [pkg/]Type[[n] | [] | [<=n]] name [default]      # comment        a field
//! type NAME=value                                                   a constant: takes no bytes
//! ====…                                                             then `MSG: pkg/Type` and its fields
//! ```
//!
//! The tree says in which order and with which type the fields lie in the bytes of a message, whatever the version of the
//! message is; [`Cdr`](crate::cdr::Cdr) reads the bytes. A definition may expand to `MOST_NODES` fields, which stops
//! one that contains itself.
//! Leaves out: `IDL:` definitions, default values, which no bytes depend on.

use std::collections::HashMap;

/// The most fields a definition may expand to; `FrankaRobotState`, the largest that is read, has about 400.
const MOST_NODES: usize = 10_000;

/// Type of a field without its array.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// `bool`, one byte.
    Bool,
    /// `int8`.
    I8,
    /// `uint8`, `byte`, `char`.
    U8,
    /// `int16`.
    I16,
    /// `uint16`.
    U16,
    /// `int32`.
    I32,
    /// `uint32`.
    U32,
    /// `int64`.
    I64,
    /// `uint64`.
    U64,
    /// `float32`.
    F32,
    /// `float64`.
    F64,
    /// `string`.
    Text,
    /// `wstring`, read over only.
    WideText,
    /// Another message, field by field.
    Struct(Vec<Node>),
}

/// How often a field is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Count {
    /// Once.
    One,
    /// An array of this length.
    Fixed(usize),
    /// A length in front, bounded or not.
    Sequence,
}

/// A field, and the slot that takes its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Its name in the message.
    pub name: String,
    /// Its type.
    pub kind: Kind,
    /// How often it is there.
    pub count: Count,
    /// The slot that takes its values; `None` reads over them.
    pub slot: Option<usize>,
}

/// The fields of a message, or why the definition is not understood.
pub fn expand(schema_name: &str, definition: &str) -> Result<Vec<Node>, String> {
    let root = short_name(schema_name);
    let mut types: HashMap<String, Vec<&str>> = HashMap::new();
    let mut current = root.clone();
    for line in definition.lines().map(str::trim) {
        if line.len() >= 3 && line.bytes().all(|b| b == b'=') {
            continue;
        }
        if let Some(name) = line.strip_prefix("MSG:") {
            current = short_name(name.trim());
        } else if line.starts_with("IDL:") {
            return Err("its definition is in IDL, which is not read".to_owned());
        } else {
            types.entry(current.clone()).or_default().push(line);
        }
    }
    Expansion { types, nodes: 0 }.fields_of(&root, 0)
}

/// Gives the field at `path` (names joined by dots) to a slot; whether there is such a field, outside arrays of messages.
pub fn bind(nodes: &mut [Node], path: &str, slot: usize) -> bool {
    let (name, rest) = path.split_once('.').map_or((path, None), |(name, rest)| (name, Some(rest)));
    let Some(node) = nodes.iter_mut().find(|node| node.name == name) else { return false };
    match (&mut node.kind, rest) {
        (Kind::Struct(inner), Some(rest)) if node.count == Count::One => bind(inner, rest, slot),
        (Kind::Struct(_) | Kind::WideText, _) | (_, Some(_)) => false,
        (_, None) => {
            node.slot = Some(slot);
            true
        }
    }
}

/// `pkg/msg/Type` as `pkg/Type`.
fn short_name(name: &str) -> String {
    let parts: Vec<&str> = name.split('/').collect();
    match parts.as_slice() {
        [package, .., name] => format!("{package}/{name}"),
        _ => name.to_owned(),
    }
}

struct Expansion<'t> {
    types: HashMap<String, Vec<&'t str>>,
    nodes: usize,
}

impl Expansion<'_> {
    fn fields_of(&mut self, name: &str, depth: usize) -> Result<Vec<Node>, String> {
        let lines = match self.types.get(name) {
            Some(lines) => lines.clone(),
            // Some recorders leave out what everybody knows.
            None if matches!(name, "builtin_interfaces/Time" | "builtin_interfaces/Duration") => {
                vec!["int32 sec", "uint32 nanosec"]
            }
            // An empty message may come without a line of its own.
            None if depth == 0 => Vec::new(),
            None => return Err(format!("its definition lacks {name}")),
        };
        let mut fields = Vec::new();
        for line in lines {
            let Some((kind, field)) = declaration(line) else { continue };
            self.nodes += 1;
            // A chain of messages without fields beside each other grows no tree: depth is bounded too.
            if self.nodes > MOST_NODES || depth > 64 {
                return Err(format!("its definition expands to more than {MOST_NODES} fields"));
            }
            let (kind, count) =
                array(kind).ok_or_else(|| format!("`{}` is no field", crate::error::shown(line.as_bytes())))?;
            let kind = match primitive(kind) {
                Some(primitive) => primitive,
                None => Kind::Struct(self.fields_of(&resolved(kind, name), depth + 1)?),
            };
            fields.push(Node { name: field.to_owned(), kind, count, slot: None });
        }
        Ok(fields)
    }
}

/// Type and name of a field line; `None` for a blank line, a comment or a constant.
fn declaration(line: &str) -> Option<(&str, &str)> {
    let code = line.split('#').next()?;
    let mut words = code.split_whitespace();
    let (kind, name) = (words.next()?, words.next()?);
    let constant = name.contains('=') || words.next().is_some_and(|word| word.starts_with('='));
    (!constant).then_some((kind, name))
}

/// A type without its array, and how often it is there.
fn array(kind: &str) -> Option<(&str, Count)> {
    let Some(open) = kind.find('[') else { return Some((kind, Count::One)) };
    let length = kind[open + 1..].strip_suffix(']')?;
    let count = if length.is_empty() || length.starts_with("<=") {
        Count::Sequence
    } else {
        Count::Fixed(length.parse().ok()?)
    };
    Some((&kind[..open], count))
}

fn primitive(kind: &str) -> Option<Kind> {
    // `string<=8` is a string.
    Some(match kind.split("<=").next()? {
        "bool" => Kind::Bool,
        "int8" => Kind::I8,
        "uint8" | "byte" | "char" => Kind::U8,
        "int16" => Kind::I16,
        "uint16" => Kind::U16,
        "int32" => Kind::I32,
        "uint32" => Kind::U32,
        "int64" => Kind::I64,
        "uint64" => Kind::U64,
        "float32" => Kind::F32,
        "float64" => Kind::F64,
        "string" => Kind::Text,
        "wstring" => Kind::WideText,
        _ => return None,
    })
}

/// The full name of a type used inside the message `user`.
fn resolved(kind: &str, user: &str) -> String {
    match kind {
        "Header" => "std_msgs/Header".to_owned(),
        "time" => "builtin_interfaces/Time".to_owned(),
        "duration" => "builtin_interfaces/Duration".to_owned(),
        kind if kind.contains('/') => short_name(kind),
        kind => user.split_once('/').map_or_else(|| kind.to_owned(), |(package, _)| format!("{package}/{kind}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_constants_arrays_and_nested_messages() {
        let text = "# comment\nuint8 A=1\nuint8 B = 2\nfloat64[7] q # joints\nint32 n 5\nHeader header\nOther[<=3] others\nstring<=8 s\n\
                    ================\nMSG: std_msgs/Header\ntime stamp\nstring frame_id\n===\nMSG: pkg/Other\nbool b\n";
        let nodes = expand("pkg/msg/Main", text).unwrap();
        let names: Vec<&str> = nodes.iter().map(|node| node.name.as_str()).collect();
        assert_eq!(names, ["q", "n", "header", "others", "s"]);
        assert_eq!((&nodes[0].kind, nodes[0].count), (&Kind::F64, Count::Fixed(7)));
        assert_eq!(nodes[3].count, Count::Sequence);
        let mut nodes = nodes;
        assert!(bind(&mut nodes, "header.stamp.nanosec", 3) && bind(&mut nodes, "q", 0));
        for path in ["header", "header.x", "q.x", "others.b", "x", ""] {
            assert!(!bind(&mut nodes, path, 1), "{path}");
        }
    }

    #[test]
    fn definitions_that_cannot_be_laid_out_say_why() {
        assert_eq!(expand("p/A", "B b").unwrap_err(), "its definition lacks p/B");
        assert!(expand("p/A", "A a").unwrap_err().contains("more than 10000"));
        let wide: String = (0..40).map(|k| format!("B b{k}\n")).collect();
        let nested =
            format!("{wide}===\nMSG: p/B\n{}", wide.replace('B', "C") + "===\nMSG: p/C\n" + &wide.replace('B', "D"));
        assert!(expand("p/A", &format!("{nested}===\nMSG: p/D\nint8 x")).unwrap_err().contains("more than 10000"));
        assert_eq!(expand("p/A", "float64[x] q").unwrap_err(), "`float64[x] q` is no field");
        assert!(expand("p/A", "===\nIDL: p/A\n").unwrap_err().contains("IDL"));
        assert!(expand("p/A", "").unwrap().is_empty());
    }
}
