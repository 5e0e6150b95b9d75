//! `tribo estimate`.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};
use tribo_campaign::SETTLE_S;
use tribo_diagnose::Diagnosable;
use tribo_files::{Table, write_table};
use tribo_friction::{FrictionModel, JointFriction};
use tribo_logs::recognise::{self, Use};
use tribo_logs::{LogSummary, RobotLog};
use tribo_model::{AnyModel, ControllerModel, Model, SIGN_SMOOTHING_RAD_S};
use tribo_regression::{BlockSettings, FrictionReport, FrictionSettings, JointReport, Nominal};
use tribo_robot::JointNames;
use tribo_sim::{Effect, TorqueSide, panda_gaz_joints};
use tribo_trial::{
    Calibration, ContactPrior, EstimatorError, EstimatorName, LogEstimate, LogEstimator, TransmissionFriction,
};

use super::believe::{Refused, believe};
use super::columns::joint_names;
use super::convert::{target_of, write_log};
use super::live::watched;
use super::{check_joints, read_log, show_robot, transmission, warn_not_cancelled};
use crate::arguments::{Common, Estimate};
use crate::failure::BadInput;
use crate::output::{fixed, log_json, print, print_json, significant, table};

/// Names of the wrench components in file order.
const AXES: [&str; 6] = ["Fx [N]", "Fy [N]", "Fz [N]", "Mx [Nm]", "My [Nm]", "Mz [Nm]"];

/// Mean NIS above which the filter's stated deviations are refuted; 6 is the expectation, below it they are generous.
const OVERCONFIDENT_NIS: f64 = 8.0;

/// Runs the estimators over a log and prints what they say.
pub fn run(arguments: &Estimate, common: &Common) -> anyhow::Result<()> {
    let mut choice = arguments.of.choice()?;
    let given = choice.given()?;
    let options = arguments.columns.options(joint_names(&choice, given.as_ref().map(|(file, _)| file)))?;
    let path = match (&arguments.live, &arguments.record) {
        (Some(host), Some(record)) => {
            target_of(record)?;
            let (log, preset) = watched(host, arguments.seconds, common)?;
            write_log(record, &log)?;
            choice.torque_side = TorqueSide::Link;
            choice.robot.get_or_insert_with(|| preset.to_owned());
            record
        }
        _ => arguments.log.as_ref().ok_or_else(|| BadInput("no log is given".to_owned()))?,
    };
    let (log, summary) = read_log(path, &options, common)?;
    // Tables show the warnings of the log themselves.
    let (wanted, refused) = judgement(arguments);
    believe(path, &recognise::recognise(&log), wanted, refused, common.quiet || !common.json)?;
    // Neither the robot nor an estimator is named.
    let undecided = given.is_none() && choice.robot.is_none() && arguments.names_no_estimator();
    let smoothing_rad_s = given.as_ref().map_or(SIGN_SMOOTHING_RAD_S, |(_, model)| model.smoothing_rad_s());
    let gears = match TransmissionFriction::of_log(&log, smoothing_rad_s) {
        Ok(gears) => gears,
        Err(error) if undecided => {
            return Err(BadInput(format!("{}: {error}", path.display())).into());
        }
        Err(error) => {
            if !common.quiet {
                message!("tribo: {}: {error}", path.display());
            }
            None
        }
    };
    // Where nobody says what robot it is, torque on both sides says that it is no Panda.
    if let (Some(gears), true) = (&gears, undecided) {
        transmission::show_alone(gears, &summary, common);
        return Ok(());
    }
    let (model_file, model) = given.map_or_else(|| choice.bare(path, log.joints(), &[]), Ok)?;
    show_robot(&model_file, common);
    check_joints(path, &log, &model)?;
    let path = path.clone();
    let measured = Measured { path, log, summary, gears };
    match &model {
        AnyModel::Six(model) => estimate(arguments, common, &measured, model),
        AnyModel::Seven(model) => estimate(arguments, common, &measured, model),
    }
}

