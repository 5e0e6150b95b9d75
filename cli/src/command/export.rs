//! `tribo export`.

use std::path::{Path, PathBuf};

use anyhow::Context;
use serde_json::json;
use tribo_export::{Exported, export, export_robot};
use tribo_files::write_atomic;
use tribo_model::{AnyModel, FileError, ModelChoice, TunedFile};
use tribo_watch::{CampaignSnapshot, CampaignWatch};

use super::{named, show_robot};
use crate::arguments::{Common, Export};
use crate::output::{print, print_json};

/// The parameters, and where they come from: of a campaign, the best trial of its journal, so that what was told last counts even where
/// somebody was killed before `tuned.yaml` said so.
fn source(source: &Path, common: &Common) -> anyhow::Result<(PathBuf, TunedFile)> {
    if !source.is_dir() {
        return Ok((source.to_owned(), tuned(source)?));
    }
    let path = source.join("tuned.yaml");
    if !source.join("campaign.yaml").exists() {
        return Ok((path.clone(), tuned(&path)?));
    }
    let campaign = CampaignWatch::open(source)?.poll()?;
    let best = campaign.as_ref().and_then(CampaignSnapshot::tuned).ok_or_else(|| nothing_tuned(path.clone()))?;
    if !common.quiet {
        if let Some(campaign) = campaign.filter(|campaign| !campaign.is_complete()) {
            let (done, total) = (campaign.trials.len(), campaign.total());
            message!("tribo: trial {} is the best of {done}; the campaign is to have {total}", best.trial);
        }
        if path.exists() && TunedFile::read(&path).ok().as_ref() != Some(&best) {
            let path = path.display();
            message!("tribo: {path} is not what the journal says; exported is trial {} of the journal", best.trial);
        }
    }
    Ok((path, best))
}

fn tuned(path: &Path) -> Result<TunedFile, FileError> {
    TunedFile::read(path).map_err(|error| match error {
        FileError::Io { path, source } if source.kind() == std::io::ErrorKind::NotFound => nothing_tuned(path),
        other => other,
    })
}

fn nothing_tuned(path: PathBuf) -> FileError {
    FileError::Campaign { path, message: "no tuned parameters here; has the campaign finished?".to_owned() }
}

/// A robot without a campaign.
fn alone(robot: &str, arguments: &Export, common: &Common) -> anyhow::Result<(String, Exported)> {
    let choice = ModelChoice {
        robot: Some(robot.to_owned()),
        base_link: arguments.ends.base_link.clone(),
        tip_link: arguments.ends.tip_link.clone(),
        ..ModelChoice::default()
    };
    let (file, model): (_, AnyModel) = choice.bare(Path::new(""), 0, &[])?;
    show_robot(&file, common);
    let exported = export_robot(&file, named(&arguments.format)?, arguments.name.as_deref())
        .with_context(|| format!("{robot} as {}", arguments.format))?;
    Ok((model.robot().to_owned(), exported))
}

/// Writes tuned parameters or a robot in another format, and says what that format cannot.
pub fn run(arguments: &Export, common: &Common) -> anyhow::Result<()> {
    let (robot, exported) = match (&arguments.source, &arguments.robot) {
        (Some(from), _) => {
            let (path, tuned) = source(from, common)?;
            let exported = export(&tuned, named(&arguments.format)?, arguments.name.as_deref())
                .with_context(|| format!("{} as {}", path.display(), arguments.format))?;
            (tuned.robot, exported)
        }
        (None, robot) => alone(robot.as_deref().unwrap_or_default(), arguments, common)?,
    };
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
            "robot": robot,
            "out": arguments.out,
            "text": arguments.out.is_none().then_some(&exported.text),
            "losses": exported.losses,
        }));
    } else if arguments.out.is_none() {
        print(exported.text.trim_end());
    }
    Ok(())
}
