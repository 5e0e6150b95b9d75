//! The command line.

use std::path::PathBuf;

mod ends;
mod export;
mod listen;
mod live;
mod logs;
mod robot_model;

pub use ends::Ends;
pub use export::Export;
pub use listen::Listen;
pub use live::{Investigate, LiveDrive, Serve};
pub use logs::{Columns, Convert, Diagnose, Estimate};
pub use robot_model::RobotModel;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand};
use tribo_campaign::StopBelow;

/// Estimates the wrench at a robot arm's tool without a force sensor, tunes the friction compensator of its controller, and says what a
/// model gets wrong about a measured log.
#[derive(Debug, Parser)]
#[command(name = "tribo", version, max_term_width = 110, after_help = EXAMPLES)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

const EXAMPLES: &str = "Examples:
  tribo tune                                   tune the friction compensator of a simulated Panda
  tribo tune --friction stribeck --truth stribeck --pose 1 --seed 7
  tribo tune --robot ur10e                     another arm: fr3, ur5e, xarm7, … a URDF or MJCF
  tribo tune --resume --out campaigns/0001     go on with a campaign that was stopped
  tribo ask campaigns/mine --out next.yaml     parameters to try on your own robot …
  tribo tell campaigns/mine trial.csv          … and what came of them
  tribo study STUDY.yaml --shard 1/4           compare strategies over many campaigns; one slice of four
  tribo export campaigns/0001 --format c       the tuned compensator as a C header; also ros2, crisp, urdf, mjcf, rust
  tribo dashboard campaigns/0001               look at it, also while it runs
  tribo report campaigns/0001                  the campaign as one HTML file
  tribo simulate --log trial.csv               one trial as a robot log
  tribo convert panda_gaz2019 panda.csv        a log of another program as canonical CSV
  tribo convert mine.csv log.csv --map 'q=pos_{joint}[deg],tau=eff_{joint},time=stamp'      … with columns of your own
  tribo estimate panda.csv --torque-side link  torque residual of every joint, wrench at the tool
  tribo diagnose panda.csv --model panda.yaml  what the model gets wrong about a measured log
  tribo bench                                  is this computer fast enough for 1 kHz?
  tribo bench --realtime 60 --load             … does it meet its deadlines with every core busy?

Exit codes: 0 done, 1 a check asked for has failed, 2 bad input, 3 internal error.";