/// What the log is wanted for, and what is done with one that cannot be right. The torque residual alone does without dq.
fn judgement(arguments: &Estimate) -> (Use, Refused) {
    let wanted = if arguments.asked().iter().all(|name| *name == "torque") { Use::Diagnosis } else { Use::Wrench };
    (wanted, Refused::unless(arguments.anyway))
}

/// A log, and what it says of its gears without a model.
struct Measured {
    path: PathBuf,
    log: RobotLog,
    summary: LogSummary,
    gears: Option<TransmissionFriction>,
}

fn estimate<const N: usize>(
    arguments: &Estimate,
    common: &Common,
    Measured { path, log, summary, gears }: &Measured,
    model: &Model<N>,
) -> anyhow::Result<()>
where
    Nominal<N>: Diagnosable,
{
    let (wanted, refused) = judgement(arguments);
    believe(path, &tribo_diagnose::recognise::recognise(log, &model.to_nominal()), wanted, refused, common.quiet)?;
    warn_not_cancelled(&ControllerModel::on_log(model).not_cancelled, &model.robot.arm.joint_names, common);
    if !(arguments.block_s > 0.0 && arguments.block_s.is_finite()) {
        let message = format!("--block-s is {}; allowed: greater than 0", arguments.block_s);
        return Err(BadInput(message).into());
    }
    // Two encoders see the gears, behind the friction of the motors.
    let asked = arguments.asked();
    let feels_friction = asked.iter().any(|name| !matches!(*name, "torque" | "double_encoder"));
    let has_friction = model
        .effects
        .iter()
        .any(|effect| matches!(effect, Effect::Coulomb { .. } | Effect::Viscous { .. } | Effect::FrictionCurve { .. }));
    if model.friction == FrictionModel::none() && !has_friction && feels_friction && !common.quiet {
        message!(
            "tribo: the model has no friction, so that of the arm counts as wrench, outside of the intervals too; --model says what it has"
        );
    }
    let everything = asked.contains(&"all");
    let wants = |name: &str| everything || asked.contains(&name);
    let torque = wants("torque").then(|| torque_residual(arguments, path, log, model)).transpose()?;
    let free = free_log(arguments, model, common)?;
    let one_encoder = wants(EstimatorName::DoubleEncoder.as_str())
        .then(|| [Some((path, log)), free.as_ref().map(|(path, log)| (path, log))])
        .and_then(|logs| logs.into_iter().flatten().find(|(_, log)| log.theta_rad.is_none()))
        .map(|(path, _)| {
            format!("{}: missing columns theta_0 to theta_{}, which double_encoder needs", path.display(), N - 1)
        });
    match &one_encoder {
        Some(message) if !everything => return Err(BadInput(message.clone()).into()),
        Some(message) if !common.quiet => message!("tribo: {message}; it is left out"),
        _ => {}
    }
    let mut estimator = LogEstimator::new(model);
    if let Some((path, log)) = &free {
        estimator =
            estimator.calibrated_on(log.clone()).map_err(|error| BadInput(format!("{}: {error}", path.display())))?;
    }
    if let Some(share) = arguments.touched {
        let prior = ContactPrior::rarely(share).map_err(|error| BadInput(error.to_string()))?;
        estimator = estimator.with_contact_prior(prior);
    }
    let wrenches = EstimatorName::ALL
        .into_iter()
        .filter(|name| wants(name.as_str()))
        .filter(|name| *name != EstimatorName::DoubleEncoder || one_encoder.is_none())
        .map(|name| estimator.estimate(name, log))
        .collect::<Result<Vec<LogEstimate>, EstimatorError>>()?;
    if let (Some(out), false) = (&arguments.out, wrenches.is_empty()) {
        write_table(out, &wrench_table(&wrenches))?;
    }
    if common.json {
        let mut document = document(summary, torque.as_ref(), &wrenches);
        if let Some(gears) = gears {
            document["transmission"] = transmission::json(gears);
        }
        print_json(&document);
    } else if !common.quiet {
        print(summary);
        if let Some(gears) = gears {
            transmission::show(gears, &model.robot.arm.joint_names);
        }
        if let Some(report) = &torque {
            let rigid = if model.effects.is_empty() { "rigid model" } else { "rigid model and effects" };
            let friction = if arguments.of.model.is_some() { "model friction" } else { "Gaz 2019 friction" };
            show_torque(report, &model.robot.arm.joint_names, rigid, friction);
        }
        if !wrenches.is_empty() {
            show_wrenches(&wrenches, arguments.out.as_deref());
        }
    }
    Ok(())
}

