//! The directory of a study.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::json;
use tribo_files::{write_atomic, write_new};
use tribo_model::{FileError, YamlDocument, read_text, to_yaml};

use super::{Cell, CellResult, Study};
use crate::first_difference;
use crate::leftovers::first_stranger;

const SETTINGS: &str = "study.yaml";
const CELLS: &str = "cells";

/// Schema name of the files of cells.
const SCHEMA: &str = "tribo.study.cell/1";

/// A study on disk: `study.yaml` with all that the study's file names, and `cells/NAME.json`, one per finished cell.
///
/// Every file appears whole and is the same whoever writes it; merging two directories of one study is copying.
#[derive(Clone, Debug)]
pub struct StudyStore {
    directory: PathBuf,
}

/// The file of a cell.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CellFile {
    schema: String,
    tribo_version: String,
    cell: String,
    result: CellResult,
}

impl StudyStore {
    /// Opens the directory of a study, or begins one in it: of several slices that begin at once one writes `study.yaml`, and it is that
    /// one's study that the others must have.
    ///
    /// # Errors
    /// A directory that holds another study or something else, in which nothing is changed; one that cannot be written.
    pub fn open(directory: &Path, study: &Study) -> Result<Self, FileError> {
        let path = directory.join(SETTINGS);
        if !path.exists() {
            check_free(directory)?;
            let text = to_yaml(study).map_err(FileError::io(&path))?;
            std::fs::create_dir_all(directory).map_err(FileError::io(directory))?;
            write_new(&path, |file| file.write_all(text.as_bytes()))?;
        }
        // Through the parser: files written by another version or hand may be spelt differently.
        let there: Study = YamlDocument::read(&path)?.parse()?;
        if there != *study {
            let differs = first_difference(&json!(there), &json!(study)).unwrap_or_default();
            let message = format!("holds another study (`{differs}` in its study.yaml differs); give another --out");
            return Err(FileError::Campaign { path: directory.to_owned(), message });
        }
        std::fs::create_dir_all(directory.join(CELLS)).map_err(FileError::io(directory))?;
        Ok(Self { directory: directory.to_owned() })
    }

    /// The directory.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    fn path(&self, study: &Study, cell: &Cell) -> PathBuf {
        self.directory.join(CELLS).join(format!("{}.json", cell.name(study)))
    }

    /// What came of a cell; none of one that is not finished.
    ///
    /// # Errors
    /// A file that is not what this study wrote.
    pub fn read(&self, study: &Study, cell: &Cell) -> Result<Option<CellResult>, FileError> {
        let path = self.path(study, cell);
        let text = match read_text(&path) {
            Ok(text) => text,
            Err(FileError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error),
        };
        let file: CellFile = serde_json::from_str(&text).map_err(|error| FileError::Syntax {
            path: path.clone(),
            line: error.line() as u64,
            column: error.column() as u64,
            message: format!("{error}; remove the file to have the cell computed again"),
        })?;
        if file.schema != SCHEMA || file.cell != cell.name(study) {
            let message = "is the file of another cell; remove it to have the cell computed again".to_owned();
            return Err(FileError::Campaign { path, message });
        }
        Ok(Some(file.result))
    }

    /// Writes what came of a cell.
    ///
    /// # Errors
    /// Those of the operating system.
    pub fn write(&self, study: &Study, cell: &Cell, result: &CellResult) -> Result<(), FileError> {
        let path = self.path(study, cell);
        let file = CellFile {
            schema: SCHEMA.to_owned(),
            tribo_version: env!("CARGO_PKG_VERSION").to_owned(),
            cell: cell.name(study),
            result: result.clone(),
        };
        let text = serde_json::to_string(&file).map_err(|error| FileError::io(&path)(error.into()))?;
        Ok(write_atomic(&path, |out| writeln!(out, "{text}"))?)
    }
}

/// Refuses a directory with anything in it but the beginnings of a study: a file that somebody is writing, cells from elsewhere.
fn check_free(directory: &Path) -> Result<(), FileError> {
    let begun = |name: &str, _: &Path| {
        name == CELLS || name == SETTINGS || (name.starts_with(".study.yaml.") && name.ends_with(".tmp"))
    };
    match first_stranger(directory, begun)? {
        Some(name) => {
            let message = format!("is not empty ({name}) and holds no study; give another --out");
            Err(FileError::Campaign { path: directory.to_owned(), message })
        }
        None => Ok(()),
    }
}
