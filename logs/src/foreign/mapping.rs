//! What became of a foreign table: which of its columns is which of ours.

use std::fmt;

use serde_json::{Value, json};

/// One column of the log, and where it comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MappedColumn {
    /// Its canonical name, such as `q_0`.
    pub column: String,
    /// The name in the file; of the joint of a long table `COLUMN of JOINT`.
    pub from: String,
    /// The unit in the file.
    pub unit: String,
}

/// Which columns of a foreign table became which quantity, and who said so.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mapping {
    /// The map as text; give it back to say the same.
    pub map: String,
    /// Whether the names of the columns were all that said so, and nobody gave a map.
    pub proposed: bool,
    /// How joints are told apart, in words.
    pub joints: String,
    /// Column by column.
    pub columns: Vec<MappedColumn>,
}

impl Mapping {
    /// Which column became which, as `read_as` of JSON documents has it.
    #[must_use]
    pub fn to_json(&self) -> Value {
        json!({
            "map": self.map,
            "proposed": self.proposed,
            "joints": self.joints,
            "columns": self.columns.iter().map(|column| {
                json!({"column": column.column, "from": column.from, "unit": column.unit})
            }).collect::<Vec<_>>(),
        })
    }
}

impl fmt::Display for Mapping {
    /// `q=pos_{joint}[deg],tau=eff_{joint},time=stamp; joints numbered from 1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; {}", self.map, self.joints)
    }
}
