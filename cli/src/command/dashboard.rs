//! `tribo dashboard`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use tribo_dashboard::{LogSource, Options, screenshot};

use super::dashboard_live::Watching;
use super::{CAMPAIGNS, named, now};
use crate::arguments::{Common, Dashboard};
use crate::failure::BadInput;

/// Longest that a picture waits for (s).
const LONGEST_WAIT_S: f64 = 600.0;

/// Opens the window, or draws it.
pub fn run(arguments: &Dashboard, common: &Common) -> anyhow::Result<()> {
    if !(arguments.seconds > 0.0 && arguments.seconds <= LONGEST_WAIT_S) {
        let message = format!("--seconds is {}; allowed: above 0, at most {LONGEST_WAIT_S}", arguments.seconds);
        return Err(BadInput(message).into());
    }
    let model = arguments.of.choice()?;
    let read = arguments.columns.options(Vec::new())?;
    let open = arguments.open.as_ref().map(|path| LogSource { path: path.clone(), read, model });
    if let Some(path) = arguments.open.as_ref().filter(|path| !path.exists()) {
        return Err(BadInput(format!("{}: there is no such file or directory", path.display())).into());
    }
    let view = arguments.view.as_deref().map(named).transpose()?;
    let watching = arguments.live.as_deref().map(|host| Watching::begin(host, arguments, common)).transpose()?;
    let live = watching.as_ref().map(|watching| watching.feed.clone());
    let options = Options { view, live, compare: arguments.compare.clone(), ..options(open) };
    let shown = match &arguments.screenshot {
        Some(out) => {
            if watching.is_some() {
                std::thread::sleep(Duration::from_secs_f64(arguments.seconds));
            }
            screenshot(options, arguments.size, arguments.dark, out).map_err(anyhow::Error::from)
        }
        None => tribo_dashboard::run(options).map_err(|error| BadInput(error.to_string()).into()),
    };
    if let Some(watching) = watching {
        watching.end();
    }
    shown
}

/// The window of a campaign that this process runs.
pub fn watch(directory: &Path) -> Result<(), tribo_dashboard::NoWindow> {
    tribo_dashboard::run(options(Some(LogSource { path: directory.to_owned(), ..LogSource::default() })))
}

fn options(open: Option<LogSource>) -> Options {
    Options {
        open,
        live: None,
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
