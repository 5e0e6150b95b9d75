//! `tribo tune --live`.

use std::io::{IsTerminal, Write};
use std::net::ToSocketAddrs;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;

use serde_json::{Value, json};
use tribo_campaign::scenario::TruthName;
use tribo_campaign::strategy::{BestTrial, StrategyName};
use tribo_campaign::{
    AnyEstimator, AnyTune, Asked, CampaignError, SentTorque, Told, Trial, UserCampaign, UserTrials, record_trial,
};
use tribo_fci::{Connection, ConnectionError, FciVersion};
use tribo_friction::FrictionModel;
use tribo_logs::RobotLog;
use tribo_watch::refresh_report;

use super::ask::TRIALS_OF_GREY_BOX;
use super::convert::write_log;
use super::tell::judged_trial;
use super::tune::{new_directory, resumed, show_parameters};
use super::{configured, expected, now, opened};
use crate::arguments::{Common, LiveDrive, Tune};
use crate::failure::{BadInput, Stopped};
use crate::output::{print, print_json, significant, table};
use crate::progress::{stop_on_signal, stop_requested};
use crate::threads;

/// Size of the rehearsal's motion, and how long it takes (s).
const REHEARSAL: (f64, f64) = (0.4, 5.0);

/// Runs or resumes a campaign on a robot that speaks the Franka Control Interface.
pub fn run(arguments: &Tune, host: &str, common: &Common) -> anyhow::Result<()> {
    let started = Instant::now();
    let resumed = if arguments.resume { Some(resumed(arguments)?) } else { None };
    confirm(host, arguments.drive)?;
    let link = Link { host, real_time: needs_real_time(host, arguments.drive) };
    // The robot says what it is, and stays connected for the first trial.
    let connection = link.connect()?;
    let robot = if connection.version() == FciVersion::V5 { "panda" } else { "fr3" };
    let (directory, campaign) = match resumed {
        Some(directory) => (directory.clone(), opened::<7>(&directory)?),
        None => {
            let tune = settings(arguments, robot)?;
            let directory = new_directory(arguments)?;
            (directory.clone(), UserCampaign::create(&directory, tune, now)?)
        }
    };
    let believed = &campaign.tune().trial.model.name;
    if believed != robot {
        let message = format!("{}: its robot is a {believed}, at {host} is a {robot}", directory.display());
        return Err(BadInput(message).into());
    }
    stop_on_signal();
    let mut live = Live { link, connection: Some(connection), campaign, directory, common, lost_periods: 0 };
    live.tune(arguments.drive)?;
    live.show(started.elapsed().as_secs_f64());
    Ok(())
}

/// Settings of a new campaign on this robot, whose friction nobody knows.
fn settings(arguments: &Tune, robot: &str) -> anyhow::Result<tribo_campaign::ValidTune<7>> {
    let tune = configured(arguments.config.as_deref(), |config| {
        if arguments.config.is_none() {
            config.truth = TruthName::Unknown;
        }
        if config.robot.is_none() && arguments.settings.scenario.model.is_none() {
            config.robot = Some(robot.to_owned());
        }
        arguments.settings.apply(config)?;
        if arguments.config.is_none() && arguments.settings.trials.is_none() && config.strategy == StrategyName::GreyBox {
            config.trials = TRIALS_OF_GREY_BOX;
        }
        config.user_trials = Some(UserTrials { torque: SentTorque::Commanded, ..config.user_trials.unwrap_or_default() });
        Ok(())
    })?;
    match tune {
        AnyTune::Seven(tune) => Ok(tune),
        AnyTune::Six(_) => Err(BadInput("a Franka has seven joints".to_owned()).into()),
    }
}

/// How the robot is reached.
struct Link<'a> {
    host: &'a str,
    real_time: bool,
}

impl Link<'_> {
    fn connect(&self) -> Result<Connection, ConnectionError> {
        Connection::open(self.host, self.real_time)
    }
}

/// A robot elsewhere wants a kernel with real time unless its user says otherwise.
fn needs_real_time(host: &str, drive: LiveDrive) -> bool {
    let addresses = (host, 0).to_socket_addrs();
    let here = addresses.is_ok_and(|mut addresses| addresses.all(|address| address.ip().is_loopback()));
    !(drive.no_realtime || here)
}

