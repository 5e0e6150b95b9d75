//! Arguments of the commands that read logs.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::RobotModel;

/// How the columns of a log are read.
#[derive(Debug, Clone, Default, Args)]
pub struct Columns {
    /// Which columns of the log are which: a YAML file (schema tribo.map/1), or text like
    /// q=pos_{joint}[deg],dq=vel_{joint},tau=eff_{joint}[mNm],time=stamp[ms]; may be repeated. Keys: time, q, dq, tau, tau_d, tau_friction,
    /// tau_link, theta, dtheta, temperature, temperature_ambient, wrench; joint, joints, episode, rate; of a bag: topic [default: what the names
    /// of the columns say, which is printed].
    #[arg(long, value_name = "FILE|KEY=COLUMN,...")]
    pub map: Vec<String>,
}

/// Arguments of `estimate`.
#[derive(Debug, Args)]
pub struct Estimate {
    /// The log, in any format that convert reads. Of a log with torque on both sides of the gears, without --model, only the friction
    /// of the gears is estimated.
    #[arg(required_unless_present = "live")]
    pub log: Option<PathBuf>,
    /// Watch the Panda or FR3 at this address in place of a log; nothing is commanded. Its torques are those of its sensors, on the link side.
    #[arg(long, value_name = "HOST", conflicts_with_all = ["log", "torque_side"], requires = "record")]
    pub live: Option<String>,
    /// How long the live robot is watched (s).
    #[arg(long, default_value_t = 10.0, value_name = "S", requires = "live", allow_negative_numbers = true)]
    pub seconds: f64,
    /// Log of the watched states: .csv, .csv.gz, .parquet or .mcap.
    #[arg(long, value_name = "FILE", requires = "live")]
    pub record: Option<PathBuf>,
    /// How the columns are read.
    #[command(flatten)]
    pub columns: Columns,
    /// Use a log even if it is refused; the reasons against it are printed.
    #[arg(long)]
    pub anyway: bool,
    /// The robot.
    #[command(flatten)]
    pub of: RobotModel,
    /// Which estimators to run, one or several with commas; torque is the torque residual alone [default: ekf,torque].
    #[arg(long, value_delimiter = ',', value_parser = PossibleValuesParser::new(["all", "ekf", "momentum", "qp", "thermal", "double_encoder", "torque"]))]
    pub residual: Vec<String>,
    /// A log of the same robot in contact-free motion, from which friction band, noise and tare of the estimators are identified
    /// [default: the band of the model's friction, the noise of a Panda, no tare].
    #[arg(long, value_name = "LOG")]
    pub free: Option<PathBuf>,
    /// Expected share of samples with contact, above 0 and at most 1: wrenches that their interval does not distinguish from zero,
    /// stiction of a standing arm above all, are then reported as nearly zero [default: no such prior].
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, requires = "free")]
    pub touched: Option<f64>,
    /// Band of the torque residual (Hz).
    #[arg(long, default_value_t = 10.0, value_name = "HZ", allow_negative_numbers = true)]
    pub band_hz: f64,
    /// Length of the alternating train and test blocks of the friction fit (s).
    #[arg(long, default_value_t = 2.0, value_name = "S", allow_negative_numbers = true)]
    pub block_s: f64,
    /// Write the wrenches along the log, with standard deviation and 95 % interval, to this Parquet file.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

impl Estimate {
    /// The estimators that are asked for: those that are named, else one and the torque residual.
    pub fn asked(&self) -> Vec<&str> {
        if self.residual.is_empty() {
            vec!["ekf", "torque"]
        } else {
            self.residual.iter().map(String::as_str).collect()
        }
    }

    /// Whether the choice of estimators is left to the command, or to the log.
    pub fn names_no_estimator(&self) -> bool {
        self.residual.is_empty() || self.residual.iter().any(|name| name == "all")
    }
}

/// Arguments of `diagnose`.
#[derive(Debug, Args)]
#[command(mut_arg("model", |arg| arg.help("Model that the logs are held against (YAML, schema tribo.model/1) [default: the bare robot without friction; rotors \
     without inertia where link-side torque was logged too]")))]
pub struct Diagnose {
    /// The logs of one session, in any format that convert reads.
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// How the columns are read.
    #[command(flatten)]
    pub columns: Columns,
    /// Use a log even if it is refused; the reasons against it are printed.
    #[arg(long)]
    pub anyway: bool,
    /// The robot.
    #[command(flatten)]
    pub of: RobotModel,
    /// Write the model with the findings added (YAML); tune, simulate and estimate read it.
    #[arg(long, value_name = "FILE")]
    pub extend: Option<PathBuf>,
    /// Write a report with all evidence (one HTML file).
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Test the corrected model on this log, which no parameter is fitted to; may be repeated.
    #[arg(long, value_name = "LOG")]
    pub validate: Vec<PathBuf>,
    /// A log of the same arm without payload; may be repeated. It separates a payload from heavier links and from an error of the
    /// torque scale.
    #[arg(long, value_name = "UNLOADED")]
    pub reference: Vec<PathBuf>,
    /// Write the via points of the next experiment (YAML, schema tribo.trajectory/1).
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// Simulate how much the findings improve a controller's cost J.
    #[arg(long)]
    pub closed_loop: bool,
    /// Band of the torque residual (Hz) [default: from the noise of the log].
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub band_hz: Option<f64>,
    /// Seed of permutations, bootstrap and closed loop.
    #[arg(long, default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,
    /// Fail (exit code 1) unless nothing is missing.
    #[arg(long)]
    pub check: bool,
}

/// Arguments of `convert`.
#[derive(Debug, Args)]
pub struct Convert {
    /// The log to read; its format is found from its content: CSV (canonical, libfranka, Kinova Gen3, or with other columns),
    /// Parquet, NumPy (.npz), MCAP, a rosbag2 (MCAP or SQLite), the text directory of the public Panda data set.
    pub log: PathBuf,
    /// The log to write: .csv, .csv.gz, .parquet or .mcap.
    pub out: PathBuf,
    /// How the columns are read.
    #[command(flatten)]
    pub columns: Columns,
    /// Column names of a CSV file: q_0 (tribo) or a tree like /joint_0/q (plotjuggler). Tribo reads both.
    #[arg(long = "for", value_name = "READER", default_value = "tribo", value_parser = PossibleValuesParser::new(["tribo", "plotjuggler"]))]
    pub reader: String,
}
