//! What can be wrong with a file, told so that it can be mended.

use std::path::PathBuf;

/// A file that cannot be used. Every variant names the file; those about content name line and field too.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not YAML, a wrong type, a missing or an unknown key.
    #[error("{}:{line}:{column}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Column, from 1.
        column: u64,
        /// What is wrong.
        message: String,
    },
    /// A value outside its range.
    #[error("{}{}: field `{field}` is {value}; allowed: {allowed}", path.display(), line.map_or(String::new(), |line| format!(":{line}")))]
    Range {
        /// The file.
        path: PathBuf,
        /// Line, from 1, where it could be found.
        line: Option<u64>,
        /// Dotted path of the field.
        field: String,
        /// The value given.
        value: String,
        /// The allowed range.
        allowed: String,
    },
    /// A log of which nobody says whose it is.
    #[error("{}: {joints} joints; say which robot that is: --robot NAME, URDF or MJCF, or --model FILE", path.display())]
    NoRobot {
        /// The log.
        path: PathBuf,
        /// Its number of joints.
        joints: usize,
    },
    /// A robot description that is no arm.
    #[error("{}: {source}", path.display())]
    Description {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: Box<tribo_robot::DescriptionError>,
    },
    /// A line of a journal that is not what it should be.
    #[error("{}:{line}: corrupt journal: {message}", path.display())]
    Journal {
        /// The journal.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// What is wrong.
        message: String,
    },
    /// A campaign is there already, or is not there, or is in use.
    #[error("{}: {message}", path.display())]
    Campaign {
        /// The campaign directory.
        path: PathBuf,
        /// What is wrong and what to do.
        message: String,
    },
    /// A stored trial log or another binary file is damaged.
    #[error(transparent)]
    Log(#[from] tribo_files::LogError),
}

impl FileError {
    /// Wraps an error of the operating system.
    pub fn io(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, source }
    }
}
