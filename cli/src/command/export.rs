//! `tribo export`.

use anyhow::Context;
use serde_json::json;
use tribo_experiments::export::export;
use tribo_experiments::files::{FileError, TunedFile};
use tribo_logs::write_atomic;

use super::named;
use crate::arguments::{Common, Export};
use crate::output::{print, print_json};

/// Writes tuned parameters in another format, and says what that format cannot.
pub fn run(arguments: &Export, common: &Common) -> anyhow::Result<()> {
    let path = if arguments.source.is_dir() { arguments.source.join("tuned.yaml") } else { arguments.source.clone() };
    let tuned = TunedFile::read(&path).map_err(|error| match error {
        FileError::Io { path, source } if source.kind() == std::io::ErrorKind::NotFound => {
            FileError::Campaign { path, message: "no tuned parameters here; has the campaign finished?".to_owned() }
        }
        other => other,
    })?;
    let exported = export(&tuned, named(&arguments.format)?, arguments.name.as_deref())
        .with_context(|| format!("{} as {}", path.display(), arguments.format))?;
    if let Some(out) = &arguments.out {
        write_atomic(out, |file| file.write_all(exported.text.as_bytes()))?;
    }
    if !common.quiet {
        for loss in &exported.losses {
            message!("tribo: not in the {} file: {loss}", arguments.format);
        }
        if let Some(out) = &arguments.out {
            message!("written {}", out.display());
        }
    }
    if common.json {
        print_json(&json!({
            "schema": "tribo.export/1",
            "format": arguments.format,
            "robot": tuned.robot,
            "out": arguments.out,
            "text": arguments.out.is_none().then_some(&exported.text),
            "losses": exported.losses,
        }));
    } else if arguments.out.is_none() {
        print(exported.text.trim_end());
    }
    Ok(())
}
