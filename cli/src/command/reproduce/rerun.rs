//! What rerunning any experiment takes: its settings, its threads and progress, its result.

use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use tribo_files::write_atomic;
use tribo_model::{FieldError, FileError, YamlDocument, read_text};

use crate::arguments::{Common, Reproduce};
use crate::failure::BadInput;
use crate::output::print;
use crate::threads;

/// Schema of what `--out` writes.
pub const RESULT_SCHEMA: &str = "tribo.reproduce.result/1";

/// The settings given, or those that ship with the experiment, with the seeds asked for; checked.
pub fn settings<C: DeserializeOwned>(
    arguments: &Reproduce,
    shipped: &str,
    validate: impl Fn(&C) -> Result<(), FieldError>,
    seeds: impl Fn(&mut C) -> &mut u64,
) -> anyhow::Result<C> {
    let mut config: C = match &arguments.config {
        Some(path) => {
            let document = YamlDocument::read(path)?;
            let config: C = document.parse()?;
            validate(&config).map_err(|error| document.explain(error))?;
            config
        }
        None => YamlDocument::embedded("config.yaml", shipped).parse()?,
    };
    if let Some(asked) = arguments.seeds {
        *seeds(&mut config) = asked;
    }
    validate(&config).map_err(|error| BadInput(error.to_string()))?;
    Ok(config)
}

/// Runs `work` on the threads asked for, under a bar of `count` of `what`, which `work` moves on.
pub fn with_progress<T: Send>(
    common: &Common,
    count: u64,
    what: &str,
    work: impl FnOnce(&ProgressBar) -> anyhow::Result<T> + Send,
) -> anyhow::Result<T> {
    let bar = if common.quiet { ProgressBar::hidden() } else { ProgressBar::new(count) };
    let template = format!("{{bar:30}} {{pos}}/{{len}} {what}  {{elapsed}}  eta {{eta}}");
    bar.set_style(ProgressStyle::with_template(&template)?);
    let result = threads::pool(common)?.install(|| work(&bar))?;
    bar.finish_and_clear();
    Ok(result)
}

/// Writes the result to `--out`, then prints it as it is or as `show` does.
pub fn deliver(text: &str, arguments: &Reproduce, common: &Common, show: impl FnOnce()) -> anyhow::Result<()> {
    if let Some(out) = &arguments.out {
        write_atomic(out, |file| file.write_all(text.as_bytes()))?;
    }
    if common.json {
        print(text.trim_end());
    } else if !common.quiet {
        show();
    }
    Ok(())
}

/// What `--out` writes and `--check` reads of an experiment that is a list of rows.
#[derive(Debug, Serialize, Deserialize)]
pub struct Rows<R> {
    schema: String,
    tribo_version: String,
    /// Seeds 1 to this one.
    pub seeds: u64,
    /// What was found.
    pub rows: Vec<R>,
}

impl<R: Serialize> Rows<R> {
    /// The result of this version.
    pub fn new(seeds: u64, rows: Vec<R>) -> Self {
        let (schema, tribo_version) = (RESULT_SCHEMA.to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        Self { schema, tribo_version, seeds, rows }
    }

    /// JSON with one line per row.
    pub fn text(&self) -> serde_json::Result<String> {
        let Self { schema, tribo_version, seeds, rows } = self;
        let rows = json_lines(rows)?;
        Ok(format!(
            "{{\n\"schema\": \"{schema}\",\n\"tribo_version\": \"{tribo_version}\",\n\"seeds\": {seeds},\n\"rows\": [\n{rows}\n]\n}}\n"
        ))
    }
}

/// One line per item, for diffs that people can read.
pub fn json_lines<T: Serialize>(items: &[T]) -> serde_json::Result<String> {
    let lines: Vec<String> = items.iter().map(serde_json::to_string).collect::<Result<_, _>>()?;
    Ok(lines.join(",\n"))
}

/// What `--check` compares with, if anything.
pub fn expected<T: DeserializeOwned>(arguments: &Reproduce) -> anyhow::Result<Option<T>> {
    arguments.check.as_deref().map(read_expected).transpose()
}

fn read_expected<T: DeserializeOwned>(path: &Path) -> anyhow::Result<T> {
    serde_json::from_str(&read_text(path)?).map_err(|error| {
        let (line, column) = (error.line() as u64, error.column() as u64);
        FileError::Syntax { path: path.to_owned(), line, column, message: error.to_string() }.into()
    })
}
