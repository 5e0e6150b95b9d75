//! Which robot a log, a topic or a motion is of.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::Ends;

/// The model, or the robot without one. Commands say where their default is another.
#[derive(Clone, Debug, Args)]
pub struct RobotModel {
    /// Model of the robot (YAML, schema tribo.model/1) [default: the bare robot without friction].
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// The robot, if no --model is given: a preset or the path of a URDF or MJCF [default: panda, if the log has 7 joints].
    #[arg(long, value_name = "NAME|FILE", conflicts_with = "model")]
    pub robot: Option<String>,
    /// Ends of the arm in that file.
    #[command(flatten)]
    pub ends: Ends,
    /// Side of the gears on which tau_J was measured, if no --model is given.
    #[arg(long, default_value = "motor", value_parser = PossibleValuesParser::new(["motor", "link"]), conflicts_with = "model")]
    pub torque_side: String,
}