/// Options of every command.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options of every command")]
pub struct Common {
    /// Print one JSON document instead of tables.
    #[arg(long, global = true)]
    pub json: bool,
    /// Print no progress and no messages.
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Print more messages.
    #[arg(long, short, global = true)]
    pub verbose: bool,
    /// Threads for trials and searches, 0 to 1024; 0 is one per core. The results do not depend on it.
    #[arg(long, global = true, default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u16).range(0..=1024))]
    pub threads: u16,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Tune the friction compensator of a simulated arm over a campaign of trials.
    ///
    /// Writes campaign.yaml, references.yaml, journal.log (readable by optuna-dashboard), trials/NNNN.parquet, tuned.yaml and
    /// report.html. A campaign that was killed goes on with --resume and ends with the same result.
    Tune(Tune),
    /// Print the next parameters to try in a campaign whose trials run on your robot; the first call begins the campaign.
    ///
    /// Prints a compensator as tuned.yaml has it, which `export` turns into what your controller reads. Run a trial with it,
    /// then `tell` Tribo its log. Several trials may run at once; asking again gives another one.
    Ask(Ask),
    /// Judge the log of a trial that `ask` gave by the campaign's estimator, and record its cost.
    ///
    /// The log holds one trial: the run-in, then the judged motion that nobody touches (campaign.yaml, user_trials).
    Tell(Tell),
    /// Run one trial on the simulated arm and write it as a robot log.
    Simulate(Simulate),
    /// Ask a robot until what its model lacks has one name: record a motion, diagnose, and make the experiment that tells rivals apart.
    ///
    /// Every motion, log and answer is a file in --out; a run that was stopped goes on from there. At the end the extended model predicts
    /// a motion that nothing was fitted to.
    Investigate(Investigate),
    /// Serve a simulated Panda or FR3 to programs written for libfranka, as if it were the robot.
    ///
    /// The program connects to --address and runs unchanged: states, motions, torques, reflexes, model, hand. The arm has the friction of
    /// --truth, and its external wrench contains that friction. Ctrl-C ends.
    Serve(Serve),
    /// Publish the tool wrench of a robot on ROS 2 topics, from its joint states; ROS need not be installed. Ctrl-C ends.
    ///
    /// By the robot on the environment, at the flange, in base axes; covariance and diagnostics beside it.
    Listen(Box<Listen>),
    /// Estimate the tool wrench and the joints' torque residual from a robot log.
    Estimate(Estimate),
    /// Say what a model gets wrong about measured logs, which causes explain it, and how much better the corrected model predicts
    /// data that it was not fitted to.
    ///
    /// Several logs are one session. Exit code 0 whatever the verdict, unless --check is given.
    Diagnose(Diagnose),
    /// Convert a robot log to CSV (.csv, .csv.gz), Parquet or MCAP, and list the quantities that it has and lacks.
    ///
    /// CSV is converted in batches of rows: an hour at 1 kHz takes no more memory than a minute.
    Convert(Convert),
    /// Write a tuned compensator for another program.
    ///
    /// What the format cannot express is listed, in Nm per joint, on standard error, in the file and with --json.
    Export(Export),
    /// Write a campaign, finished or running, as one HTML file with all figures; it needs no script and no network.
    Report(Report),
    /// Open the window: start campaigns, watch them live, look at trials, logs and diagnoses.
    ///
    /// A campaign that another process runs is followed through its journal. Watching changes no result.
    Dashboard(Dashboard),
    /// Compare strategies, estimators and simulated frictions over a grid of campaigns, on one machine or many.
    ///
    /// Every finished campaign is one file, so that a killed study goes on when it is started again, and slices merge by living in
    /// one directory. The process that finishes the last campaign writes results.json and report.html. In a Slurm array (sbatch --array) or an
    /// indexed Kubernetes job each task computes its own slice.
    Study(Study),
    /// Measure whether this computer is fast enough for a 1 kHz loop: times of a tick and of its parts, and a verdict.
    ///
    /// With --realtime the loop runs in real time: missed deadlines, late wake-ups, and the reaction to an overrun.
    Bench(Bench),
    /// Rerun the experiments of a paper and print their table.
    Reproduce(Reproduce),
    /// Print a shell completion script.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print a manual page in roff, or write all of them.
    Man(Man),
}

