//! `tribo simulate`.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};
use tribo_campaign::{AnyTune, ValidTune};
use tribo_friction::{FrictionModel, JointEffects};
use tribo_logs::RobotLog;
use tribo_model::{ControllerModel, ModelFile, NotCancelled, TrajectoryFile, TunedFile, YamlDocument};
use tribo_sim::{WrenchPulses, not_simulated};
use tribo_trial::{AnyEstimator, follow, simulate_log};

use super::convert::{target_of, write_log};
use super::live::{Link, confirm, of_seven_joints, preset_of, seen_from};
use super::{configured, named, warn_not_cancelled};
use crate::arguments::{Common, Simulate};
use crate::failure::BadInput;
use crate::output::{print, print_json, significant, table};
use crate::progress::stop_on_signal;

/// Runs one trial, or one joint-space motion, and writes its log.
pub fn run(arguments: &Simulate, common: &Common) -> anyhow::Result<()> {
    if let Some(log) = &arguments.log {
        target_of(log)?;
    }
    if let Some(host) = &arguments.live {
        return play(arguments, host, common);
    }
    match configured(arguments.config.as_deref(), common, |config| arguments.scenario.apply(config))? {
        AnyTune::Six(tune) => simulate(arguments, common, tune),
        AnyTune::Seven(tune) => simulate(arguments, common, tune),
    }
}

fn simulate<const N: usize>(arguments: &Simulate, common: &Common, mut tune: ValidTune<N>) -> anyhow::Result<()> {
    let trial = &mut tune.trial;
    trial.sensors.torque_side = named(&arguments.torque_side)?;
    if arguments.fixed {
        *trial = trial.clone().holding();
    }
    for (name, value) in [("--pulse-force", arguments.pulse_force), ("--pulse-moment", arguments.pulse_moment)] {
        if !(0.0..=1000.0).contains(&value) {
            return Err(BadInput(format!("{name} is {value}; allowed: 0 to 1000")).into());
        }
    }
    if arguments.pulse_force > 0.0 || arguments.pulse_moment > 0.0 {
        // Whoever pushes puts energy into the arm, as a compensator does that is too strong.
        trial.guard = None;
        // Six pulses of 3 s, 1.5 s apart, after the pre-roll: they fill the 30 s of the trajectory.
        trial.pulses = WrenchPulses::each_axis(arguments.pulse_force, arguments.pulse_moment, 4.0, 3.0, 1.5);
    }
    if let Some(number) = arguments.trial {
        (tune.trial, _) = tune.numbered(number);
    }
    if !(0.0..=10.0).contains(&arguments.scale) {
        return Err(BadInput(format!("--scale is {}; allowed: 0 to 10", arguments.scale)).into());
    }
    let (friction, left) = compensation_of(arguments, &mut tune)?;
    let friction = friction.scaled(arguments.scale);
    warn_not_cancelled(&left, &tune.trial.model.joint_names, common);
    let limits = not_simulated(&tune.trial.truth.effects, &tune.trial.model.joint_names);
    if !common.quiet {
        for limit in &limits {
            message!("tribo: {limit}");
        }
    }
    let not_cancelled = left.iter().map(|effect| effect.sentence(&tune.trial.model.joint_names)).collect();
    let left = Left { not_cancelled, not_simulated: limits };
    match &arguments.trajectory {
        Some(path) => run_trajectory(path, arguments, common, &tune, &friction, &left),
        None => run_trial(arguments, common, &tune, &friction, &left),
    }
}

