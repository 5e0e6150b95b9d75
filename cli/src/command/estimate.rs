//! `tribo estimate`.

use std::path::Path;

use serde_json::{Map, Value, json};
use tribo_diagnose::{
    BlockSettings, FrictionReport, FrictionSettings, JointReport, ResidualError, ResidualSettings, TorqueResidual,
};
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_experiments::files::Model;
use tribo_experiments::{Believed, LogWrench, WrenchSummary, without_effects, wrench_on_log};
use tribo_friction::FrictionModel;
use tribo_friction::law::CoulombViscous;
use tribo_logs::{LogSummary, RobotLog, Table, read_log, write_table};
use tribo_sim::panda_gaz_joints;

use super::{named, warn_not_cancelled};
use crate::arguments::{Common, Estimate};
use crate::failure::BadInput;
use crate::output::{print, print_json, significant, table};

/// Names of the wrench components in file order.
const AXES: [&str; 6] = ["Fx [N]", "Fy [N]", "Fz [N]", "Mx [Nm]", "My [Nm]", "Mz [Nm]"];

/// Mean NIS above which the filter's stated deviations are refuted; 6 is the expectation, below it they are generous.
const OVERCONFIDENT_NIS: f64 = 8.0;

/// Runs the estimators over a log and prints what they say.
pub fn run(arguments: &Estimate, common: &Common) -> anyhow::Result<()> {
    let model = match &arguments.model {
        Some(path) => Model::read(path)?,
        None => Model::panda(named(&arguments.torque_side)?),
    };
    let believed = Believed::on_log(&model);
    warn_not_cancelled(&believed.not_cancelled, common);
    let (log, summary) = read_log(&arguments.log)?;
    if log.joints() != 7 {
        let message = format!("{}: {} joints; the model has 7", arguments.log.display(), log.joints());
        return Err(BadInput(message).into());
    }
    if !(arguments.block_s > 0.0 && arguments.block_s.is_finite()) {
        let message = format!("--block-s is {}; allowed: greater than 0", arguments.block_s);
        return Err(BadInput(message).into());
    }
    let wants = |name: &str| arguments.residual == "all" || arguments.residual == name;
    let torque = wants("torque").then(|| torque_residual(arguments, &log, &model, &believed)).transpose()?;
    let wrench = wants("ekf").then(|| {
        let mut ekf = WrenchEkf::new(WrenchEkfSettings::default());
        wrench_on_log(&log, &believed, model.smoothing_rad_s, &mut ekf)
    });
    if let (Some(out), Some(wrench)) = (&arguments.out, &wrench) {
        write_table(out, &wrench_table(wrench))?;
    }
    let wrench_summary = wrench.as_ref().map(LogWrench::summary);
    if common.json {
        print_json(&document(&summary, torque.as_ref(), wrench_summary.as_ref()));
    } else if !common.quiet {
        print(&summary);
        if let Some(report) = &torque {
            let rigid = if model.effects.is_empty() { "rigid model" } else { "rigid model and effects" };
            show_torque(report, rigid, model_label(arguments));
        }
        if let Some(wrench) = &wrench_summary {
            show_wrench(wrench, arguments.out.as_deref());
        }
    }
    Ok(())
}

/// Friction model that the residual is compared with: the given model's, or the published one of the Panda.
fn comparison(arguments: &Estimate, model: &Model<7>) -> FrictionModel<7> {
    match arguments.model {
        Some(_) => model.friction,
        None => FrictionModel { joints: panda_gaz_joints().map(Into::into) },
    }
}

fn model_label(arguments: &Estimate) -> &'static str {
    if arguments.model.is_some() { "model friction" } else { "Gaz 2019 friction" }
}

fn torque_residual(
    arguments: &Estimate,
    log: &RobotLog,
    model: &Model<7>,
    believed: &Believed,
) -> anyhow::Result<FrictionReport> {
    let settings = ResidualSettings { band_hz: arguments.band_hz, ..ResidualSettings::default() };
    let bad = |error: ResidualError| BadInput(format!("{}: {error}", arguments.log.display()));
    let log = without_effects(log, believed, model.smoothing_rad_s)?;
    let residual = TorqueResidual::of_log(&log, &believed.arm, &settings).map_err(bad)?;
    let settings = FrictionSettings {
        smoothing_rad_s: model.smoothing_rad_s,
        blocks: BlockSettings { length_s: arguments.block_s, ..BlockSettings::default() },
    };
    let friction = comparison(arguments, model);
    let none = FrictionModel::uniform(CoulombViscous::default().into());
    Ok(FrictionReport::of(&residual, (friction != none).then_some(&friction), &settings))
}