/// Options of `man`.
#[derive(Debug, Args)]
pub struct Man {
    /// The command that the page is about [default: all in short].
    #[arg(value_name = "COMMAND", conflicts_with = "out")]
    pub page: Option<String>,
    /// Directory for the pages of all commands (`tribo.1`, `tribo-tune.1`, …), made if it does not exist; `man -M` expects a folder `man1`.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// What is simulated; each flag overrides the settings file.
#[derive(Debug, Args)]
pub struct Scenario {
    /// The arm: panda, fr3, ur3e, ur5e, ur10e, xarm6, xarm7, kinova_gen3, iiwa14, or the path of a URDF or of an MJCF (MuJoCo)
    /// [default: that of --model, else of --truth, else panda].
    #[arg(long, value_name = "NAME|FILE")]
    pub robot: Option<String>,
    /// Ends of the arm in that file.
    #[command(flatten)]
    pub ends: Ends,
    /// Seed of all random numbers: noise, phases, designs [default: 1].
    #[arg(long, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Simulated (true) friction of the arm, typical of its kind: coulomb_viscous, stribeck, lugre, gaz, soft, thermal or
    /// frictionless; or a model file that says what the simulated robot is like [default: coulomb_viscous].
    #[arg(long, value_name = "NAME|FILE")]
    pub truth: Option<String>,
    /// Number of the arm's pose about which the tool moves, 0 to 2 [default: 0].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=2))]
    pub pose: Option<u8>,
    /// Velocity that the compensator uses near zero speed: the measured one, that of the reference motion, or hybrid (measured where
    /// it stands out of its noise, else the reference's) [default: hybrid].
    #[arg(long, value_parser = PossibleValuesParser::new(["measured", "reference", "hybrid"]))]
    pub velocity: Option<String>,
    /// Model file that the controller uses: its arm, and its effects beside the friction law [default: the bare arm].
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Switch the guard off: run every compensator as it is, even one that exceeds the friction identified so far or shakes the arm.
    #[arg(long)]
    pub unguarded: bool,
}

/// Arguments of `tune`.
#[derive(Debug, Args)]
pub struct Tune {
    /// Settings (YAML, schema tribo.tune/1); flags override it.
    pub config: Option<PathBuf>,
    /// Directory of the campaign [default: the next free campaigns/NNNN, with --resume the last one].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on with the campaign in --out; only --trials and --stop-below may differ from what it began with.
    #[arg(long)]
    pub resume: bool,
    /// What the campaign is like.
    #[command(flatten)]
    pub settings: CampaignSettings,
    /// Watch the campaign in the window while it runs.
    #[arg(long)]
    pub dashboard: bool,
    /// Fail (exit code 1) if the best cost exceeds this multiple of the cost with the simulated (true) friction compensated.
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true)]
    pub check: Option<f64>,
    /// Run the trials on a Panda or FR3 at this address instead of a simulated arm; tribo serve imitates one. The arm moves.
    #[arg(long, value_name = "HOST", conflicts_with_all = ["dashboard", "check"])]
    pub live: Option<String>,
    /// Begin the live campaign with the first trial, without a rehearsal of two fifths of its size that is not judged.
    #[arg(long, requires = "live")]
    pub no_rehearsal: bool,
    /// How the live robot is driven.
    #[command(flatten)]
    pub drive: LiveDrive,
}

/// Settings of a campaign; each flag overrides the settings file.
#[derive(Debug, Args)]
pub struct CampaignSettings {
    /// What is simulated.
    #[command(flatten)]
    pub scenario: Scenario,
    /// Friction law of the compensator; one that you name is kept to the end [default: coulomb_viscous; grey_box changes to stribeck where
    /// that is expected to lower J].
    #[arg(long, value_parser = PossibleValuesParser::new(["coulomb_viscous", "stribeck"]))]
    pub friction: Option<String>,
    /// Estimator from whose wrench the cost is computed [default: ekf].
    #[arg(long, value_parser = PossibleValuesParser::new(["ekf", "momentum", "qp", "thermal", "double_encoder"]))]
    pub residual: Option<String>,
    /// How the cost is computed from that wrench: largest and mean values (paper: roveda2022), or 99 % quantiles with moments as forces
    /// on a lever arm (robust) [default: paper].
    #[arg(long, value_parser = PossibleValuesParser::new(["paper", "robust"]))]
    pub cost: Option<String>,
    /// How the next parameters are chosen [default: grey_box].
    #[arg(long, value_parser = PossibleValuesParser::new(["zero", "gaz", "random", "sobol", "paper", "bo", "composite", "cma_es", "iterative_learning", "grey_box"]))]
    pub strategy: Option<String>,
    /// Largest number of trials; a campaign that has nothing left to gain ends earlier [default: 50; of a new campaign of ask with
    /// grey_box: 5].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub trials: Option<usize>,
    /// Number of trials of the initial design, of strategies that begin with one [default: 10].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub init: Option<usize>,
    /// Number of trials that are chosen together and run in parallel, as on Q robots; a trial does not see the results of its batch
    /// [default: 1].
    #[arg(long, value_name = "Q", allow_negative_numbers = true)]
    pub batch: Option<usize>,
    /// End the campaign once the expected gain of another trial is below this: repeatability (the standard deviation of J over
    /// repetitions), a share of the best J such as 0.01, or never [default: repeatability with grey_box, never with other strategies].
    #[arg(long, value_name = "SHARE|repeatability|never", allow_negative_numbers = true)]
    pub stop_below: Option<StopBelow>,
    /// Bounds of the parameters: from the arm's torque limits, or the paper's, read by index (literal) or by unit (unit_consistent)
    /// [default: torque_limits with grey_box, literal with other strategies].
    #[arg(long, value_parser = PossibleValuesParser::new(["torque_limits", "literal", "unit_consistent"]))]
    pub bounds: Option<String>,
    /// Phases of the reference trajectory: the documented ones, or random by the seed [default: documented].
    #[arg(long, value_parser = PossibleValuesParser::new(["documented", "random"]))]
    pub phases: Option<String>,
}

