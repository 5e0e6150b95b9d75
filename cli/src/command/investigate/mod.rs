//! `tribo investigate`.

mod robot;
mod settings;

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tribo_diagnose::report::{finding_sentence, verdict_sentence};
use tribo_diagnose::{Diagnosis, Validation, Verdict};
use tribo_model::{TrajectoryFile, to_yaml};
use tribo_robot::{Arm, presets};
use tribo_sim::excitation::{Envelope, ViaPoints};

use super::diagnose::{diagnosed, write_text};
use super::live::made;
use crate::arguments::{Columns, Common, Diagnose, Ends, Investigate, RobotModel};
use crate::output::{print, print_json, significant};
use crate::progress::stop_on_signal;
use robot::Robot;
use settings::Settings;

/// Excursion of the first and of the last motion from the start pose (rad), and their greatest speed (rad/s): what a table-top
/// arm has room for.
const EXPLORING: (f64, f64) = (0.5, 1.0);
/// Length of these motions (s).
const EXPLORING_S: f64 = 40.0;

/// Moves, diagnoses, moves again; then checks the answer on a motion that nothing was fitted to.
pub fn run(arguments: &Investigate, common: &Common) -> anyhow::Result<()> {
    stop_on_signal();
    let robot = Robot::of(arguments)?;
    let settings = Settings::of(arguments, robot.preset());
    let arm = settings.arm()?;
    made(&arguments.out)?;
    settings.agree_with(&arguments.out)?;
    let steps = Steps { directory: arguments.out.clone(), settings, arm, common };

    let first = match &arguments.trajectory {
        Some(path) => TrajectoryFile::new(&steps.arm, &TrajectoryFile::read(path, &steps.arm)?, None),
        None => steps.exploring(arguments.seed),
    };
    steps.plan(&steps.trajectory(0), &first)?;
    let mut number = 0;
    let torques = loop {
        let called = format!("motion {}", number + 1);
        steps.make(&robot, &called, &steps.trajectory(number), &log_name(number))?;
        let (diagnosis, torques) = steps.answer(number)?;
        let motions = counted(number + 1);
        steps.say(format_args!("after {motions}: {}{}", torques.introduction(), verdict_sentence(&diagnosis)));
        let undecided = matches!(diagnosis.verdict, Verdict::Ambiguous | Verdict::Unknown);
        if !undecided || number + 1 >= usize::from(arguments.budget) {
            break torques;
        }
        match diagnosis.next_experiment.as_ref().filter(|next| !next.via_points.is_empty()) {
            // Its motion is in a file by now.
            Some(next) => steps.say(format_args!("next motion: {}", next.instruction)),
            None => {
                steps.say(format_args!(
                    "no motion is known that tells the rivals apart; the next one is more of the first kind"
                ));
                let more = steps.exploring(arguments.seed.wrapping_add(2 + number as u64));
                steps.plan(&steps.trajectory(number + 1), &more)?;
            }
        }
        number += 1;
    };
    let (diagnosis, document) = steps.check(number, torques, &robot, arguments.seed)?;
    steps.show(number + 1, torques, &diagnosis, document)
}

/// Which torques an answer is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Torques {
    /// Those that were asked about.
    Asked,
    /// Those that the sensors of a live robot measured, where what its motors were sent lacks nothing: see [`Steps::answer`].
    Sensors,
}

impl Torques {
    /// Ending of the names of its files.
    fn ending(self) -> &'static str {
        match self {
            Self::Asked => "",
            Self::Sensors => "_sensors",
        }
    }

    /// What goes before a verdict.
    fn introduction(self) -> &'static str {
        match self {
            Self::Asked => "",
            Self::Sensors => "what the motors were sent lacks nothing; of what the torque sensors say: ",
        }
    }
}

/// The files of an investigation.
struct Steps<'a> {
    directory: PathBuf,
    settings: Settings,
    arm: Arm<7>,
    common: &'a Common,
}

