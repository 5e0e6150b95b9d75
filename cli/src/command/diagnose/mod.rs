//! `tribo diagnose`.

mod files;
mod input;
mod show;

use std::path::Path;

use files::Outputs;
use serde_json::Value;
use tribo_diagnose::recognise::recognise;
use tribo_diagnose::report::{ClosedLoop, Extras, ReportContext, document, html};
use tribo_diagnose::{Diagnosable, DiagnoseSettings, Diagnosis, Verdict, diagnose_with_reference};
use tribo_logs::{ReadOptions, RobotLog};
use tribo_model::{AnyModel, Model, ModelFile, not_cancelled_of};
use tribo_regression::{CauseLabel, DiagnoseError, Nominal};
use tribo_robot::Arm;
use tribo_trial::{ClosedLoopGain, closed_loop_gain};

use super::believe::Refused;
use super::columns::joint_names;
use super::{check_joints, show_robot};
use crate::arguments::{Common, Diagnose};
use crate::failure::{BadInput, CheckFailed, Stopped};
use crate::output::print_json;
use crate::progress::{StageProgress, stop_on_signal};
use crate::threads;
pub(super) use files::write_text;
use input::Readings;

/// Rows of a log that a diagnosis takes whole: nearly seven minutes at 1 kHz. More rows add little, and an hour of them takes gigabytes of memory.
const MOST_ROWS: usize = 400_000;

/// Diagnoses and prints.
pub fn run(arguments: &Diagnose, common: &Common) -> anyhow::Result<()> {
    let Diagnosed { diagnosis, closed_loop, extras, written } = diagnosed(arguments, common)?;
    if common.json {
        print_json(&document(&diagnosis, &extras));
    } else if common.quiet {
        show::verdict(&diagnosis);
    } else {
        show::show(&diagnosis, closed_loop.as_ref(), &extras, common.verbose);
    }
    for remark in extras.remarks.iter().filter(|_| common.json && !common.quiet) {
        message!("tribo: {remark}");
    }
    written?;
    if arguments.check && diagnosis.verdict != Verdict::NothingMissing {
        let findings = diagnosis.findings.len();
        return Err(
            CheckFailed(format!("the verdict is {}, with {findings} findings", diagnosis.verdict.name())).into()
        );
    }
    Ok(())
}

/// A diagnosis and what became of its files.
pub(super) struct Diagnosed {
    /// The answer.
    pub diagnosis: Diagnosis,
    closed_loop: Option<ClosedLoopGain>,
    extras: Extras,
    /// Whether the files could be written.
    written: anyhow::Result<()>,
}

impl Diagnosed {
    /// The answer as `diagnose --json` prints it; an error where its files could not be written.
    pub(super) fn document(self) -> anyhow::Result<(Diagnosis, Value)> {
        self.written?;
        let document = document(&self.diagnosis, &self.extras);
        Ok((self.diagnosis, document))
    }
}

/// Reads everything, checks every name, diagnoses, writes; in that order, so that nothing is done by halves.
pub(super) fn diagnosed(arguments: &Diagnose, common: &Common) -> anyhow::Result<Diagnosed> {
    let choice = arguments.of.choice()?;
    let given = choice.given()?;
    let outputs = Outputs::checked(arguments)?;
    input::check_logs_differ(arguments)?;
    let refused = Refused::unless(arguments.anyway);
    let names = joint_names(&choice, given.as_ref().map(|(file, _)| file));
    let options = ReadOptions { most_rows: Some(MOST_ROWS), ..arguments.columns.options(names)? };
    let mut readings = Readings::default();
    let logs = input::logs(&arguments.logs, &options, refused, common, &mut readings)?;
    let validate = input::logs(&arguments.validate, &options, refused, common, &mut readings)?;
    let reference = input::logs(&arguments.reference, &options, refused, common, &mut readings)?;
    if let Some(band_hz) = arguments.band_hz.filter(|band_hz| !(*band_hz > 0.0 && band_hz.is_finite())) {
        return Err(BadInput(format!("--band-hz is {band_hz}; allowed: greater than 0")).into());
    }
    let (names, session): (Vec<String>, Vec<RobotLog>) = logs.into_iter().unzip();
    let first = session.first().map_or(0, |log| log.joints());
    let path = arguments.logs.first().map_or(Path::new(""), |path| path);
    let (model_file, model) = given.map_or_else(|| choice.bare(path, first, &session), Ok)?;
    show_robot(&model_file, common);
    let others = validate.iter().chain(&reference).map(|(name, log)| (name, log));
    for (name, log) in names.iter().zip(&session).chain(others) {
        check_joints(Path::new(name), log, &model)?;
    }
    for (name, log) in
        names.iter().zip(&session).chain(validate.iter().chain(&reference).map(|(name, log)| (name, log)))
    {
        let remarks = match &model {
            AnyModel::Six(model) => recognise(log, &model.to_nominal()),
            AnyModel::Seven(model) => recognise(log, &model.to_nominal()),
        };
        readings.believe(name, &remarks, refused, common.quiet)?;
    }
    let unloaded = reference.into_iter().map(|(_, log)| log).collect();
    let held =
        Held { names, session, validate, unloaded, model_name: choice.name(model.robot()), model_file, readings };
    match &model {
        AnyModel::Six(model) => run_with(arguments, common, &outputs, &held, model),
        AnyModel::Seven(model) => run_with(arguments, common, &outputs, &held, model),
    }
}

