//! How a log is to be read.

use crate::foreign::ColumnMap;

/// How a log is to be read; the default reads every known format, and tables whose names say what they hold.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Which columns are which; what it leaves open the names of the columns have to say. Of a bag: the topic.
    pub map: Option<ColumnMap>,
    /// Names of the arm's joints, base to tool, where they are known: columns and messages that name joints are matched by them.
    pub joints: Vec<String>,
}

impl From<ColumnMap> for ReadOptions {
    fn from(map: ColumnMap) -> Self {
        Self { map: Some(map), ..Self::default() }
    }
}