impl Steps<'_> {
    fn trajectory(&self, number: usize) -> PathBuf {
        self.directory.join(format!("motion_{number:02}.yaml"))
    }

    fn log(&self, name: &str, torques: Torques) -> PathBuf {
        self.directory.join(format!("{name}{}.{}", torques.ending(), self.settings.log_format))
    }

    fn logs(&self, last: usize, torques: Torques) -> Vec<PathBuf> {
        (0..=last).map(|number| self.log(&log_name(number), torques)).collect()
    }

    fn extended(&self) -> PathBuf {
        self.directory.join("extended.yaml")
    }

    fn report(&self) -> PathBuf {
        self.directory.join("report.html")
    }

    /// A motion of all joints about the ready pose of a Franka, where the arm has it, else about the middle of their ranges.
    fn exploring(&self, seed: u64) -> TrajectoryFile {
        let (range_rad, speed_rad_s) = EXPLORING;
        let ready = presets::panda_ready_pose();
        let has_it = self.arm.first_joint_outside_limits(&ready).is_none();
        let envelope = if has_it { Envelope::around(&self.arm, ready) } else { Envelope::of(&self.arm) };
        let envelope = envelope.within(range_rad).slower_than(speed_rad_s);
        TrajectoryFile::new(&self.arm, &ViaPoints::exploring(&envelope, EXPLORING_S, seed), None)
    }

    /// Writes a motion down; one that is there stays.
    fn plan(&self, trajectory: &Path, motion: &TrajectoryFile) -> anyhow::Result<()> {
        if trajectory.exists() { Ok(()) } else { write_text(trajectory, &to_yaml(motion)?) }
    }

    /// Lets the robot make a motion, which is `called` so; one whose log of this `name` is there has been made.
    fn make(&self, robot: &Robot, called: &str, trajectory: &Path, name: &str) -> anyhow::Result<()> {
        let [log, sensors] = [Torques::Asked, Torques::Sensors].map(|torques| self.log(name, torques));
        if log.exists() {
            return Ok(());
        }
        self.say(format_args!("{called}: {}", trajectory.display()));
        robot.make(trajectory, &log, &sensors, &self.settings)
    }

    /// The answer to all logs so far; the motion that it advises becomes the next one. Where what the motors were sent lacks nothing, the sensors
    /// of a live robot are asked: their gain and delay show in no other torque.
    fn answer(&self, number: usize) -> anyhow::Result<(Diagnosis, Torques)> {
        let asked = self.answer_of(number, Torques::Asked)?;
        let measured = self.logs(number, Torques::Sensors).iter().all(|log| log.exists());
        if asked.verdict != Verdict::NothingMissing || !measured {
            return Ok((asked, Torques::Asked));
        }
        write_text(&self.sensors_model(), &to_yaml(&self.settings.of_sensors()?)?)?;
        let of_sensors = self.answer_of(number, Torques::Sensors)?;
        Ok(match of_sensors.verdict {
            Verdict::NothingMissing => (asked, Torques::Asked),
            _ => (of_sensors, Torques::Sensors),
        })
    }

    fn answer_of(&self, number: usize, torques: Torques) -> anyhow::Result<Diagnosis> {
        let next = self.trajectory(number + 1);
        // What is there was advised by the same logs, or belongs to the check at the end.
        let trajectory = (!next.exists()).then_some(next);
        let diagnosed = diagnosed(&self.diagnose(self.logs(number, torques), torques, trajectory), self.common)?;
        let (diagnosis, document) = diagnosed.document()?;
        let path = self.directory.join(format!("answer_{number:02}{}.json", torques.ending()));
        write_text(&path, &serde_json::to_string_pretty(&document)?)?;
        Ok(diagnosis)
    }

    /// The model that sensors are held against.
    fn sensors_model(&self) -> PathBuf {
        self.directory.join("sensors.yaml")
    }

    /// The same answer with what its extended model is worth on a motion that nothing was fitted to.
    fn check(&self, last: usize, torques: Torques, robot: &Robot, seed: u64) -> anyhow::Result<(Diagnosis, Value)> {
        let trajectory = self.directory.join("check.yaml");
        // Another draw than the first motion's.
        self.plan(&trajectory, &self.exploring(seed.wrapping_add(1)))?;
        self.make(robot, "a last motion, to check the answer", &trajectory, "check")?;
        let mut arguments = self.diagnose(self.logs(last, torques), torques, None);
        arguments.validate = vec![self.log("check", torques)];
        arguments.extend = Some(self.extended());
        arguments.report = Some(self.report());
        diagnosed(&arguments, self.common)?.document()
    }

    fn diagnose(&self, logs: Vec<PathBuf>, torques: Torques, trajectory: Option<PathBuf>) -> Diagnose {
        let of_sensors = torques == Torques::Sensors;
        Diagnose {
            logs,
            columns: Columns::default(),
            anyway: false,
            of: RobotModel {
                model: if of_sensors { Some(self.sensors_model()) } else { self.settings.model.clone() },
                robot: self.settings.robot.clone().filter(|_| !of_sensors),
                ends: Ends { base_link: self.settings.base_link.clone(), tip_link: self.settings.tip_link.clone() },
                torque_side: self.settings.torque_side.clone(),
            },
            extend: None,
            report: None,
            validate: Vec::new(),
            reference: Vec::new(),
            trajectory,
            closed_loop: false,
            band_hz: None,
            seed: self.settings.seed,
            check: false,
        }
    }

    fn say(&self, text: std::fmt::Arguments<'_>) {
        if !self.common.quiet {
            message!("tribo: {text}");
        }
    }

    fn show(&self, motions: usize, torques: Torques, diagnosis: &Diagnosis, answer: Value) -> anyhow::Result<()> {
        let document = json!({
            "schema": "tribo.investigate/1",
            "directory": self.directory,
            "motions": motions,
            "verdict": diagnosis.verdict.name(),
            "torque_sensors": torques == Torques::Sensors,
            "extended": self.extended(),
            "report": self.report(),
            "answer": answer,
        });
        write_text(&self.directory.join("result.json"), &serde_json::to_string_pretty(&document)?)?;
        if self.common.json {
            print_json(&document);
            return Ok(());
        }
        print(format_args!("{}{}", torques.introduction(), verdict_sentence(diagnosis)));
        if self.common.quiet {
            return Ok(());
        }
        for finding in &diagnosis.findings {
            print(format_args!("- {}.", finding_sentence(finding, &diagnosis.joint_names)));
        }
        for unseen in &diagnosis.validation {
            print(format_args!("{}", worth(unseen)));
        }
        print(format_args!("\n{} and one to check; written:", counted(motions)));
        for path in [self.extended(), self.report(), self.directory.join("result.json")] {
            print(format_args!("  {}", path.display()));
        }
        Ok(())
    }
}

/// What the models predict of the last motion, plain fits to the same logs beside the extended one.
fn worth(validation: &Validation) -> String {
    let mean = |joints: &[f64]| significant(joints.iter().sum::<f64>() / joints.len().max(1) as f64, 3);
    let mut text = format!(
        "a motion that nothing was fitted to, RMS torque left (mean of joints): {} Nm before, {} Nm with the extended model",
        mean(&validation.before_nm),
        mean(&validation.after_nm)
    );
    for (name, fit) in [("dry + viscous + offset", &validation.plain_nm), ("all base parameters", &validation.full_nm)]
    {
        if !fit.is_empty() {
            text.push_str(&format!("; {} Nm by a plain fit of {name}", mean(fit)));
        }
    }
    text
}

/// Name of the logs of a motion.
fn log_name(number: usize) -> String {
    format!("log_{number:02}")
}

/// `1 motion`, `2 motions`.
fn counted(motions: usize) -> String {
    format!("{motions} motion{}", if motions == 1 { "" } else { "s" })
}