/// The friction that the compensator believes and what it believes in vain; arm and effects go into the trial.
fn compensation_of<const N: usize>(
    arguments: &Simulate,
    tune: &mut ValidTune<N>,
) -> anyhow::Result<(FrictionModel<N>, Vec<NotCancelled>)> {
    let name = arguments.compensation.as_str();
    let given = tune.controller_model.take();
    let whole = match name {
        "none" => {
            // The arm may still be that of --model.
            tune.trial.effects = [JointEffects::default(); N];
            return Ok((FrictionModel::none(), Vec::new()));
        }
        "oracle" => Some(tune.oracle.clone()),
        file if is_model(Path::new(file))? => Some(model_of_controller(Path::new(file))?),
        _ => None,
    };
    if let Some(whole) = whole {
        if given.is_some() {
            let message = format!("--model and --compensation {name} both say what the controller believes; give one");
            return Err(BadInput(message).into());
        }
        tune.trial = tune.trial.clone().with_controller_model(&whole);
        return Ok((whole.friction, whole.not_cancelled));
    }

    let bad = |error| BadInput(format!("{name}: {error}"));
    let tuned = TunedFile::read(Path::new(name))?;
    if arguments.scenario.velocity.is_none() {
        tune.trial.velocity = tuned.velocity;
    }
    let believed = match given {
        Some(believed) => Some(believed),
        None => tuned.controller_model().map_err(bad)?.map(|model| ControllerModel::by_controller(&model)),
    };
    if let Some(believed) = &believed {
        tune.trial = tune.trial.clone().with_controller_model(believed);
    }
    let friction = tuned.compensator().map_err(bad)?.friction;
    Ok((friction, believed.map_or_else(Vec::new, |believed| believed.not_cancelled)))
}

/// What a controller makes of a model file about a robot with N joints.
fn model_of_controller<const N: usize>(path: &Path) -> anyhow::Result<ControllerModel<N>> {
    let (file, document) = ModelFile::read(path)?;
    Ok(ControllerModel::by_controller(&file.validate().map_err(|error| document.explain(error))?))
}

/// Whether a YAML file calls itself a model; what it is otherwise, its own reader says.
fn is_model(path: &Path) -> anyhow::Result<bool> {
    let document = YamlDocument::read(path)?;
    let schema = document.parse::<Value>().ok().and_then(|value| Some(value.get("schema")?.as_str()?.to_owned()));
    Ok(schema.is_some_and(|schema| schema.starts_with("tribo.model/")))
}

/// What the controller does not cancel, and what the plant does not have.
struct Left {
    not_cancelled: Vec<String>,
    not_simulated: Vec<String>,
}

/// `log`, `not_cancelled` and `not_simulated` of every document; the latter two only where there is something to tell.
fn finish_document(mut document: Value, log: Option<&PathBuf>, left: &Left) -> Value {
    document["log"] = json!(log);
    if !left.not_cancelled.is_empty() {
        document["not_cancelled"] = json!(left.not_cancelled);
    }
    if !left.not_simulated.is_empty() {
        document["not_simulated"] = json!(left.not_simulated);
    }
    document
}

fn written(path: Option<&PathBuf>, log: &RobotLog) {
    if let Some(path) = path {
        print(format_args!("written {} ({} rows at 1 kHz)", path.display(), log.rows()));
    }
}

fn run_trial<const N: usize>(
    arguments: &Simulate,
    common: &Common,
    tune: &ValidTune<N>,
    friction: &FrictionModel<N>,
    left: &Left,
) -> anyhow::Result<()> {
    let config = &tune.config;
    let estimator = AnyEstimator::for_tuning(config.residual, config.ekf, &tune.trial, friction)?;
    let seed = arguments.trial.map_or(config.seed, |number| tune.numbered(number).1);
    let (outcome, log) = simulate_log(&tune.trial, friction, estimator, seed)?;
    if let Some(path) = &arguments.log {
        write_log(path, &log)?;
    }
    let parts = outcome.cost.parts();
    if common.json {
        let document = json!({
            "schema": "tribo.simulate/1",
            "seed": config.seed,
            "cost": outcome.cost.total(),
            "cost_parts": parts.iter().map(|(k, v)| ((*k).to_owned(), json!(v))).collect::<Map<_, _>>(),
            "penalty": outcome.cost.penalty,
            "reason": outcome.aborted,
            "aborted_at_s": outcome.aborted_at_s,
        });
        print_json(&finish_document(document, arguments.log.as_ref(), left));
    } else if !common.quiet {
        let mut rows = table(&["part", &format!("cost [{}]", config.cost.unit())]);
        for (name, value) in parts {
            rows.add_row([name.replace('_', " "), significant(value, 4)]);
        }
        rows.add_row(["J".to_owned(), significant(outcome.cost.total(), 4)]);
        print(rows);
        if let (Some(reason), Some(at)) = (outcome.aborted, outcome.aborted_at_s) {
            print(format_args!("aborted at {at:.3} s: {reason}"));
        }
        written(arguments.log.as_ref(), &log);
    }
    Ok(())
}