/// Arguments of `ask`.
#[derive(Debug, Args)]
pub struct Ask {
    /// Directory of the campaign; a new campaign is begun where there is none.
    #[arg(value_name = "DIR")]
    pub campaign: PathBuf,
    /// Settings of a new campaign (YAML, schema tribo.tune/1); flags override it.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Settings of a new campaign. A campaign that has begun keeps its settings; only --trials changes it.
    #[command(flatten)]
    pub settings: CampaignSettings,
    /// Length of the run-in at the beginning of every log (s) [default: 3].
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub judged_from: Option<f64>,
    /// Length of the judged motion after it (s) [default: 30].
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub judged: Option<f64>,
    /// Column of the logs that holds the torque which moved the arm: tau_J_d (commanded), tau_J_d of a robot that adds gravity itself
    /// (commanded_without_gravity), or tau_J of the motors (measured) [default: commanded].
    #[arg(long, value_parser = PossibleValuesParser::new(["commanded", "commanded_without_gravity", "measured"]))]
    pub torque: Option<String>,
    /// Print the parameters of this running trial once more, in place of new ones.
    #[arg(long, value_name = "N")]
    pub trial: Option<usize>,
    /// Give another trial even if nothing is left to gain.
    #[arg(long)]
    pub anyway: bool,
    /// Format of the compensator, as in export.
    #[arg(long, default_value = "yaml", value_parser = PossibleValuesParser::new(["yaml", "json", "ros2", "crisp", "urdf", "mjcf", "c", "rust"]))]
    pub format: String,
    /// File to write the compensator to [default: standard output].
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Arguments of `tell`.
#[derive(Debug, Args)]
pub struct Tell {
    /// Directory of the campaign.
    #[arg(value_name = "DIR")]
    pub campaign: PathBuf,
    /// Log of the trial, in any format that convert reads; of a failed trial, as far as it goes.
    #[arg(value_name = "LOG", required_unless_present_any = ["failed", "give_up", "withdraw"])]
    pub log: Option<PathBuf>,
    /// How the columns are read.
    #[command(flatten)]
    pub columns: Columns,
    /// The trial [default: the one that is running].
    #[arg(long, value_name = "N")]
    pub trial: Option<usize>,
    /// Record the trial as failed, and why: acceleration, error, joint_limit, joint_speed, torque_saturation, nullspace_runaway, or in
    /// your words. Its parameters are avoided afterwards, unless REASON is stopped: then it was stopped for a reason of its own.
    #[arg(long, value_name = "REASON")]
    pub failed: Option<String>,
    /// Give the trial up: it has no result and is ignored.
    #[arg(long, conflicts_with_all = ["log", "failed"])]
    pub give_up: bool,
    /// Withdraw trial N, which was told before: it is ignored from now on, and another may be asked for in its place. The journal keeps
    /// what was told and the reason.
    #[arg(long, value_name = "N", requires = "reason", conflicts_with_all = ["log", "failed", "give_up", "trial"])]
    pub withdraw: Option<usize>,
    /// Why trial N is withdrawn, in your words.
    #[arg(long, value_name = "REASON", requires = "withdraw", conflicts_with_all = ["log", "failed", "give_up", "trial"])]
    pub reason: Option<String>,
}

/// Arguments of `simulate`.
#[derive(Debug, Args)]
pub struct Simulate {
    /// Settings (YAML, schema tribo.tune/1) for truth, pose, gains and noise; flags override it.
    pub config: Option<PathBuf>,
    /// Log to write (.csv, .csv.gz, .parquet or .mcap).
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
    /// Simulate with the noise of this trial of a campaign, and as warm as the arm is by then [default: noise of the seed, cold].
    #[arg(long, value_name = "N", conflicts_with = "trajectory")]
    pub trial: Option<usize>,
    /// Friction compensator: none, oracle (knows the simulated friction), a tuned.yaml, or a model file.
    #[arg(long, default_value = "none", value_name = "none|oracle|FILE")]
    pub compensation: String,
    /// Factor on the friction that the compensator cancels: 1.5 over-compensates by half.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, allow_negative_numbers = true)]
    pub scale: f64,
    /// Follow the joint-space motion of this file (YAML, schema tribo.trajectory/1) instead of the tool's trajectory.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["fixed", "pulse_force", "pulse_moment", "pose"])]
    pub trajectory: Option<PathBuf>,
    /// What is simulated.
    #[command(flatten)]
    pub scenario: Scenario,
    /// Side of the gears on which tau_J is measured.
    #[arg(long, default_value = "motor", value_parser = PossibleValuesParser::new(["motor", "link"]))]
    pub torque_side: String,
    /// Hold a fixed set-point instead of moving.
    #[arg(long)]
    pub fixed: bool,
    /// Force (N) with which the tool is pushed along each axis in turn.
    #[arg(long, value_name = "N", default_value_t = 0.0, allow_negative_numbers = true)]
    pub pulse_force: f64,
    /// Moment (Nm) with which the tool is turned about each axis in turn.
    #[arg(long, value_name = "NM", default_value_t = 0.0, allow_negative_numbers = true)]
    pub pulse_moment: f64,
    /// Play the motion of --trajectory on a Panda or FR3 at this address instead, and record it. The arm moves.
    #[arg(long, value_name = "HOST", requires_all = ["trajectory", "log"])]
    pub live: Option<String>,
    /// How the live robot is driven.
    #[command(flatten)]
    pub drive: LiveDrive,
}

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub struct Bench {
    /// The arm: panda, fr3, ur3e, ur5e, ur10e, xarm6, xarm7, kinova_gen3, iiwa14, or the path of a URDF or MJCF [default: panda].
    #[arg(long, value_name = "NAME|FILE")]
    pub robot: Option<String>,
    /// Ends of the arm in that file.
    #[command(flatten)]
    pub ends: Ends,
    /// Ticks to be timed [default: 1000000].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1000..=100_000_000), conflicts_with = "realtime")]
    pub ticks: Option<u64>,
    /// Take a few seconds instead of a minute: 30000 ticks, everything else once.
    #[arg(long, conflicts_with = "realtime")]
    pub quick: bool,
    /// Run the loop on the clock for this long (s) instead, with SCHED_FIFO and locked memory where they are permitted.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub realtime: Option<f64>,
    /// Keep every core busy while the loop runs.
    #[arg(long, requires = "realtime")]
    pub load: bool,
    /// Missed deadlines in a row at which the loop gives up and sends the safe torque; before, the last command is held.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000), requires = "realtime")]
    pub overruns: u32,
    /// Stop the loop once for this long (ms), to see how it reacts.
    #[arg(long, value_name = "MS", requires = "realtime", allow_negative_numbers = true)]
    pub stall: Option<f64>,
    /// Time (s) of that stop [default: in the middle].
    #[arg(long, value_name = "S", requires = "stall", allow_negative_numbers = true)]
    pub stall_at: Option<f64>,
    /// Exit code 1 when the verdict is "not fit"; with --stall, when the arm is not safe afterwards.
    #[arg(long)]
    pub check: bool,
}

/// Arguments of `report`.
#[derive(Debug, Args)]
pub struct Report {
    /// The campaign directory.
    #[arg(value_name = "DIR")]
    pub campaign: PathBuf,
    /// File to write [default: report.html in the campaign directory].
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Arguments of `dashboard`.
#[derive(Debug, Args)]
pub struct Dashboard {
    /// A campaign directory or a robot log [default: a form to start a campaign from].
    #[arg(value_name = "DIR|LOG")]
    pub open: Option<PathBuf>,
    /// Watch the Panda or FR3 at this address: arm, wrench, torques, loop times. Nothing is commanded, the robot may be in any mode.
    #[arg(long, value_name = "HOST", conflicts_with_all = ["open", "compare"])]
    pub live: Option<String>,
    /// The wrench estimator of --live.
    #[arg(long, default_value = "ekf", requires = "live", value_parser = PossibleValuesParser::new(["ekf", "momentum", "qp", "thermal"]))]
    pub residual: String,
    /// Time that --screenshot watches the robot of --live before it draws (s).
    #[arg(long, default_value_t = 5.0, requires = "live")]
    pub seconds: f64,
    /// How the columns of a log are read.
    #[command(flatten)]
    pub columns: Columns,
    /// View to begin with.
    #[arg(long, value_parser = PossibleValuesParser::new(["campaign", "trial", "arm", "log", "diagnosis", "compare", "live"]))]
    pub view: Option<String>,
    /// Second campaign directory, of the view `compare`.
    #[arg(long, value_name = "DIR")]
    pub compare: Option<PathBuf>,
    /// The robot.
    #[command(flatten)]
    pub of: RobotModel,
    /// Write the view as a PNG picture and exit; needs no display.
    #[arg(long, value_name = "FILE")]
    pub screenshot: Option<PathBuf>,
    /// Size of the picture (px).
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = picture_size)]
    pub size: [usize; 2],
    /// Draw the picture with dark colours.
    #[arg(long)]
    pub dark: bool,
}

