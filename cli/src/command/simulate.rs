//! `tribo simulate`.

use std::path::Path;

use serde_json::{Map, json};
use tribo_control::SinusoidReference;
use tribo_ekf::WrenchEkf;
use tribo_experiments::files::TunedFile;
use tribo_experiments::simulate_log;
use tribo_friction::FrictionModel;
use tribo_friction::law::CoulombViscous;
use tribo_sim::WrenchPulses;

use super::convert::{check_extension, write_log};
use super::{configured, named};
use crate::arguments::{Common, Simulate};
use crate::failure::BadInput;
use crate::output::{print, print_json, significant, table};

/// Runs one trial and writes its log.
pub fn run(arguments: &Simulate, common: &Common) -> anyhow::Result<()> {
    if let Some(log) = &arguments.log {
        check_extension(log)?;
    }
    let mut tune = configured(arguments.config.as_deref(), |config| arguments.scenario.apply(config))?;
    let config = &tune.config;
    let trial = &mut tune.trial;
    trial.sensors.torque_side = named(&arguments.torque_side)?;
    if arguments.fixed {
        trial.reference = SinusoidReference::fixed(trial.reference.centre);
    }
    for (name, value) in [("--pulse-force", arguments.pulse_force), ("--pulse-moment", arguments.pulse_moment)] {
        if !(0.0..=1000.0).contains(&value) {
            return Err(BadInput(format!("{name} is {value}; allowed: 0 to 1000")).into());
        }
    }
    if arguments.pulse_force > 0.0 || arguments.pulse_moment > 0.0 {
        // Six pulses of 3 s, 1.5 s apart, after the pre-roll: they fill the 30 s of the trajectory.
        trial.pulses = WrenchPulses::each_axis(arguments.pulse_force, arguments.pulse_moment, 4.0, 3.0, 1.5);
    }
    let friction: FrictionModel<7> = match arguments.compensation.as_str() {
        "none" => FrictionModel::uniform(CoulombViscous::default().into()),
        "oracle" => trial.truth.friction,
        file => {
            let tuned = TunedFile::read(Path::new(file))?;
            trial.velocity = if arguments.scenario.velocity.is_some() { trial.velocity } else { tuned.velocity };
            tuned.compensator().map_err(|error| BadInput(format!("{file}: {error}")))?.friction
        }
    };

    let (outcome, log) = simulate_log(trial, &friction, WrenchEkf::new(config.ekf), config.seed)?;
    if let Some(path) = &arguments.log {
        write_log(path, &log)?;
    }
    let parts = outcome.cost.parts();
    if common.json {
        print_json(&json!({
            "schema": "tribo.simulate/1",
            "seed": config.seed,
            "cost": outcome.cost.total(),
            "cost_parts": parts.iter().map(|(k, v)| ((*k).to_owned(), json!(v))).collect::<Map<_, _>>(),
            "penalty": outcome.cost.penalty,
            "reason": outcome.aborted,
            "aborted_at_s": outcome.aborted_at_s,
            "log": arguments.log,
        }));
    } else if !common.quiet {
        let mut rows = table(&["part", "cost [N + Nm]"]);
        for (name, value) in parts {
            rows.add_row([name.replace('_', " "), significant(value, 4)]);
        }
        rows.add_row(["J".to_owned(), significant(outcome.cost.total(), 4)]);
        print(rows);
        if let (Some(reason), Some(at)) = (outcome.aborted, outcome.aborted_at_s) {
            print(format_args!("aborted at {at:.3} s: {reason}"));
        }
        if let Some(path) = &arguments.log {
            print(format_args!("written {} ({} rows at 1 kHz)", path.display(), log.rows()));
        }
    }
    Ok(())
}