/// Asks whether the arm may move.
fn confirm(host: &str, drive: LiveDrive) -> anyhow::Result<()> {
    if drive.yes {
        return Ok(());
    }
    if !std::io::stdin().is_terminal() {
        let message = format!("the arm at {host} will move; say --yes once its space is clear and nobody touches it");
        return Err(BadInput(message).into());
    }
    message!("tribo: the arm at {host} will move about its start pose, 25 mm and 5 degrees each way, for half a minute per trial.");
    message!("tribo: Is the space clear, does nobody touch the arm, and is the stop button at hand? [yes/no]");
    let _ = std::io::stderr().flush();
    let mut answer = String::new();
    std::io::stdin().read_line(&mut answer)?;
    if answer.trim() == "yes" { Ok(()) } else { Err(BadInput("not confirmed; nothing moved".to_owned()).into()) }
}

/// A campaign and the robot that runs its trials.
struct Live<'a> {
    link: Link<'a>,
    connection: Option<Connection>,
    campaign: UserCampaign<7>,
    directory: PathBuf,
    common: &'a Common,
    lost_periods: u64,
}

/// What a motion on the robot left.
struct Ran {
    log: RobotLog,
    /// Why it ended early, if it did.
    failed: Option<String>,
    lost_periods: u64,
}

