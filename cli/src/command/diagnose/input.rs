//! What `tribo diagnose` reads.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tribo_logs::recognise::{Remark, Use, recognise, said};
use tribo_logs::{LogSummary, Mapping, Quantity, ReadOptions, RobotLog};

use super::super::believe::{Refused, believe};
use super::super::read_log;
use crate::arguments::{Common, Diagnose};
use crate::failure::BadInput;

/// What an answer says of the logs that it rests on.
#[derive(Clone, Debug, Default)]
pub struct Readings {
    /// Which columns were read as which, log by log.
    pub read_as: Vec<Value>,
    /// What their readers noticed, such as rows that were left out, and what is doubtful about them.
    pub warnings: Vec<String>,
}

impl Readings {
    fn add(&mut self, name: &str, summary: &LogSummary) {
        let mapping = summary.mapping.as_ref().map_or(Value::Null, Mapping::to_json);
        self.read_as.push(json!({"log": name, "read_as": mapping}));
        self.warnings.extend(summary.warnings.iter().map(|warning| format!("{name}: {warning}")));
    }

    /// Refuses a log that cannot be right; what only may be wrong goes to standard error at once and stands in the answer.
    ///
    /// # Errors
    /// Every reason.
    pub fn believe(&mut self, name: &str, remarks: &[Remark], refused: Refused, quiet: bool) -> anyhow::Result<()> {
        believe(Path::new(name), remarks, Use::Diagnosis, refused, quiet)?;
        self.warnings.extend(said(name, remarks));
        Ok(())
    }
}

/// What no diagnosis asks for: a third of the memory of a log that has it.
const UNASKED: [Quantity; 5] = [
    Quantity::FrictionCompensation,
    Quantity::MotorVelocity,
    Quantity::Temperature,
    Quantity::TemperatureAmbient,
    Quantity::ExternalWrench,
];

/// The logs with their names; suspicions about them go to standard error at once, and into `readings`.
pub fn logs(
    paths: &[PathBuf],
    options: &ReadOptions,
    refused: Refused,
    common: &Common,
    readings: &mut Readings,
) -> anyhow::Result<Vec<(String, RobotLog)>> {
    let mut one = |path: &PathBuf| {
        let name = path.display().to_string();
        let (log, summary) = log(path, options, common)?;
        readings.add(&name, &summary);
        readings.believe(&name, &recognise(&log), refused, common.quiet)?;
        Ok((name, log.without(&UNASKED)))
    };
    paths.iter().map(&mut one).collect()
}

fn log(path: &Path, options: &ReadOptions, common: &Common) -> anyhow::Result<(RobotLog, LogSummary)> {
    let (log, summary) = read_log(path, options, common)?;
    if !common.quiet {
        for warning in &summary.warnings {
            message!("tribo: {}: {warning}", path.display());
        }
        if common.verbose {
            message!("{}\n{summary}", path.display());
        }
    }
    Ok((log, summary))
}

/// Refuses a log that is given twice: counted twice it would be evidence for anything, and validated on itself too.
pub fn check_logs_differ(arguments: &Diagnose) -> anyhow::Result<()> {
    let all: Vec<(&PathBuf, bool)> = arguments
        .logs
        .iter()
        .map(|path| (path, false))
        .chain(arguments.reference.iter().map(|path| (path, false)))
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
