//! Every way a log can be refused, with the place and the value in the variant.
//!
//! Lines and columns are counted from 1, as editors do; rows of a log in memory from 0, as indices do.
//! Variants without a path speak of a log in memory; [`LogError::InFile`] adds the file they came from.

use std::io;
use std::path::{Path, PathBuf};

/// Why a log could not be read, validated or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogError {
    /// Nothing is there.
    #[error("{path}: no such file or directory")]
    NotFound {
        /// What was asked for.
        path: PathBuf,
    },
    /// A directory stands where a file is needed.
    #[error("{path}: is a directory, expected a {expected} file")]
    IsDirectory {
        /// The directory.
        path: PathBuf,
        /// The kind of file expected.
        expected: &'static str,
    },
    /// The target of a write is a device, pipe or socket: it cannot be replaced atomically.
    #[error("{path}: exists and is not a regular file; it is left untouched")]
    NotRegularFile {
        /// The target.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("{path}: cannot {action}: {source}")]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// What was attempted: `open`, `read`, `write`, `replace`, `sync`.
        action: &'static str,
        /// The reason given.
        source: io::Error,
    },
    /// No file can be created in the directory of the target.
    #[error("{directory}: cannot create a file in this directory: {source}")]
    DirectoryNotWritable {
        /// The directory.
        directory: PathBuf,
        /// The reason given.
        source: io::Error,
    },
    /// The file holds no byte, or no line with content.
    #[error("{path}: is empty")]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The content is none of the known formats.
    #[error(
        "{path}: unknown format ({found}); known: canonical CSV (columns time, q_0.., dq_0.., tau_J_0..), plain or gzip; \
         Parquet with the same columns; directory of exciting_traj_*.txt (Gaz 2019); Kinova Gen3 CSV (Time, Position1.., TorqueSm1.., \
         TorqueCur1..) and libfranka CSV (time, state.q[0].., cmd..), plain or gzip; \
         MCAP or SQLite (or the directory of a rosbag2) with sensor_msgs/JointState, franka_msgs/FrankaRobotState or JSON; \
         tables of other columns (CSV, Parquet, npz) by --map"
    )]
    UnknownFormat {
        /// The file or directory.
        path: PathBuf,
        /// What its first bytes look like.
        found: String,
    },
    /// An MCAP file has no topic that a log can be made of.
    #[error(
        "{path}: no topic with joint positions, velocities and torques; {}",
        if topics.is_empty() { "it has no messages".to_owned() } else { topics.join("; ") }
    )]
    NoReadableTopic {
        /// The file.
        path: PathBuf,
        /// Topic, type and why it is none, each.
        topics: Vec<String>,
    },
    /// A message of the topic that is read is broken.
    #[error("{path}: topic {topic}, message {message}: {detail}")]
    BadMessage {
        /// The file.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// Number of the message on its topic, from 0.
        message: u64,
        /// Field and value.
        detail: String,
    },
    /// Compressed data or a checksum is damaged.
    #[error("{path}: damaged or cut off: {detail}")]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// What was wrong.
        detail: String,
    },
    /// The file is whole, and in a way that is not read.
    #[error("{path}: {detail}")]
    NotRead {
        /// The file.
        path: PathBuf,
        /// What it is, and what would be read.
        detail: String,
    },
    /// A column map says what is not understood.
    #[error("column map `{entry}`: {detail}")]
    BadMap {
        /// The part that is wrong.
        entry: String,
        /// Why, and what is allowed.
        detail: String,
    },
    /// A line cannot be split into cells.
    #[error("{path}:{line}: {detail}")]
    BadLine {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// What was wrong.
        detail: String,
    },
    /// A line has more or fewer cells than the header.
    #[error("{path}:{line}: {got} cells, the header has {expected}")]
    CellCount {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Cells in the line.
        got: usize,
        /// Cells in the header.
        expected: usize,
    },
    /// A cell is not a finite number.
    #[error("{path}:{line}: column {column}: `{value}` is not a finite decimal number")]
    BadCell {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Column name.
        column: String,
        /// The text found, shortened.
        value: String,
    },
    /// A time stamp does not exceed the one before (and the row is no exact repeat).
    #[error("{path}:{line}: column time: {value_s} s does not exceed the stamp before, {previous_s} s")]
    TimeStepsBack {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Stamp before (s).
        previous_s: f64,
        /// Stamp of this line (s).
        value_s: f64,
    },
    /// Two files that belong together disagree in length.
    #[error(
        "{path}: {values} values, expected {expected} = {per_stamp} per stamp for the {stamps} stamps of {time_path}"
    )]
    CountMismatch {
        /// The file with the wrong count.
        path: PathBuf,
        /// Values in it.
        values: usize,
        /// Values it should have.
        expected: usize,
        /// Values per stamp.
        per_stamp: usize,
        /// The file of time stamps.
        time_path: PathBuf,
        /// Stamps in it.
        stamps: usize,
    },
    /// A column name occurs twice.
    #[error("column `{}` occurs twice, as columns {first} and {second}", visible(column))]
    DuplicateColumn {
        /// Column name.
        column: String,
        /// Position of the first, from 1.
        first: usize,
        /// Position of the second, from 1.
        second: usize,
    },
    /// Columns that the canonical log needs are absent.
    #[error(
        "missing {}: {}{}",
        if missing.len() == 1 { "column" } else { "columns" },
        missing.join(", "),
        if unknown.is_empty() { String::new() } else { format!(" (not understood: {})", listed(unknown)) }
    )]
    MissingColumns {
        /// Names that should be there.
        missing: Vec<String>,
        /// Names that are there and mean nothing to us.
        unknown: Vec<String>,
    },
    /// A column that holds zero in every row, as recorders write what they did not measure.
    #[error("column {column} is zero in all {rows} rows: not logged")]
    NotLogged {
        /// Column name.
        column: String,
        /// Rows of the file.
        rows: usize,
    },
    /// A quantity of a log in memory has the wrong number of columns.
    #[error("{quantity}: {got} columns, expected {expected}")]
    ColumnCount {
        /// Name of the first column of the quantity.
        quantity: String,
        /// Columns found.
        got: usize,
        /// Columns expected.
        expected: usize,
    },
    /// A column is longer or shorter than the others.
    #[error("column {column}: {got} rows, expected {expected}")]
    ColumnLength {
        /// Column name.
        column: String,
        /// Rows found.
        got: usize,
        /// Rows of the first column.
        expected: usize,
    },
    /// A log needs at least two rows.
    #[error("{got} rows, expected at least {need}")]
    TooFewRows {
        /// Rows found.
        got: usize,
        /// Rows needed.
        need: usize,
    },
    /// A cell of a log in memory is NaN or infinite.
    #[error("column {column}, row {row}: {value} is not finite")]
    NotFinite {
        /// Column name.
        column: String,
        /// Row, from 0.
        row: usize,
        /// The value.
        value: f64,
    },
    /// Time of a log in memory does not increase strictly.
    #[error("column time, row {row}: {value_s} s does not exceed the stamp before, {previous_s} s")]
    TimeNotIncreasing {
        /// Row, from 0.
        row: usize,
        /// Stamp before (s).
        previous_s: f64,
        /// Stamp of this row (s).
        value_s: f64,
    },
    /// Somebody asked to stop before the file was whole.
    #[error("{path}: stopped; nothing is written")]
    Stopped {
        /// The file that was to be read, or written.
        path: PathBuf,
    },
    /// A setting lies outside its range.
    #[error("{field}: {value} is outside {allowed}")]
    OutOfRange {
        /// Name of the setting.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The allowed range.
        allowed: &'static str,
    },
    /// An error of the content, with the file it came from.
    #[error("{path}: {source}")]
    InFile {
        /// The file.
        path: PathBuf,
        /// The error.
        source: Box<LogError>,
    },
}

impl LogError {
    /// Adds the file to an error of the content.
    #[must_use]
    pub fn in_file(self, path: &Path) -> Self {
        Self::InFile { path: path.to_path_buf(), source: Box::new(self) }
    }

    /// An error of the operating system, with missing files told apart.
    pub fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        let path = path.to_path_buf();
        match source.kind() {
            io::ErrorKind::NotFound => Self::NotFound { path },
            io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData => {
                Self::Corrupt { path, detail: source.to_string() }
            }
            _ => Self::Io { path, action, source },
        }
    }
}

/// A name out of a file as it can be shown: on one line, control characters written out.
pub fn visible(name: &str) -> String {
    if name.chars().any(char::is_control) {
        name.chars().flat_map(char::escape_debug).collect()
    } else {
        name.to_owned()
    }
}

/// Names, separated by commas.
fn listed(names: &[String]) -> String {
    names.iter().map(|name| visible(name)).collect::<Vec<_>>().join(", ")
}

/// The text of a cell as it can be shown: at most 40 characters, no control characters.
pub fn shown(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(bytes);
    let mut short: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().count() > LONGEST {
        short.push('…');
    }
    short
}
