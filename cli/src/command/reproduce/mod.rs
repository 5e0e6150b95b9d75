//! `tribo reproduce`.

mod roveda2022;
mod uhlmann2023;

use std::path::Path;

use serde::de::DeserializeOwned;
use tribo_experiments::files::{FileError, read_text};

use crate::arguments::{Common, Reproduce};

/// Runs the experiment of a paper, by its name or by the number of its folder.
pub fn run(arguments: &Reproduce, common: &Common) -> anyhow::Result<()> {
    match arguments.paper.as_str() {
        "uhlmann2023" | "05" => uhlmann2023::run(arguments, common),
        _ => roveda2022::run(arguments, common),
    }
}

/// Reads what an earlier `--out` wrote.
fn read_document<T: DeserializeOwned>(path: &Path) -> anyhow::Result<T> {
    serde_json::from_str(&read_text(path)?).map_err(|error| {
        let (line, column) = (error.line() as u64, error.column() as u64);
        FileError::Syntax { path: path.to_owned(), line, column, message: error.to_string() }.into()
    })
}