/// Logs, and what they are held against.
struct Held {
    names: Vec<String>,
    session: Vec<RobotLog>,
    validate: Vec<(String, RobotLog)>,
    /// Logs with nothing at the flange.
    unloaded: Vec<RobotLog>,
    model_name: String,
    model_file: ModelFile,
    readings: Readings,
}

fn run_with<const N: usize>(
    arguments: &Diagnose,
    common: &Common,
    outputs: &Outputs,
    held: &Held,
    model: &Model<N>,
) -> anyhow::Result<Diagnosed>
where
    Nominal<N>: Diagnosable,
{
    // The diagnosis, until it is done or somebody stops it.
    stop_on_signal();
    let progress = StageProgress::new(common.quiet);
    let pool = threads::pool(common)?;
    let settings = DiagnoseSettings { seed: arguments.seed, band_hz: arguments.band_hz };
    let result = pool.install(|| {
        let report = |stage: &str, part: f64| progress.stage(stage, part);
        let nominal = model.to_nominal();
        diagnose_with_reference(&held.session, &held.unloaded, &nominal, &held.validate, &settings, &report)
    });
    let diagnosis = match result {
        Ok(mut diagnosis) => {
            diagnosis.notes.splice(0..0, held.readings.warnings.iter().cloned());
            diagnosis
        }
        Err(DiagnoseError::Cancelled) => {
            progress.finish();
            return Err(Stopped::empty_handed().into());
        }
        Err(error) => {
            progress.finish();
            return Err(BadInput(format!("{}: {error}", held.names.join(", "))).into());
        }
    };

    // The extended model, what it is worth, and the files.
    let extended = held.model_file.diagnosed(&diagnosis);
    let valid = extended.validate::<N>();
    let mut extras = Extras { read_as: held.readings.read_as.clone(), ..Extras::default() };
    let mut gain = None;
    if let Some(asked) = arguments.band_hz.filter(|asked| (asked - diagnosis.band_hz).abs() > 1e-6 * asked) {
        let used = diagnosis.band_hz;
        extras.remarks.push(format!("--band-hz {asked} does not fit these logs; the band used is {used:.1} Hz"));
    }
    if let Ok(better) = &valid {
        extras.not_cancelled = not_cancelled_of(&diagnosis, model, better);
        if arguments.closed_loop {
            progress.stage("closed loop", 0.0);
            gain = pool.install(|| closed_loop(model, better, arguments.seed, &mut extras.remarks));
            extras.closed_loop = gain.as_ref().map(ClosedLoopGain::to_json);
        }
    }
    progress.finish();
    if progress.stopped() {
        return Err(Stopped::empty_handed().into());
    }
    let extended =
        valid.map(|_| extended).map_err(|error| anyhow::anyhow!("the findings make no valid model: {error}"));
    let written = write(held, outputs, &model.arm, (&diagnosis, gain.as_ref()), extended, &mut extras);
    Ok(Diagnosed { diagnosis, closed_loop: gain, extras, written })
}

/// Runs the closed loop where there is a difference to measure.
fn closed_loop<const N: usize>(
    old: &Model<N>,
    better: &Model<N>,
    seed: u64,
    remarks: &mut Vec<String>,
) -> Option<ClosedLoopGain> {
    if old == better {
        remarks.push("no closed loop: the findings do not change the model".to_owned());
        return None;
    }
    Some(closed_loop_gain(old, better, seed))
}

/// Writes the files that were asked for, each whole or not at all.
fn write<const N: usize>(
    held: &Held,
    outputs: &Outputs,
    arm: &Arm<N>,
    (diagnosis, gain): (&Diagnosis, Option<&ClosedLoopGain>),
    extended: anyhow::Result<ModelFile>,
    extras: &mut Extras,
) -> anyhow::Result<()> {
    if let Some(path) = &outputs.report {
        let context = ReportContext {
            logs: held.names.clone(),
            model: held.model_name.clone(),
            program: format!("tribo {}", env!("CARGO_PKG_VERSION")),
            closed_loop: gain.map(|gain| ClosedLoop {
                cost: [gain.cost_before, gain.cost_after],
                tracking_rms_mm: [gain.tracking_rms_mm_before, gain.tracking_rms_mm_after],
            }),
        };
        write_text(path, &html(diagnosis, &context))?;
        extras.written.push(("report", path.display().to_string()));
    }
    if let Some(path) = &outputs.trajectory {
        match &diagnosis.next_experiment {
            Some(next) if next.via_points.is_empty() => {
                extras
                    .remarks
                    .push(format!("{}: not written, the next experiment is no motion of its own", path.display()));
            }
            Some(next) => {
                files::write_trajectory(path, next, arm)?;
                extras.written.push(("trajectory", path.display().to_string()));
            }
            None => extras.remarks.push(format!("{}: not written, there is no next experiment", path.display())),
        }
    }
    if let Some(path) = &outputs.extend {
        files::write_model(path, &extended?)?;
        extras.written.push(("extend", path.display().to_string()));
        if diagnosis.effects().is_empty() {
            extras.remarks.push(format!("{}: the old model, nothing was found to add", path.display()));
        }
        if diagnosis.findings.iter().any(|finding| finding.label == CauseLabel::Unknown) {
            extras.remarks.push(format!("{}: without the torque that no named cause describes", path.display()));
        }
    }
    Ok(())
}
