//! `tribo dashboard`.

use std::path::{Path, PathBuf};

use tribo_dashboard::{LogSource, Options, screenshot};

use super::{CAMPAIGNS, named, now};
use crate::arguments::Dashboard;
use crate::failure::BadInput;

/// Opens the window, or draws it.
pub fn run(arguments: &Dashboard) -> anyhow::Result<()> {
    let model = arguments.of.choice()?;
    let read = arguments.columns.options(Vec::new())?;
    let open = arguments.open.as_ref().map(|path| LogSource { path: path.clone(), read, model });
    if let Some(path) = arguments.open.as_ref().filter(|path| !path.exists()) {
        return Err(BadInput(format!("{}: there is no such file or directory", path.display())).into());
    }
    let view = arguments.view.as_deref().map(named).transpose()?;
    let options = Options { view, compare: arguments.compare.clone(), ..options(open) };
    match &arguments.screenshot {
        Some(out) => screenshot(options, arguments.size, arguments.dark, out)?,
        None => tribo_dashboard::run(options).map_err(|error| BadInput(error.to_string()))?,
    }
    Ok(())
}

/// The window of a campaign that this process runs.
pub fn watch(directory: &Path) -> Result<(), tribo_dashboard::NoWindow> {
    tribo_dashboard::run(options(Some(LogSource { path: directory.to_owned(), ..LogSource::default() })))
}

fn options(open: Option<LogSource>) -> Options {
    Options {
        open,
        compare: None,
        view: None,
        clock: now,
        immediate: false,
        layout: layout_file(),
        exports: PathBuf::from("exports"),
        campaigns: PathBuf::from(CAMPAIGNS),
    }
}

/// `$XDG_CONFIG_HOME/tribo/dashboard.json`, with the usual places where that is not set.
fn layout_file() -> Option<PathBuf> {
    let from = |variable: &str| std::env::var_os(variable).filter(|value| !value.is_empty()).map(PathBuf::from);
    let home = || from("HOME").map(|home| home.join(".config"));
    let directory = from("XDG_CONFIG_HOME").or_else(|| from("APPDATA")).or_else(home)?;
    Some(directory.join("tribo").join("dashboard.json"))
}
