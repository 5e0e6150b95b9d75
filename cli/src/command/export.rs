//! `tribo export`.

use anyhow::Context;
use serde_json::json;
use tribo_experiments::files::{FileError, TunedFile, to_yaml};
use tribo_logs::write_atomic;

use crate::arguments::{Common, Export};
use crate::output::print;

/// Writes tuned parameters in another format.
pub fn run(arguments: &Export, common: &Common) -> anyhow::Result<()> {
    let path = if arguments.source.is_dir() { arguments.source.join("tuned.yaml") } else { arguments.source.clone() };
    let tuned = TunedFile::read(&path).map_err(|error| match error {
        FileError::Io { path, source } if source.kind() == std::io::ErrorKind::NotFound => {
            FileError::Campaign { path, message: "no tuned parameters here; has the campaign finished?".to_owned() }
        }
        other => other,
    })?;
    let text = match arguments.format.as_str() {
        "json" => format!("{:#}\n", json!(tuned)),
        _ => to_yaml(&tuned).context("serialising the parameters")?,
    };
    match &arguments.out {
        Some(out) => {
            write_atomic(out, |file| file.write_all(text.as_bytes()))?;
            if !common.quiet {
                eprintln!("written {}", out.display());
            }
        }
        None => print(text.trim_end()),
    }
    Ok(())
}