impl Live<'_> {
    fn tune(&mut self, drive: LiveDrive) -> anyhow::Result<()> {
        if !drive.no_rehearsal && self.campaign.finished().next().is_none() {
            self.say(format_args!("rehearsal: a small motion without compensation"));
            self.rehearse()?;
        }
        let mut unfinished = self.campaign.running().into_iter();
        loop {
            let asked = match unfinished.next() {
                // Asked for by a run that was stopped before the trial was over.
                Some(number) => self.campaign.asked(number)?,
                None if self.campaign.finished().count() >= self.campaign.tune().config.trials => return Ok(()),
                None => match threads::pool(self.common)?.install(|| self.campaign.ask(false)) {
                    Ok(asked) => asked,
                    Err(end @ CampaignError::NothingToGain { .. }) => {
                        self.say(format_args!("{end}"));
                        return Ok(());
                    }
                    Err(error) => return Err(error.into()),
                },
            };
            self.run_trial(&asked)?;
        }
    }

    fn rehearse(&mut self) -> anyhow::Result<()> {
        let mut trial = self.campaign.tune().trial.clone();
        let (share, duration_s) = REHEARSAL;
        trial.reference.amplitude = trial.reference.amplitude.map(|amplitude| share * amplitude);
        trial.reference.duration_s = duration_s;
        let ran = self.ran(&trial, &FrictionModel::none())?;
        match ran.failed {
            Some(reason) => Err(BadInput(format!("the rehearsal ended early: {reason}; no trial was begun")).into()),
            None => Ok(()),
        }
    }

    fn run_trial(&mut self, asked: &Asked) -> anyhow::Result<()> {
        let tune = self.campaign.tune();
        let (trial, friction) = (tune.trial.clone(), tune.space.friction(&asked.theta));
        self.say(format_args!("trial {} (chosen by {})", asked.number, asked.origin));
        let ran = self.ran(&trial, &friction)?;
        let recording = self.directory.join("recordings").join(format!("{:04}.parquet", asked.number));
        std::fs::create_dir_all(self.directory.join("recordings"))?;
        write_log(&recording, &ran.log)?;
        let failed = ran.failed.as_deref();
        let judged = judged_trial(&self.campaign, asked.number, (&recording, &ran.log), failed.is_some(), self.common)?;
        let told = self.campaign.tell(asked.number, &judged, failed)?;
        refresh_report(&self.directory)?;
        self.lost_periods += ran.lost_periods;
        self.tell_of(&told, failed, ran.lost_periods);
        Ok(())
    }

    /// A motion on the robot: approach, run, landing. A wish to stop and a lost connection end the campaign for now.
    fn ran(&mut self, trial: &Trial<7>, friction: &FrictionModel<7>) -> anyhow::Result<Ran> {
        let connection = match self.connection.take() {
            Some(connection) => connection,
            None => self.link.connect()?,
        };
        let config = &self.campaign.tune().config;
        let estimator = AnyEstimator::for_tuning(config.residual, config.ekf, &trial.model, friction)?;
        connection.approach(&trial.model, &trial.start)?;
        let stop = stop_requested();
        let mut plant = connection.torque_plant(&trial.model, stop)?;
        let recorded = record_trial(&mut plant, trial, friction, estimator);
        let (reason, lost_periods) = (plant.reason().map(ToString::to_string), plant.lost_periods());
        let gone = plant.connection_is_lost();
        // Where the robot has ended the motion itself there is nothing left to land.
        let landed = plant.finish();
        if stop.load(Ordering::Relaxed) {
            landed.map_err(ConnectionError::from)?;
            let message = format!("stopped; the trial is run again by: tribo tune --resume --live {} --out {}", self.link.host, self.directory.display());
            return Err(Stopped(message).into());
        }
        if gone {
            landed.map_err(ConnectionError::from)?;
        }
        let (outcome, log) = recorded?;
        let failed = reason.or_else(|| outcome.aborted.map(|reason| reason.to_string()));
        Ok(Ran { log, failed, lost_periods })
    }

    fn say(&self, text: std::fmt::Arguments<'_>) {
        if !self.common.quiet {
            message!("tribo: {text}");
        }
    }

    fn tell_of(&self, told: &Told, failed: Option<&str>, lost_periods: u64) {
        let cost = significant(told.trial.cost.total(), 4);
        let lost = if lost_periods > 0 { format!("; {lost_periods} periods lost") } else { String::new() };
        match failed {
            Some(reason) => self.say(format_args!("trial {} failed: {reason}; J = {cost}{lost}", told.trial.number)),
            None => self.say(format_args!("trial {}: J = {cost}{lost}", told.trial.number)),
        }
    }

    fn show(&self, wall_s: f64) {
        let best = self.campaign.best();
        if self.common.json {
            print_json(&self.document(best, wall_s));
        } else if !self.common.quiet {
            self.show_tables(best, wall_s);
        }
    }

    fn document(&self, best: Option<BestTrial>, wall_s: f64) -> Value {
        let space = &self.campaign.tune().space;
        let trials = self.campaign.finished().map(|trial| {
            json!({
                "trial": trial.number,
                "origin": trial.origin,
                "params": space.nested(&trial.theta),
                "cost": trial.cost.total(),
                "state": if trial.aborted.is_some() { "failed" } else { "complete" },
            })
        });
        json!({
            "schema": "tribo.tune_live/1",
            "campaign": self.directory,
            "robot": self.campaign.tune().trial.model.name,
            "host": self.link.host,
            "trials": trials.collect::<Vec<_>>(),
            "best": best,
            "lost_periods": self.lost_periods,
            "wall_s": wall_s,
        })
    }

    fn show_tables(&self, best: Option<BestTrial>, wall_s: f64) {
        let (tune, directory) = (self.campaign.tune(), self.directory.display());
        let mut trials = table(&["trial", &format!("J [{}]", tune.config.cost.unit()), "chosen by", "state"]);
        for trial in self.campaign.finished() {
            let mark = if best.is_some_and(|best| best.trial == trial.number) { " *" } else { "" };
            trials.add_row([
                format!("{}{mark}", trial.number),
                significant(trial.cost.total(), 4),
                trial.origin.to_string(),
                trial.aborted.map_or("complete".to_owned(), |reason| format!("failed: {reason}")),
            ]);
        }
        print(trials);
        if let Some(best) = best {
            print(format_args!("\nbest: trial {}, expected J of another trial {}", best.trial, expected(&best)));
            if let Some(trial) = self.campaign.finished().find(|trial| trial.number == best.trial) {
                show_parameters(&tune.space, &trial.theta, None);
            }
        }
        print(format_args!("\n{wall_s:.1} s; written {}", Path::new(&self.directory).join("tuned.yaml").display()));
        print(format_args!("next: tribo export {directory} --format c   (or rust, ros2, crisp, urdf, mjcf, yaml, json)"));
    }
}
