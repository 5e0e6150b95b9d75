//! Logs with the columns of another program: `--map`, and what is said about them.

use std::path::Path;

use tribo_logs::{ColumnMap, LogSummary, ReadOptions};
use tribo_model::{ModelChoice, ModelFile};

use crate::arguments::Columns;
use crate::failure::BadInput;

impl Columns {
    /// The map that was given; names of joints are those of the arm, where they are known.
    ///
    /// # Errors
    /// What is wrong with it, with the entry or the line.
    pub fn options(&self, joints: Vec<String>) -> anyhow::Result<ReadOptions> {
        let mut map: Option<ColumnMap> = None;
        for given in &self.map {
            let next = ColumnMap::given(given).map_err(|error| BadInput(format!("--map: {error}")))?;
            map = Some(match map {
                Some(map) => map.and(next)?,
                None => next,
            });
        }
        Ok(ReadOptions { map, joints, most_rows: None })
    }
}

/// Names of the joints of the robot that a log is held against, base to tool; none of a preset, whose names nobody knows.
pub fn joint_names(choice: &ModelChoice, given: Option<&ModelFile>) -> Vec<String> {
    match (given, &choice.robot) {
        (Some(file), _) => file.names_of_joints(),
        (None, Some(robot)) => {
            let mut file = ModelFile {
                base_link: choice.base_link.clone(),
                tip_link: choice.tip_link.clone(),
                ..ModelFile::bare(robot, choice.torque_side, &[])
            };
            // What is wrong with the robot is said where it is used.
            file.resolve(Path::new("")).map_or_else(|_| Vec::new(), |_| file.names_of_joints())
        }
        (None, None) => Vec::new(),
    }
}

/// Says what the names of the columns were taken for, where nobody said it.
pub fn show_proposal(path: &Path, summary: &LogSummary, quiet: bool) {
    if let Some(mapping) = summary.mapping.as_ref().filter(|mapping| mapping.proposed && !quiet) {
        message!("tribo: {}: read as {mapping}; give --map to change it", path.display());
    }
}
