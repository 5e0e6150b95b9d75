//! Arguments of `export`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::Ends;

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct Export {
    /// A campaign directory or a tuned.yaml; not with --robot.
    #[arg(required_unless_present = "robot", conflicts_with = "robot")]
    pub source: Option<PathBuf>,
    /// Write a robot without a campaign, as urdf or mjcf: panda, fr3, ur3e, ur5e, ur10e, xarm6, xarm7, kinova_gen3, iiwa14, or the path
    /// of a URDF or MJCF; with the friction that its joints are known to have [default: what was tuned].
    #[arg(long, value_name = "NAME|FILE")]
    pub robot: Option<String>,
    /// Ends of the arm in that file.
    #[command(flatten)]
    pub ends: Ends,
    /// What to write.
    ///
    /// yaml and json: tuned.yaml as it is. c and rust: the compensator as source without dependencies. ros2: a parameter file
    /// for a controller of yours. crisp: friction parameters of crisp_controllers. urdf and mjcf: the robot with its friction.
    #[arg(long, value_parser = PossibleValuesParser::new(["yaml", "json", "ros2", "crisp", "urdf", "mjcf", "c", "rust"]))]
    pub format: String,
    /// File to write [default: standard output].
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// What the target calls it: the node (ros2: friction_compensator, crisp: cartesian_impedance_controller), the prefix of
    /// identifiers (c: tribo), the model (urdf, mjcf: the robot's name).
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
}
