//! `tribo tune --live`.

use std::path::PathBuf;
use std::time::Instant;

use serde_json::{Value, json};
use tribo_campaign::strategy::BestTrial;
use tribo_campaign::{Asked, CampaignError, SentTorque, Told, UserCampaign, ValidTune};
use tribo_fci::Connection;
use tribo_friction::FrictionModel;
use tribo_logs::RobotLog;
use tribo_trial::{AnyEstimator, Trial, record_trial};
use tribo_watch::refresh_report;

use super::ask::on_own_robot;
use super::convert::write_log;
use super::live::{Link, confirm, made, of_seven_joints, preset_of};
use super::tell::judged_trial;
use super::tune::{new_directory, resumed, show_parameters};
use super::{expected, now, opened};
use crate::arguments::{Common, Tune};
use crate::failure::BadInput;
use crate::output::{print, print_json, significant, table};
use crate::progress::stop_on_signal;
use crate::threads;

/// Size of the rehearsal's motion, and how long it takes (s).
const REHEARSAL: (f64, f64) = (0.4, 5.0);

/// Runs or resumes a campaign on a robot that speaks the Franka Control Interface.
pub fn run(arguments: &Tune, host: &str, common: &Common) -> anyhow::Result<()> {
    let started = Instant::now();
    let resumed = if arguments.resume { Some(resumed(arguments)?) } else { None };
    confirm(host, arguments.drive, "about its start pose, 25 mm and 5 degrees each way, half a minute per trial")?;
    let link = Link::to(host, arguments.drive);
    // The robot says what it is, and stays connected for the first trial.
    let connection = link.connect()?;
    let robot = preset_of(connection.version());
    stop_on_signal();
    let (directory, campaign) = match resumed {
        Some(directory) => (directory.clone(), opened::<7>(&directory)?),
        None => {
            let tune = settings(arguments, robot, common)?;
            let directory = new_directory(arguments)?;
            (directory.clone(), UserCampaign::create(&directory, tune, now)?)
        }
    };
    let believed = &campaign.tune().trial.model.name;
    if believed != robot {
        let message = format!("{}: its robot is a {believed}, at {host} is a {robot}", directory.display());
        return Err(BadInput(message).into());
    }
    let mut live = Live { link, connection: Some(connection), campaign, directory, common, lost_periods: 0 };
    live.tune(arguments.no_rehearsal)?;
    live.show(started.elapsed().as_secs_f64());
    Ok(())
}

/// Settings of a new campaign on this robot.
fn settings(arguments: &Tune, robot: &str, common: &Common) -> anyhow::Result<ValidTune<7>> {
    let tune = on_own_robot(arguments.config.as_deref(), &arguments.settings, common, |config| {
        if config.robot.is_none() && config.model.is_none() {
            config.robot = Some(robot.to_owned());
        }
        config.user_trials.get_or_insert_default().torque = SentTorque::Commanded;
        Ok(())
    })?;
    Ok(of_seven_joints(tune)?)
}

/// A campaign and the robot that runs its trials.
struct Live<'a> {
    link: Link,
    connection: Option<Connection>,
    campaign: UserCampaign<7>,
    directory: PathBuf,
    common: &'a Common,
    lost_periods: u64,
}

/// A trial that the robot has run.
struct Recorded {
    log: RobotLog,
    /// Why it ended early, if it did.
    failed: Option<String>,
    lost_periods: u64,
}

impl Live<'_> {
    fn tune(&mut self, no_rehearsal: bool) -> anyhow::Result<()> {
        if !no_rehearsal && self.campaign.finished().next().is_none() {
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
        made(&self.directory.join("recordings"))?;
        write_log(&recording, &ran.log)?;
        let failed = ran.failed.as_deref();
        let judged = judged_trial(&self.campaign, asked.number, (&recording, &ran.log), failed.is_some(), self.common)?;
        let told = self.campaign.tell(asked.number, &judged, failed)?;
        refresh_report(&self.directory)?;
        self.lost_periods += ran.lost_periods;
        self.tell_of(&told, failed, ran.lost_periods);
        Ok(())
    }

    /// A trial on the robot: approach, run, landing.
    fn ran(&mut self, trial: &Trial<7>, friction: &FrictionModel<7>) -> anyhow::Result<Recorded> {
        let connection = match self.connection.take() {
            Some(connection) => connection,
            None => self.link.connect()?,
        };
        let config = &self.campaign.tune().config;
        let estimator = AnyEstimator::for_tuning(config.residual, config.ekf, trial, friction)?;
        let (host, directory) = (&self.link.host, self.directory.display());
        let resume = format!("run the trial again: tribo tune --resume --live {host} --out {directory}");
        let ran =
            self.link.run(&connection, trial, &resume, |plant| record_trial(plant, trial, friction, estimator))?;
        let (outcome, log) = ran.outcome;
        let failed = ran.reason.or_else(|| outcome.aborted.map(|reason| reason.to_string()));
        Ok(Recorded { log, failed, lost_periods: ran.lost_periods })
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
                show_parameters(&tune.space, &tune.trial.model.joint_names, &trial.theta, None);
            }
        }
        print(format_args!("\n{wall_s:.1} s; written {}", self.directory.join("tuned.yaml").display()));
        print(format_args!(
            "next: tribo export {directory} --format c   (or rust, ros2, crisp, urdf, mjcf, yaml, json)"
        ));
    }
}