/// The log of strokes that nobody touches, where there is one.
fn free_log<const N: usize>(
    arguments: &Estimate,
    model: &Model<N>,
    common: &Common,
) -> anyhow::Result<Option<(PathBuf, RobotLog)>>
where
    Nominal<N>: Diagnosable,
{
    let Some(path) = &arguments.free else { return Ok(None) };
    let (log, _) = read_log(path, &arguments.columns.options(Vec::new())?, common)?;
    believe(path, &recognise::recognise(&log), Use::Wrench, Refused::IsAnError, common.quiet)?;
    let remarks = tribo_diagnose::recognise::recognise(&log, &model.to_nominal());
    believe(path, &remarks, Use::Wrench, Refused::IsAnError, common.quiet)?;
    Ok(Some((path.clone(), log)))
}

/// Friction model that the residual is compared with: the given model's, or the published one of the Panda; none of other
/// arms.
fn comparison<const N: usize>(arguments: &Estimate, model: &Model<N>) -> FrictionModel<N> {
    let published: [JointFriction; 7] = panda_gaz_joints().map(Into::into);
    let joints = published.as_slice().try_into().ok();
    let published = joints.filter(|_| arguments.of.model.is_none() && model.robot.arm.name == "panda");
    published.map_or(model.friction, |joints| FrictionModel { joints })
}

/// What the model leaves of the torque, by the path of a diagnosis.
fn torque_residual<const N: usize>(
    arguments: &Estimate,
    path: &Path,
    log: &RobotLog,
    model: &Model<N>,
) -> anyhow::Result<FrictionReport> {
    let settings = FrictionSettings {
        smoothing_rad_s: model.smoothing_rad_s,
        blocks: BlockSettings { length_s: arguments.block_s, ..BlockSettings::default() },
    };
    let friction = comparison(arguments, model);
    let judged = (arguments.of.model.is_some() || friction != FrictionModel::none()).then_some(&friction);
    FrictionReport::of_model(log, &model.to_nominal(), judged, arguments.band_hz, &settings)
        .map_err(|error| BadInput(format!("{}: {error}", path.display())).into())
}

fn show_torque(report: &FrictionReport, names: &JointNames, rigid: &str, model_label: &str) {
    print(format_args!("\nTorque residual: measured less {rigid} [Nm], {}", report.chain));
    match &report.blocks {
        Ok(blocks) => print(format_args!("friction fitted to {blocks}")),
        Err(error) => print(format_args!("no held-out figures: {error}")),
    }
    let mut rows = table(&[
        "joint",
        "rms",
        "sd",
        model_label,
        "sd",
        "fit, train",
        "fit, test",
        "Fc [Nm]",
        "Fv [Nm s/rad]",
        "offset [Nm]",
    ]);
    for joint in &report.joints {
        let held_out = |pick: fn(&tribo_regression::HeldOut) -> f64| {
            joint.held_out.as_ref().map_or("-".to_owned(), |held_out| significant(pick(held_out), 3))
        };
        let fit =
            |pick: fn(&tribo_friction::identify::JointTorqueFit) -> f64, sd: usize| match (&joint.fit, &joint.held_out)
            {
                (Ok(fit), Ok(held_out)) => format!("{} ± {}", fixed(pick(fit), 3), fixed(held_out.sd[sd], 3)),
                (Ok(fit), Err(_)) => fixed(pick(fit), 3),
                _ => "-".to_owned(),
            };
        rows.add_row([
            names.of(joint.joint).to_string(),
            significant(joint.rms_rigid_nm, 3),
            significant(joint.sd_rigid_nm, 3),
            joint.rms_with_model_nm.map_or("-".to_owned(), |rms| significant(rms, 3)),
            joint.sd_with_model_nm.map_or("-".to_owned(), |sd| significant(sd, 3)),
            held_out(|h| h.rms_fit_train_nm),
            held_out(|h| h.rms_fit_test_nm),
            fit(|fit| fit.coulomb_nm, 0),
            fit(|fit| fit.viscous_nm_s_per_rad, 1),
            fit(|fit| fit.offset_nm, 2),
        ]);
    }
    print(rows);
    for joint in &report.joints {
        if let Err(error) = &joint.fit {
            print(format_args!("{}: {error}", names.of(joint.joint)));
        }
    }
}

