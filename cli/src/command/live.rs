//! A robot that speaks the Franka Control Interface, for the commands that move it.

use std::io::{IsTerminal, Write};
use std::net::ToSocketAddrs;
use std::path::Path;
use std::sync::atomic::Ordering;

use tribo_campaign::{AnyTune, ValidTune};
use tribo_fci::{Connection, ConnectionError, FciVersion, TorquePlant};
use tribo_files::LogError;
use tribo_friction::FrictionModel;
use tribo_logs::{LogColumns, RobotLog};
use tribo_sim::TorqueSide;
use tribo_sim::excitation::JointTrajectory;
use tribo_trial::{Trial, follow_on};

use crate::arguments::{Common, LiveDrive};
use crate::failure::{BadInput, Stopped};
use crate::progress::{StageProgress, stop_requested};

/// How the robot is reached.
#[derive(Clone, Debug)]
pub struct Link {
    /// Host, or host and port.
    pub host: String,
    real_time: bool,
}

/// What a motion on the robot left.
#[derive(Debug)]
pub struct Ran<T> {
    /// What the loop returned.
    pub outcome: T,
    /// Why the robot ended it, if it did.
    pub reason: Option<String>,
    /// Periods whose state did not come.
    pub lost_periods: u64,
}

impl Link {
    /// The way to a host. A robot elsewhere wants a kernel with real time unless its user says otherwise.
    pub fn to(host: &str, drive: LiveDrive) -> Self {
        let addresses = if host.contains(':') { host.to_socket_addrs() } else { (host, 0).to_socket_addrs() };
        let here = addresses.is_ok_and(|mut addresses| addresses.all(|address| address.ip().is_loopback()));
        Self { host: host.to_owned(), real_time: !(drive.no_realtime || here) }
    }

    /// Connects.
    pub fn connect(&self) -> Result<Connection, ConnectionError> {
        Connection::open(&self.host, self.real_time)
    }