/// `1280x800`.
fn picture_size(text: &str) -> Result<[usize; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides
        .filter(|sides: &[usize; 2]| sides.iter().all(|side| (320..=7680).contains(side)))
        .ok_or_else(|| "expected WIDTHxHEIGHT with sides of 320 to 7680".to_owned())
}

/// Arguments of `study`.
#[derive(Debug, Args)]
pub struct Study {
    /// The grid (YAML, schema tribo.study/1).
    pub study: PathBuf,
    /// Directory of the study [default: that of STUDY.yaml without .yaml].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Compute slice K of N, K from 1 [default: the task of the job array, else everything].
    #[arg(long, value_name = "K/N")]
    pub shard: Option<String>,
}

/// Arguments of `reproduce`.
#[derive(Debug, Args)]
pub struct Reproduce {
    /// The paper or question, or the number of its experiment.
    #[arg(value_parser = PossibleValuesParser::new(["roveda2022", "01", "linderoth2013", "02", "simoni2017", "03", "simoni2019", "04", "uhlmann2023", "05", "wrench_pulses", "07", "overcompensation", "09"]))]
    pub paper: String,
    /// Settings (YAML, schema tribo.reproduce/1) [default: those that ship with the experiment].
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Number of seeds to run [default: those of the settings].
    #[arg(long, value_name = "N")]
    pub seeds: Option<u64>,
    /// Write the results as JSON to this file.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Compare with such a file; exit code 1 if a figure differs by more than it repeats to.
    #[arg(long, value_name = "FILE")]
    pub check: Option<PathBuf>,
}