fn show_torque(report: &FrictionReport, rigid: &str, model_label: &str) {
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
        let held_out = |pick: fn(&tribo_diagnose::HeldOut) -> f64| {
            joint.held_out.as_ref().map_or("-".to_owned(), |held_out| significant(pick(held_out), 3))
        };
        let fit =
            |pick: fn(&tribo_friction::identify::JointTorqueFit) -> f64, sd: usize| match (&joint.fit, &joint.held_out)
            {
                (Ok(fit), Ok(held_out)) => format!("{:.3} ± {:.3}", pick(fit), held_out.sd[sd]),
                (Ok(fit), Err(_)) => format!("{:.3}", pick(fit)),
                _ => "-".to_owned(),
            };
        rows.add_row([
            joint.joint.to_string(),
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
            print(format_args!("joint {}: {error}", joint.joint));
        }
    }
}

fn show_wrench(summary: &WrenchSummary, out: Option<&Path>) {
    print(format_args!(
        "\nTool wrench by the robot on the environment (EKF, flange, base axes), {} samples, mean NIS {}",
        summary.samples,
        significant(summary.mean_nis, 3)
    ));
    let mut header = vec!["", "mean", "rms", "max", "stated sd"];
    if summary.against_reference.is_some() {
        header.extend(["bias", "coverage 95 %"]);
    }
    let mut rows = table(&header);
    for (i, axis) in AXES.iter().enumerate() {
        let mut row = vec![
            (*axis).to_owned(),
            significant(summary.mean[i], 3),
            significant(summary.rms[i], 3),
            significant(summary.max[i], 3),
            significant(summary.stated_sd[i], 3),
        ];
        if let Some(errors) = &summary.against_reference {
            row.push(significant(errors.bias[i], 3));
            row.push(format!("{:.1} %", 100.0 * errors.coverage95[i]));
        }
        rows.add_row(row);
    }
    print(rows);
    if summary.mean_nis > OVERCONFIDENT_NIS {
        print(format_args!(
            "mean NIS is {}, not 6: friction, the model or the noise settings do not fit this log; the stated sd is too small",
            significant(summary.mean_nis, 3)
        ));
    }
    if let Some(errors) = &summary.against_reference {
        let delay = errors.delay_s.map_or(String::new(), |delay| format!(", delay {:.0} ms", delay * 1e3));
        print(format_args!(
            "against O_F_ext: RMSE {} N, {} Nm{delay}",
            significant(errors.rmse_force_n, 3),
            significant(errors.rmse_moment_nm, 3)
        ));
    } else {
        print("the log has no O_F_ext: no error figures");
    }
    if let Some(out) = out {
        print(format_args!("written {}", out.display()));
    }
}

fn document(log: &LogSummary, torque: Option<&FrictionReport>, wrench: Option<&WrenchSummary>) -> Value {
    let mut estimators = Map::new();
    if let Some(wrench) = wrench {
        estimators.insert("ekf".to_owned(), wrench.to_json());
    }
    json!({
        "schema": "tribo.estimate/1",
        "log": {"rows": log.rows, "duration_s": log.duration_s, "rate_hz": log.rate_hz, "dropped_repeats": log.dropped_repeats},
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

/// The wrench along the log as a table; samples during which the estimator settles are left out.
fn wrench_table(wrench: &LogWrench) -> Table {
    let settled: Vec<usize> = (0..wrench.wrench.len()).filter(|&k| wrench.wrench[k][0].is_finite()).collect();
    let mut columns = vec![("time".to_owned(), settled.iter().map(|&k| wrench.time_s[k]).collect())];
    let names = ["fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm"];
    for (i, name) in names.iter().enumerate() {
        columns.push((format!("wrench_{name}"), settled.iter().map(|&k| wrench.wrench[k][i]).collect()));
        columns.push((format!("wrench_sd_{name}"), settled.iter().map(|&k| wrench.sd[k][i]).collect()));
        if let Some(reference) = &wrench.reference {
            columns.push((format!("reference_{name}"), settled.iter().map(|&k| reference[k][i]).collect()));
        }
    }
    Table { columns, ..Table::default() }
}
