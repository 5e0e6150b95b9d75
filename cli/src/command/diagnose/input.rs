//! What `tribo diagnose` reads.

use std::path::{Path, PathBuf};

use tribo_experiments::files::{Model, ModelFile, YamlDocument};
use tribo_logs::{RobotLog, read_log};

use crate::arguments::{Common, Diagnose};
use crate::failure::BadInput;

/// The model file, raw and validated; `None` where none was given.
pub fn model(arguments: &Diagnose) -> anyhow::Result<Option<(ModelFile, Model<7>)>> {
    arguments.model.as_deref().map(|path| validated(&YamlDocument::read(path)?)).transpose()
}

/// What logs without a model are held against: the bare Panda without friction, or gears that weigh nothing where both of
/// their sides were measured, which is not a Panda.
pub fn bare_model(arguments: &Diagnose, logs: &[RobotLog]) -> anyhow::Result<(ModelFile, Model<7>)> {
    let mut text = format!("schema: tribo.model/1\nrobot: panda\ntorque_side: {}\n", arguments.torque_side);
    if logs.iter().all(|log| log.tau_link_nm.is_some()) {
        text.push_str("rotor_inertia_kg_m2: [0, 0, 0, 0, 0, 0, 0]\n");
    }
    validated(&YamlDocument::embedded("the bare Panda", &text))
}

fn validated(document: &YamlDocument) -> anyhow::Result<(ModelFile, Model<7>)> {
    let file: ModelFile = document.parse()?;
    let model = file.validate().map_err(|error| document.explain(error))?;
    Ok((file, model))
}

/// The logs with their names; suspicions about them go to standard error.
pub fn logs(paths: &[PathBuf], common: &Common) -> anyhow::Result<Vec<(String, RobotLog)>> {
    paths.iter().map(|path| log(path, common)).collect()
}

fn log(path: &Path, common: &Common) -> anyhow::Result<(String, RobotLog)> {
    let (log, summary) = read_log(path)?;
    if log.joints() != 7 {
        return Err(BadInput(format!("{}: {} joints; the model has 7", path.display(), log.joints())).into());
    }
    if !common.quiet {
        for warning in &summary.warnings {
            eprintln!("tribo: {}: {warning}", path.display());
        }
        if common.verbose {
            eprintln!("{}\n{summary}", path.display());
        }
    }
    Ok((path.display().to_string(), log))
}

/// Refuses a log that is given twice: counted twice it would be evidence for anything, and validated on itself too.
pub fn check_logs_differ(arguments: &Diagnose) -> anyhow::Result<()> {
    let all: Vec<(&PathBuf, bool)> = arguments
        .logs
        .iter()
        .map(|path| (path, false))
        .chain(arguments.validate.iter().map(|path| (path, true)))
        .collect();
    for (k, (path, validates)) in all.iter().enumerate() {
        if all[..k].iter().any(|(other, _)| same_file(other, path)) {
            let why = if *validates { "validates nothing, the log is given already" } else { "is given twice" };
            return Err(BadInput(format!("{}: {why}", path.display())).into());
        }
    }
    Ok(())
}

/// Whether two paths lead to one file that exists.
pub fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