    /// Brings the arm to the start of the trial, runs `motion` under torque control, and lands. A wish to stop and a lost connection are
    /// errors; `resume` tells how to go on after the former.
    pub fn run<T>(
        &self,
        connection: &Connection,
        trial: &Trial<7>,
        resume: &str,
        motion: impl FnOnce(&mut TorquePlant<'_>) -> Result<T, LogError>,
    ) -> anyhow::Result<Ran<T>> {
        connection.approach(&trial.model, &trial.start)?;
        let stop = stop_requested();
        let mut plant = connection.torque_plant(&trial.model, stop)?;
        let outcome = motion(&mut plant);
        let (reason, lost_periods) = (plant.reason().map(ToString::to_string), plant.lost_periods());
        let gone = plant.connection_is_lost();
        // Where the robot has ended the motion itself there is nothing left to land.
        let landed = plant.finish();
        if stop.load(Ordering::Relaxed) {
            landed.map_err(ConnectionError::from)?;
            return Err(Stopped(format!("stopped, the arm stands; {resume}")).into());
        }
        if gone {
            landed.map_err(ConnectionError::from)?;
        }
        match (outcome, reason) {
            (Ok(outcome), reason) => Ok(Ran { outcome, reason, lost_periods }),
            // Too short for a log, which is not what is wrong.
            (Err(_), Some(reason)) => Err(BadInput(format!("the robot ended the motion at once: {reason}")).into()),
            (Err(error), None) => Err(error.into()),
        }
    }

    /// Plays a joint-space motion with this compensator and records it as the robot said it (see [`seen_from`]).
    pub fn play(
        &self,
        trial: &Trial<7>,
        friction: &FrictionModel<7>,
        motion: &dyn JointTrajectory<7>,
        resume: &str,
    ) -> anyhow::Result<RobotLog> {
        let connection = self.connect()?;
        let trial = Trial { start: motion.at(0.0).q, ..trial.clone() };
        let ran = self.run(&connection, &trial, resume, |plant| follow_on(plant, &trial, friction, motion))?;
        let (followed, log) = ran.outcome;
        let ended = ran.reason.or_else(|| followed.aborted.map(|(reason, _)| reason.to_string()));
        match ended {
            Some(reason) => {
                let at_s = followed.duration_s;
                Err(BadInput(format!("the motion ended after {at_s:.3} s: {reason}")).into())
            }
            None => Ok(log),
        }
    }
}

/// A connection that commands nothing.
pub fn heard(host: &str) -> Result<Connection, BadInput> {
    Connection::listen(host).map_err(|error| BadInput(format!("{host}: {error}")))
}

/// Longest that a robot is watched (s): an hour.
const LONGEST_WATCH_S: f64 = 3600.0;

/// Watches a robot that somebody else moves, or nobody: measured q, dq and tau_J at 1 kHz, and the torque sent without gravity as tau_J_d. Ctrl-C ends it early. Gives
/// the preset that speaks its version, too.
pub fn watched(host: &str, seconds: f64, common: &Common) -> anyhow::Result<(RobotLog, &'static str)> {
    if !(seconds > 0.0 && seconds <= LONGEST_WATCH_S) {
        let message = format!("--seconds is {seconds}; allowed: above 0, at most {LONGEST_WATCH_S}");
        return Err(BadInput(message).into());
    }
    let connection = heard(host)?;
    let (stop, progress) = (stop_requested(), StageProgress::new(common.quiet));
    let empty = || vec![Vec::new(); 7];
    let mut columns = LogColumns {
        q_rad: empty(),
        dq_rad_s: empty(),
        tau_j_nm: empty(),
        tau_j_d_nm: Some(empty()),
        ..LogColumns::default()
    };
    let mut begun = None;
    connection.watch(|state| {
        let time_s = state.time.as_secs_f64();
        let since_s = time_s - *begun.get_or_insert(time_s);
        // A state that comes twice is one sample.
        if columns.time_s.last().is_none_or(|last| since_s > *last) {
            columns.time_s.push(since_s);
            let sent = columns.tau_j_d_nm.get_or_insert_default();
            for j in 0..7 {
                columns.q_rad[j].push(state.q[j]);
                columns.dq_rad_s[j].push(state.dq[j]);
                columns.tau_j_nm[j].push(state.tau_J[j]);
                sent[j].push(state.tau_J_d[j]);
            }
        }
        progress.stage("watching", since_s / seconds);
        since_s < seconds && !stop.load(Ordering::Relaxed)
    })?;
    progress.finish();
    Ok((columns.validate()?, preset_of(connection.version())))
}

/// The log of a live robot with the torque of this side of the gears as tau_J: the sensors', or the motors', which is what was sent before the sample.
pub fn seen_from(side: TorqueSide, log: RobotLog) -> Result<RobotLog, LogError> {
    let motors = log.tau_j_d_nm.as_ref().filter(|_| side == TorqueSide::Motor);
    let late = |sent: &Vec<f64>| sent.first().into_iter().chain(sent).take(sent.len()).copied().collect();
    let Some(tau_j_nm) = motors.map(|sent| sent.iter().map(late).collect()) else { return Ok(log) };
    LogColumns { tau_j_nm, ..log.into_columns() }.validate()
}

/// The settings of an arm of seven joints, as each Franka is.
pub fn of_seven_joints(tune: AnyTune) -> Result<ValidTune<7>, BadInput> {
    match tune {
        AnyTune::Seven(tune) => Ok(tune),
        AnyTune::Six(_) => Err(BadInput("a Franka has seven joints".to_owned())),
    }
}

/// Name of the preset that speaks this version.
pub fn preset_of(version: FciVersion) -> &'static str {
    match version {
        FciVersion::V5 => "panda",
        FciVersion::V10 => "fr3",
    }
}

/// Asks whether the arm may move; `how` says what it will do.
pub fn confirm(host: &str, drive: LiveDrive, how: &str) -> anyhow::Result<()> {
    if drive.yes {
        return Ok(());
    }
    if !std::io::stdin().is_terminal() {
        let message = format!("the arm at {host} will move; say --yes once its space is clear and nobody touches it");
        return Err(BadInput(message).into());
    }
    message!("tribo: the arm at {host} will move: {how}.");
    message!("tribo: Is the space clear, does nobody touch the arm, and is the stop button at hand? [yes/no]");
    let _ = std::io::stderr().flush();
    let mut answer = String::new();
    std::io::stdin().read_line(&mut answer)?;
    if answer.trim() == "yes" { Ok(()) } else { Err(BadInput("not confirmed; nothing moved".to_owned()).into()) }
}

/// A directory that is there from now on.
pub fn made(directory: &Path) -> Result<(), tribo_model::FileError> {
    std::fs::create_dir_all(directory).map_err(tribo_model::FileError::io(directory))
}