fn show_wrenches(wrenches: &[LogEstimate], out: Option<&Path>) {
    let samples = wrenches.first().map_or(0, |estimated| estimated.summary.samples);
    print(format_args!("\nTool wrench by the robot on the environment (flange, base axes), {samples} samples"));
    let compared = wrenches.iter().any(|estimated| estimated.summary.against_reference.is_some());
    let mut header = vec!["estimator", "", "mean", "rms", "max", "stated sd", "±95 %"];
    if compared {
        header.extend(["bias", "coverage 95 %"]);
    }
    let mut rows = table(&header);
    for LogEstimate { name, summary, .. } in wrenches {
        // What nothing was estimated from has no figures.
        let told = summary.samples > summary.faults;
        let figure = |value: f64| significant(if told { value } else { f64::NAN }, 3);
        for (i, axis) in AXES.iter().enumerate() {
            let mut row = vec![
                if i == 0 { name.as_str().to_owned() } else { String::new() },
                (*axis).to_owned(),
                figure(summary.mean[i]),
                figure(summary.rms[i]),
                figure(summary.max[i]),
                figure(summary.stated_sd[i]),
                figure(summary.half_width95[i]),
            ];
            if let Some(errors) = &summary.against_reference {
                row.push(figure(errors.bias[i]));
                let covered = if told { errors.coverage95[i] } else { f64::NAN };
                row.push(if covered.is_finite() { format!("{:.1} %", 100.0 * covered) } else { "-".to_owned() });
            }
            rows.add_row(row);
        }
    }
    print(rows);
    if samples == 0 {
        print(format_args!("no figures: estimators settle for {SETTLE_S} s, and no burst of the log lasts longer"));
    }
    for LogEstimate { name, calibration, summary, .. } in wrenches {
        let name = name.as_str();
        if let Some(Calibration { tare: [fx, fy, fz, mx, my, mz], noise_factor, .. }) = calibration {
            print(format_args!(
                "{name}: noise × {}, tare ({}, {}, {}) N, ({}, {}, {}) Nm from the contact-free log",
                fixed(*noise_factor, 2),
                fixed(*fx, 2),
                fixed(*fy, 2),
                fixed(*fz, 2),
                fixed(*mx, 3),
                fixed(*my, 3),
                fixed(*mz, 3)
            ));
        }
        if let Some(nis) = summary.mean_nis.filter(|nis| *nis > OVERCONFIDENT_NIS) {
            print(format_args!(
                "{name}: mean NIS is {}, not 6: friction, the model or the noise settings do not fit this log; the stated sd is too small",
                significant(nis, 3)
            ));
        }
        if summary.faults > 0 {
            print(format_args!(
                "{name}: {} samples could not be used; the estimate before each stands",
                summary.faults
            ));
        }
        if let Some(errors) = &summary.against_reference {
            let delay = errors.delay_s.map_or(String::new(), |delay| format!(", delay {:.0} ms", delay * 1e3));
            print(format_args!(
                "{name} against O_F_ext: RMSE {} N, {} Nm{delay}",
                significant(errors.rmse_force_n, 3),
                significant(errors.rmse_moment_nm, 3)
            ));
        }
    }
    if !compared {
        print("the log has no O_F_ext: no error figures");
    }
    if let Some(out) = out {
        print(format_args!("written {}", out.display()));
    }
}

