//! `tribo serve`.

use std::net::SocketAddr;

use serde_json::json;
use tribo_campaign::TuneConfig;
use tribo_fci::{
    ControlUnit, FciVersion, GripperServer, MoveEnd, Pace, ServeError, Server, ServerEvent, ServerSettings, model,
};
use tribo_model::PushesFile;
use tribo_sim::{BoxFrictionPlant, Sensors, TorqueSide, WrenchPulses, not_simulated};
use tribo_trial::Trial;

use super::live::of_seven_joints;
use super::{configured, set};
use crate::arguments::{Common, Serve};
use crate::failure::BadInput;
use crate::output::{print, print_json};
use crate::progress::{stop_on_signal, stop_requested};

/// Serves the robot until a signal comes.
pub fn run(arguments: &Serve, common: &Common) -> anyhow::Result<()> {
    let tune = configured(None, common, |config: &mut TuneConfig| {
        config.robot = Some(arguments.robot.clone());
        (config.seed, config.pose) = (arguments.seed, usize::from(arguments.pose));
        set(&mut config.truth, Some(&arguments.truth))
    })?;
    let tune = of_seven_joints(tune)?;
    let version = if arguments.robot == "panda" { FciVersion::V5 } else { FciVersion::V10 };
    let arm = tune.trial.model.clone();
    let pushes = arguments.pushes.as_deref().map(PushesFile::read).transpose()?.unwrap_or_default();
    if !common.quiet {
        for limit in not_simulated(&tune.trial.truth.effects, &tune.trial.model.joint_names) {
            message!("tribo: {limit}");
        }
    }
    let unit = ControlUnit::new(version, arm.clone(), plant(&tune.trial, &pushes, tune.config.seed))?;
    let model = match version {
        FciVersion::V5 => model::library(&arm).unwrap_or_else(|error| {
            message!("tribo: clients get no dynamics model: {error}");
            Vec::new()
        }),
        FciVersion::V10 => model::urdf(&arm).into_bytes(),
    };
    let pace = if arguments.lockstep { Pace::Lockstep } else { Pace::RealTime };
    let settings = ServerSettings { version, address: arguments.address, port: Some(arguments.port), pace };
    let mut server = Server::bind(settings, unit, model).map_err(unavailable)?;
    if arguments.fresh {
        server = server.renewing(move |number| {
            let (trial, seed) = tune.numbered(number);
            ControlUnit::new(version, arm.clone(), plant(&trial, &pushes, seed))
        });
    }
    let hand_port = if arguments.port == 0 { 0 } else { arguments.port.saturating_add(1) };
    let mut hand = GripperServer::bind(arguments.address, Some(hand_port)).map_err(unavailable)?;
    // Before the address is told: who reads it may stop the server at once.
    stop_on_signal();
    introduce(arguments, common, server.address()?, hand.address()?);

    let stop = stop_requested();
    std::thread::scope(|scope| {
        let fingers = scope.spawn(|| hand.run(stop));
        let served = server.run(stop, |event| {
            if !common.quiet {
                tell(&event);
            }
        });
        // Whatever ended the arm's server ends the hand's.
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
        let fingers = fingers.join().unwrap_or(Ok(()));
        served.and(fingers)
    })?;
    Ok(())
}

/// The arm of a trial behind a Franka's sensors, which sit on the link side of its gears.
fn plant(trial: &Trial<7>, pushes: &WrenchPulses, seed: u64) -> BoxFrictionPlant<7> {
    let sensors = Sensors { torque_side: TorqueSide::Link, ..trial.sensors };
    Trial { sensors, pulses: pushes.clone(), ..trial.clone() }.plant(seed)
}

/// An address that cannot be had is the user's to change.
fn unavailable(error: ServeError) -> anyhow::Error {
    match error {
        ServeError::Listen { .. } => BadInput(format!("{error}; choose another with --address or --port")).into(),
        other => other.into(),
    }
}

/// What a user's program needs to connect.
fn introduce(arguments: &Serve, common: &Common, robot: SocketAddr, hand: SocketAddr) {
    let (name, version, libraries) = match arguments.robot.as_str() {
        "panda" => ("Panda", 5, "libfranka 0.8 and 0.9, panda-python 1"),
        _ => ("FR3", 10, "libfranka 0.18 and later, pylibfranka, franky"),
    };
    if common.json {
        print_json(&json!({
            "schema": "tribo.serve/1",
            "robot": arguments.robot,
            "version": version,
            "address": robot.ip(),
            "port": robot.port(),
            "hand_port": hand.port(),
            "lockstep": arguments.lockstep,
            "truth": arguments.truth,
            "seed": arguments.seed,
        }));
    } else if !common.quiet {
        let pace = if arguments.lockstep { "in lockstep with its client" } else { "in real time" };
        print(format_args!("{name} at {}, port {}, hand at port {}, {pace}", robot.ip(), robot.port(), hand.port()));
        print(format_args!("interface version {version}: {libraries}"));
        print(format_args!("connect with: franka::Robot robot(\"{}\", franka::RealtimeConfig::kIgnore);", robot.ip()));
    }
    if !arguments.address.is_loopback() {
        message!("tribo: anybody who reaches {} can connect and move the arm", robot.ip());
    }
}

fn tell(event: &ServerEvent) {
    match event {
        ServerEvent::Connected(client) => message!("tribo: {client} connected"),
        ServerEvent::OtherVersion(version) => message!("tribo: sent away: the client speaks version {version}"),
        ServerEvent::Busy(client) => message!("tribo: sent away {client}: another client has the robot"),
        ServerEvent::Disconnected => message!("tribo: the client has gone; the arm stands"),
        ServerEvent::Nonsense => message!("tribo: sent away: what came is no message of this interface"),
        ServerEvent::MoveStarted(_) => message!("tribo: a motion began"),
        ServerEvent::MoveEnded(MoveEnd::Finished, _) => message!("tribo: the motion is finished"),
        ServerEvent::MoveEnded(MoveEnd::Stopped, _) => message!("tribo: the motion was stopped"),
        ServerEvent::MoveEnded(MoveEnd::Reflex, errors) => {
            message!("tribo: the motion ended in a reflex: {}", errors.names().collect::<Vec<_>>().join(", "));
        }
    }
}
