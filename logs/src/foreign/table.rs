//! A foreign table: its columns by name first, the cells of those that are wanted later.

use tribo_files::LogError;

use crate::format::LogFormat;

/// What the cells of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Number,
    Text,
}

/// A column as a file announces it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    /// Its name; of an entry of a list column, or of an array, `name[k]`.
    pub name: String,
    pub kind: Kind,
    /// The unit that the type of the column says.
    pub unit: Option<&'static str>,
    /// The list that it is an entry of.
    pub list: Option<String>,
}

impl Column {
    pub fn new(name: impl Into<String>, kind: Kind) -> Self {
        Self { name: name.into(), kind, unit: None, list: None }
    }

    /// Its name as it is shown.
    pub fn shown(&self) -> &str {
        if self.name.is_empty() { "(unnamed)" } else { &self.name }
    }

    /// Entry `index` of a list.
    pub fn entry(list: &str, index: usize) -> Self {
        Self { list: Some(list.to_owned()), ..Self::new(format!("{list}[{index}]"), Kind::Number) }
    }
}

/// The cells of a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Cells {
    /// `base + value`; a base is taken out of large integers, which `f64` would round. A cell that is not there is not a number.
    Numbers { base: i64, values: Vec<f64> },
    /// Which of the labels each row has; `u32::MAX` where it has none.
    Text { labels: Vec<String>, of_row: Vec<u32> },
}

impl Cells {
    pub fn numbers() -> Self {
        Self::Numbers { base: 0, values: Vec::new() }
    }

    pub fn text() -> Self {
        Self::Text { labels: Vec::new(), of_row: Vec::new() }
    }

    /// Appends a label; false where there are too many different ones for names of joints.
    pub fn push_label(&mut self, label: &str) -> bool {
        let Self::Text { labels, of_row } = self else { return false };
        if label.is_empty() {
            of_row.push(u32::MAX);
            return true;
        }
        // Rows of a long table take turns: the label after the one before is the likely one.
        let guess = of_row.last().map_or(0, |&last| (last as usize).wrapping_add(1));
        let found = match labels.get(guess) {
            Some(known) if known == label => Some(guess),
            _ => labels.iter().position(|known| known == label),
        };
        let place = found.unwrap_or_else(|| {
            labels.push(label.to_owned());
            labels.len() - 1
        });
        of_row.push(place as u32);
        labels.len() <= MOST_LABELS
    }
}

/// The most different labels of a column that names joints.
const MOST_LABELS: usize = 1024;

/// Integers from here on are read with a base: epochs in seconds, and all finer ones.
pub(crate) const LARGE: u64 = 1 << 30;

/// Rows of a file that was read.
#[derive(Debug, Default)]
pub(crate) struct Loaded {
    /// Cells of the wanted columns, in the order wanted.
    pub cells: Vec<Cells>,
    /// Line of each row in a text file, from 1; empty for other files.
    pub lines: Vec<u32>,
    pub warnings: Vec<String>,
}

/// A file that holds a table.
pub(crate) trait ForeignTable {
    /// The columns.
    fn columns(&self) -> &[Column];

    /// Names of what is there and no column of numbers or names.
    fn left_out(&self) -> &[String];

    /// The format of the file.
    fn format(&self) -> LogFormat;

    /// The cells of these columns.
    fn load(&self, wanted: &[usize]) -> Result<Loaded, LogError>;
}