fn document(log: &LogSummary, torque: Option<&FrictionReport>, wrenches: &[LogEstimate]) -> Value {
    let entries = wrenches.iter().map(|estimated| {
        let mut entry = estimated.summary.to_json();
        entry["calibration"] = estimated.calibration.map_or(
            Value::Null,
            |found| json!({"noise_factor": found.noise_factor, "axis_factor": found.axis_factor, "tare": found.tare}),
        );
        (estimated.name.as_str().to_owned(), entry)
    });
    let estimators: Map<String, Value> = entries.collect();
    json!({
        "schema": "tribo.estimate/1",
        "log": log_json(log),
        "estimators": estimators,
        "torque_residual": torque.map(torque_json),
    })
}

fn torque_json(report: &FrictionReport) -> Value {
    let blocks = report.blocks.as_ref().ok();
    json!({
        "band_hz": report.chain.band_hz,
        "rate_hz": report.chain.output_rate_hz(),
        "samples": report.samples,
        "smoothing_rad_s": report.smoothing_rad_s,
        "block_s": blocks.map(|blocks| blocks.length_s),
        "folds": blocks.map(|blocks| blocks.folds),
        "joints": report.joints.iter().map(joint_json).collect::<Vec<_>>(),
    })
}

fn joint_json(joint: &JointReport) -> Value {
    let held_out = joint.held_out.as_ref().ok();
    json!({
        "joint": joint.joint,
        "rms_rigid_nm": joint.rms_rigid_nm,
        "sd_rigid_nm": joint.sd_rigid_nm,
        "rms_with_model_nm": joint.rms_with_model_nm,
        "sd_with_model_nm": joint.sd_with_model_nm,
        "rms_fit_train_nm": held_out.map(|held_out| held_out.rms_fit_train_nm),
        "rms_fit_test_nm": held_out.map(|held_out| held_out.rms_fit_test_nm),
        "fit": joint.fit.as_ref().ok().map(|fit| json!({
            "coulomb_nm": fit.coulomb_nm,
            "viscous_nm_s_per_rad": fit.viscous_nm_s_per_rad,
            "offset_nm": fit.offset_nm,
        })),
        "reason": joint.fit.as_ref().err().map(ToString::to_string),
    })
}

/// The wrenches along the log as a table, each column named after its estimator where there are several; samples during which
/// the estimators settle are left out.
fn wrench_table(wrenches: &[LogEstimate]) -> Table {
    let Some(LogEstimate { wrench: first, .. }) = wrenches.first() else { return Table::default() };
    let settled: Vec<usize> = (0..first.wrench.len()).filter(|&k| first.wrench[k][0].is_finite()).collect();
    let column = |value: &dyn Fn(usize) -> f64| settled.iter().map(|&k| value(k)).collect::<Vec<f64>>();
    let mut columns = vec![("time".to_owned(), column(&|k| first.time_s[k]))];
    let names = ["fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm"];
    for LogEstimate { name, wrench, .. } in wrenches {
        let prefix = if wrenches.len() == 1 { String::new() } else { format!("{}_", name.as_str()) };
        for (i, name) in names.iter().enumerate() {
            columns.push((format!("{prefix}wrench_{name}"), column(&|k| wrench.wrench[k][i])));
            columns.push((format!("{prefix}wrench_sd_{name}"), column(&|k| wrench.sd[k][i])));
            columns.push((format!("{prefix}wrench_low_{name}"), column(&|k| wrench.limits95[k][0][i])));
            columns.push((format!("{prefix}wrench_high_{name}"), column(&|k| wrench.limits95[k][1][i])));
        }
    }
    if let Some(reference) = &first.reference {
        for (i, name) in names.iter().enumerate() {
            columns.push((format!("reference_{name}"), column(&|k| reference[k][i])));
        }
    }
    Table { columns, ..Table::default() }
}