/// Plays a motion on a live robot.
fn play(arguments: &Simulate, host: &str, common: &Common) -> anyhow::Result<()> {
    let (Some(path), Some(target)) = (&arguments.trajectory, &arguments.log) else {
        return Err(BadInput("--live wants --trajectory and --log".to_owned()).into());
    };
    confirm(host, arguments.drive, &format!("as {} says, after a slow approach to its start", path.display()))?;
    let link = Link::to(host, arguments.drive);
    let robot = preset_of(link.connect()?.version());
    let tune = configured(arguments.config.as_deref(), common, |config| {
        config.robot.get_or_insert_with(|| robot.to_owned());
        arguments.scenario.apply(config)
    })?;
    let mut tune = of_seven_joints(tune)?;
    let (friction, left) = compensation_of(arguments, &mut tune)?;
    warn_not_cancelled(&left, &tune.trial.model.joint_names, common);
    let motion = TrajectoryFile::read(path, &tune.trial.model)?.path();
    stop_on_signal();
    let (friction, side) = (friction.scaled(arguments.scale), named(&arguments.torque_side)?);
    let log = seen_from(side, link.play(&tune.trial, &friction, &motion, "nothing is written")?)?;
    write_log(target, &log)?;
    if common.json {
        print_json(
            &json!({"schema": "tribo.simulate/1", "host": host, "robot": robot, "log": target, "rows": log.rows()}),
        );
    } else if !common.quiet {
        written(Some(target), &log);
    }
    Ok(())
}

fn run_trajectory<const N: usize>(
    path: &Path,
    arguments: &Simulate,
    common: &Common,
    tune: &ValidTune<N>,
    friction: &FrictionModel<N>,
    left: &Left,
) -> anyhow::Result<()> {
    let motion = TrajectoryFile::read(path, &tune.trial.model)?.path();
    let (followed, log) = follow(&tune.trial, friction, &motion, tune.config.seed)?;
    if let Some(path) = &arguments.log {
        write_log(path, &log)?;
    }
    if common.json {
        let document = json!({
            "schema": "tribo.simulate/1",
            "seed": tune.config.seed,
            "trajectory": path,
            "duration_s": followed.duration_s,
            "tracking_rms_rad": followed.rms_error_rad.as_slice(),
            "tracking_max_rad": followed.max_error_rad.as_slice(),
            "saturated_ticks": followed.saturated_ticks,
            "reason": followed.aborted.map(|(reason, _)| reason),
            "aborted_at_s": followed.aborted.map(|(_, at_s)| at_s),
        });
        print_json(&finish_document(document, arguments.log.as_ref(), left));
    } else if !common.quiet {
        let mut rows = table(&["joint", "rms error [mrad]", "largest [mrad]"]);
        for j in 0..N {
            let mrad = |value: f64| significant(1e3 * value, 3);
            rows.add_row([
                tune.trial.model.joint_names.of(j).to_string(),
                mrad(followed.rms_error_rad[j]),
                mrad(followed.max_error_rad[j]),
            ]);
        }
        print(rows);
        if followed.saturated_ticks > 0 {
            print(format_args!("a torque limit was hit in {} of {} periods", followed.saturated_ticks, log.rows()));
        }
        if let Some((reason, at_s)) = followed.aborted {
            print(format_args!("aborted at {at_s:.3} s: {reason}"));
        }
        written(arguments.log.as_ref(), &log);
    }
    Ok(())
}
