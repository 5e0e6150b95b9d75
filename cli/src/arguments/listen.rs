//! Arguments of `listen`.

use std::net::IpAddr;
use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::RobotModel;

/// Arguments of `listen`.
#[derive(Debug, Args)]
#[command(mut_arg("model", |arg| arg.help("Model of the robot (YAML, schema tribo.model/1), read again when it changes [default: the bare robot without friction]")))]
#[command(mut_arg("robot", |arg| arg.help("The robot, if no --model is given: a preset or the path of a URDF or MJCF [default: that of --compensator]")))]
#[command(mut_arg("torque_side", |arg| arg.help("Side of the gears on which the effort is measured, if no --model is given")))]
#[command(group = clap::ArgGroup::new("arm").required(true).multiple(true).args(["model", "robot", "compensator"]))]
pub struct Listen {
    /// The robot.
    #[command(flatten)]
    pub of: RobotModel,
    /// The tuned compensator that the controller runs (tuned.yaml), read again when it changes: what its law says at the measured
    /// velocity is taken for the part of the effort that cancels friction [default: the friction of the model].
    #[arg(long, value_name = "FILE")]
    pub compensator: Option<PathBuf>,
    /// The wrench estimator. double_encoder needs motor positions, which no JointState has.
    #[arg(long, default_value = "ekf", value_parser = PossibleValuesParser::new(["ekf", "momentum", "qp", "thermal", "double_encoder"]))]
    pub residual: String,
    /// Names of the arm's joints in the messages, base to tool [default: those of the robot's file; of a preset the message's own, by the number
    /// they end with, fingers and grippers left out].
    #[arg(long, value_name = "NAME,NAME,…", value_delimiter = ',')]
    pub joints: Vec<String>,
    /// Topic that is read (sensor_msgs/msg/JointState, with effort; velocity is worked out from positions if it is empty).
    #[arg(long, default_value = "/joint_states", value_name = "TOPIC")]
    pub joint_states: String,
    /// Topic (sensor_msgs/msg/JointState) whose effort is the torque that the controller adds for friction, which takes the place of the
    /// friction law of the model [default: none, the law at the measured velocity].
    #[arg(long, value_name = "TOPIC")]
    pub compensation: Option<String>,
    /// Topic that is written (geometry_msgs/msg/WrenchStamped); the covariance goes to TOPIC/covariance (std_msgs/msg/Float64MultiArray).
    #[arg(long, default_value = "/wrench", value_name = "TOPIC")]
    pub wrench: String,
    /// Topic that is written once a second (diagnostic_msgs/msg/DiagnosticArray).
    #[arg(long, default_value = "/diagnostics", value_name = "TOPIC")]
    pub diagnostics: String,
    /// frame_id of the wrenches [default: the base link in the robot's file; of a preset the name that its maker gives it].
    #[arg(long, value_name = "FRAME")]
    pub frame: Option<String>,
    /// Most wrenches per second (Hz), above 0 and at most 100000 [default: one for each message].
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub rate: Option<f64>,
    /// Domain of DDS, 0 to 232 [default: ROS_DOMAIN_ID, else 0].
    #[arg(long, value_name = "ID", value_parser = clap::value_parser!(u16).range(0..=232))]
    pub domain: Option<u16>,
    /// Address of a network interface to use; may be repeated. 127.0.0.1 stays on this computer [default: all interfaces, as ROS 2 does; this
    /// computer alone where ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST or ROS_LOCALHOST_ONLY=1].
    #[arg(long, value_name = "IP")]
    pub address: Vec<IpAddr>,
    /// Keep the messages that are used in this MCAP file, which the other commands and `ros2 bag play` read [default: none].
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// End after this time (s), above 0 [default: on Ctrl-C].
    #[arg(long = "for", value_name = "S", allow_negative_numbers = true)]
    pub duration_s: Option<f64>,
}
