//! Arguments of the commands about live robots.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::RobotModel;

/// Arguments of `investigate`.
#[derive(Debug, Args)]
#[command(mut_arg("robot", |arg| arg.conflicts_with("live").help("The robot of --robot-command, when no --model says it: a preset or the path of a URDF or MJCF with seven joints")))]
#[command(mut_arg("torque_side", |arg| arg.help("Side of the gears of the torque, when no --model says it: of a live robot what its motors were sent (motor), and what its \
     sensors measured where that lacks nothing, or its sensors alone (link); of a command what it logs as tau_J")))]
#[command(group = clap::ArgGroup::new("robot_that_moves").required(true).args(["live", "robot_command"]))]
pub struct Investigate {
    /// A Panda or FR3 at this address; tribo serve imitates one. The arm moves.
    #[arg(long, value_name = "HOST")]
    pub live: Option<String>,
    /// A command that makes the robot follow {trajectory} (YAML, schema tribo.trajectory/1) and writes what it measured to {log}, in
    /// any format that convert reads; the shell runs it.
    #[arg(long, value_name = "COMMAND")]
    pub robot_command: Option<String>,
    /// Ending of the logs that the command writes: csv, parquet, mcap.
    #[arg(long, default_value = "csv", value_name = "ENDING", value_parser = PossibleValuesParser::new(["csv", "parquet", "mcap"]))]
    pub log_format: String,
    /// The robot.
    #[command(flatten)]
    pub of: RobotModel,
    /// Most motions to learn from; one more is made at the end, to check the answer.
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=20))]
    pub budget: u8,
    /// First motion (YAML, schema tribo.trajectory/1) [default: one that moves all joints about the ready pose].
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// Directory of motions, logs and answers; one that holds some is gone on with.
    #[arg(long, value_name = "DIR", default_value = "investigation")]
    pub out: PathBuf,
    /// Seed of the motions and of the diagnosis.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// How the live robot is driven.
    #[command(flatten)]
    pub drive: LiveDrive,
}

/// Arguments of `serve`.
#[derive(Debug, Args)]
pub struct Serve {
    /// The robot: a Panda speaks version 5 of the interface (libfranka 0.8 and 0.9), an FR3 version 10 (libfranka 0.18 and later).
    #[arg(long, default_value = "panda", value_parser = PossibleValuesParser::new(["panda", "fr3"]))]
    pub robot: String,
    /// What the simulated arm is like: coulomb_viscous, stribeck, lugre, gaz, soft, thermal, frictionless or a model file.
    #[arg(long, default_value = "coulomb_viscous", value_name = "NAME|FILE")]
    pub truth: String,
    /// Configuration of the arm at the start; 0 is the ready pose.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=2))]
    pub pose: u8,
    /// Seed of the sensors' noise.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Give each client a new arm at the start, with the noise of the trial of that number in a campaign with this seed.
    #[arg(long)]
    pub fresh: bool,
    /// Move the arm one millisecond for each command that comes, without a clock: programs run as fast as they can, the same
    /// bits each time. Without this the arm lives in real time.
    #[arg(long)]
    pub lockstep: bool,
    /// Who pushes the tool, when (YAML, schema tribo.pushes/1).
    #[arg(long, value_name = "FILE")]
    pub pushes: Option<PathBuf>,
    /// Address to listen on. Whoever reaches it can move the arm.
    #[arg(long, default_value = "127.0.0.1", value_name = "IP")]
    pub address: std::net::IpAddr,
    /// TCP port of the robot, the hand's being the next; 0 takes any two. libfranka knows only 1337.
    #[arg(long, default_value_t = 1337)]
    pub port: u16,
}

/// How a live robot is driven.
#[derive(Clone, Copy, Debug, Args)]
#[command(next_help_heading = "Live robot")]
pub struct LiveDrive {
    /// Do not ask whether the space is clear and nobody touches the arm.
    #[arg(long, requires = "live")]
    pub yes: bool,
    /// Drive a robot elsewhere from a kernel without real time; this computer's own addresses never need one.
    #[arg(long, requires = "live")]
    pub no_realtime: bool,
}
