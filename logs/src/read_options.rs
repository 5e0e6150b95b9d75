//! How a log is to be read.

use crate::foreign::ColumnMap;

/// How a log is to be read; the default reads every known format, and tables whose names say what they hold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Which columns are which; what it leaves open the names of the columns have to say. Of a bag: the topic.
    pub map: Option<ColumnMap>,
    /// Names of the arm's joints, base to tool, where they are known: columns and messages that name joints are matched by them.
    pub joints: Vec<String>,
    /// Rows from which on evenly spread stretches of ten seconds stand for the whole log; none reads every row. Of CSV files no more than these and
    /// 65 536 rows are ever in memory.
    pub most_rows: Option<usize>,
}

impl From<ColumnMap> for ReadOptions {
    fn from(map: ColumnMap) -> Self {
        Self { map: Some(map), ..Self::default() }
    }
}
