//! The command line.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand};
use tribo_campaign::StopBelow;

/// Gives any robot arm without force sensors a trustworthy sense of touch.
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
  tribo tune                                   tune a simulated Panda until nothing is left to gain
  tribo tune --friction stribeck --truth stribeck --pose 1 --seed 7
  tribo tune --robot ur10e                     another arm: fr3, ur10e, kinova_gen3, iiwa14 or a URDF
  tribo tune --resume --out campaigns/0001     go on with a campaign that was stopped
  tribo ask campaigns/mine --out next.yaml     parameters to try on your own robot …
  tribo tell campaigns/mine trial.csv          … and what came of them
  tribo study STUDY.yaml --shard 1/4           compare strategies over many campaigns; one slice of four
  tribo export campaigns/0001 --format c       the tuned compensator as a C header; also ros2, crisp, urdf, mjcf, rust
  tribo dashboard campaigns/0001               look at it, also while it runs
  tribo report campaigns/0001                  the campaign as one HTML file
  tribo simulate --log trial.csv               one trial as a robot log
  tribo convert panda_gaz2019 panda.csv        a log of another program as canonical CSV
  tribo estimate panda.csv --torque-side link  what the joint torques and the tool say about it
  tribo diagnose panda.csv --model panda.yaml  what the model lacks, and what that is worth
  tribo bench                                  is this computer fast enough for 1 kHz?
  tribo bench --realtime 60 --load             … and is it on time, with every core busy?

Exit codes: 0 done, 1 a check asked for has failed, 2 bad input, 3 internal error.";

/// Options of every command.
#[derive(Debug, Args)]
pub struct Common {
    /// Print one JSON document instead of tables.
    #[arg(long, global = true)]
    pub json: bool,
    /// No progress and no messages.
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// More messages.
    #[arg(long, short, global = true)]
    pub verbose: bool,
    /// Threads for trials and searches, at most 1024; 0 is one per core. The results do not depend on it.
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
    /// The next parameters of a campaign whose trials run on your robot; the first call begins the campaign.
    ///
    /// Prints a compensator as tuned.yaml has it, which `export` turns into what your controller reads. Run a trial with it,
    /// then `tell` what came of it. Several trials may be in flight; asking again gives another one.
    Ask(Ask),
    /// What came of a trial that `ask` gave: its log is judged by the campaign's estimator and recorded.
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
    /// --truth, and its external wrench knows nothing of it. Ctrl-C ends.
    Serve(Serve),
    /// Estimate the tool wrench and the joints' torque residual from a robot log.
    Estimate(Estimate),
    /// Say what a model gets wrong about measured logs, why, and what the extended model is worth on unseen data.
    ///
    /// Several logs are one session. Exit code 0 whatever the verdict, unless --check is given.
    Diagnose(Diagnose),
    /// Convert a robot log to canonical CSV (.csv, .csv.gz), Parquet or MCAP, and say what it holds and lacks.
    ///
    /// CSV is converted in batches of rows: an hour at 1 kHz takes no more memory than a minute.
    Convert(Convert),
    /// Write a tuned compensator for another program.
    ///
    /// What the format cannot say is told, with the torque that it is worth, on standard error, in the file and with --json.
    Export(Export),
    /// Write a campaign, finished or running, as one HTML file with all figures; it needs no script and no network.
    Report(Report),
    /// Open the window: start campaigns, watch them live, look at trials, logs and diagnoses.
    ///
    /// A campaign that another process runs is followed through its journal. Watching changes no result.
    Dashboard(Dashboard),
    /// Compare strategies, estimators and truths over a grid of campaigns, on one machine or many.
    ///
    /// Every finished campaign is one file, so that a killed study goes on when it is started again, and slices merge by living in
    /// one directory. Whoever finishes the last one writes results.json and report.html. In a Slurm array (sbatch --array) or an
    /// indexed Kubernetes job each task takes its slice by itself.
    Study(Study),
    /// Is this computer fast enough for a 1 kHz loop? Times of a tick and of what it is made of, and a verdict.
    ///
    /// With --realtime the loop runs on the clock: missed deadlines, late wake-ups, what it does when it is too late.
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
    /// Directory for the pages of all commands (`tribo.1`, `tribo-tune.1`, …), made if it is not there; `man -M` wants them in `man1`.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// What is simulated; each flag overrides the settings file.
#[derive(Debug, Args)]
pub struct Scenario {
    /// The arm: panda, fr3, ur10e, kinova_gen3, iiwa14 or the path of a URDF [default: that of --model, else of --truth, else panda].
    #[arg(long, value_name = "NAME|URDF")]
    pub robot: Option<String>,
    /// Seed of everything random.
    #[arg(long, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// What the simulated arm is like: coulomb_viscous, stribeck, lugre, gaz, soft, thermal, frictionless (with the friction that
    /// arms of its kind have) or a model file.
    #[arg(long)]
    pub truth: Option<String>,
    /// Configuration about which the tool moves.
    #[arg(long, value_parser = clap::value_parser!(u8).range(0..=2))]
    pub pose: Option<u8>,
    /// Velocity the compensator believes near zero speed.
    #[arg(long, value_parser = PossibleValuesParser::new(["measured", "reference", "hybrid"]))]
    pub velocity: Option<String>,
    /// Model file the controller believes in: its arm, and its effects on top of the friction law [default: the bare arm].
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// Trust every compensator: none is held back to the friction identified before, none withdrawn when it shakes the arm.
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
    /// Fail (exit code 1) if the best cost exceeds this multiple of the oracle's.
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

/// Settings of a campaign; each flag overrides the settings file.
#[derive(Debug, Args)]
pub struct CampaignSettings {
    /// What is simulated.
    #[command(flatten)]
    pub scenario: Scenario,
    /// Friction law of the compensator, kept whatever the logs say [default: coulomb_viscous; grey_box goes over to stribeck where that
    /// is expected to pay].
    #[arg(long, value_parser = PossibleValuesParser::new(["coulomb_viscous", "stribeck"]))]
    pub friction: Option<String>,
    /// Estimator whose wrench is the cost.
    #[arg(long, value_parser = PossibleValuesParser::new(["ekf", "momentum", "qp", "thermal", "double_encoder"]))]
    pub residual: Option<String>,
    /// What is made of that wrench: largest values (roveda2022), or 99 % quantiles with moments as forces on a lever arm.
    #[arg(long, value_parser = PossibleValuesParser::new(["paper", "robust"]))]
    pub cost: Option<String>,
    /// What chooses the next parameters.
    #[arg(long, value_parser = PossibleValuesParser::new(["zero", "gaz", "random", "sobol", "paper", "bo", "composite", "cma_es", "iterative_learning", "grey_box"]))]
    pub strategy: Option<String>,
    /// Most trials; a campaign that has nothing left to gain ends before [default: 50; of a new campaign of ask with grey_box: 5].
    #[arg(long, allow_negative_numbers = true)]
    pub trials: Option<usize>,
    /// Trials of the initial design.
    #[arg(long, allow_negative_numbers = true)]
    pub init: Option<usize>,
    /// Trials that are chosen together and run side by side, as on so many robots: faster, and each knows less [default: 1].
    #[arg(long, value_name = "Q", allow_negative_numbers = true)]
    pub batch: Option<usize>,
    /// End the campaign once another trial promises less than this: repeatability (the deviation of J when the same parameters are tried
    /// again), a share of the best J, or never [default: repeatability with grey_box, never with other strategies].
    #[arg(long, value_name = "SHARE|repeatability|never", allow_negative_numbers = true)]
    pub stop_below: Option<StopBelow>,
    /// Parameter box: as wide as the arm's torque limits allow, or the paper's bounds by index (literal) or by unit [default:
    /// torque_limits with grey_box, literal with other strategies].
    #[arg(long, value_parser = PossibleValuesParser::new(["torque_limits", "literal", "unit_consistent"]))]
    pub bounds: Option<String>,
    /// Phases of the reference trajectory.
    #[arg(long, value_parser = PossibleValuesParser::new(["documented", "random"]))]
    pub phases: Option<String>,
}

/// Arguments of `ask`.
#[derive(Debug, Args)]
pub struct Ask {
    /// Directory of the campaign; one without campaign gets a new one.
    #[arg(value_name = "DIR")]
    pub campaign: PathBuf,
    /// Settings of a new campaign (YAML, schema tribo.tune/1); flags override it.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// What a new campaign is like. A campaign that has begun keeps its settings; only --trials changes it.
    #[command(flatten)]
    pub settings: CampaignSettings,
    /// Length of the run-in at the beginning of every log (s) [default: 3].
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub judged_from: Option<f64>,
    /// Length of the judged motion after it (s) [default: 30].
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub judged: Option<f64>,
    /// Torque of the logs that moved the arm: tau_J_d, tau_J_d of robots that add gravity themselves, or tau_J of the motors
    /// [default: commanded].
    #[arg(long, value_parser = PossibleValuesParser::new(["commanded", "commanded_without_gravity", "measured"]))]
    pub torque: Option<String>,
    /// Do not ask: print the parameters of this running trial once more.
    #[arg(long, value_name = "N")]
    pub trial: Option<usize>,
    /// Ask although nothing is left to gain.
    #[arg(long)]
    pub anyway: bool,
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
    /// The trial [default: the one that is running].
    #[arg(long, value_name = "N")]
    pub trial: Option<usize>,
    /// The trial failed, and why: acceleration, error, joint_limit, joint_speed, torque_saturation, nullspace_runaway, or in your words.
    /// It counts against its parameters, unless REASON is stopped: then somebody stopped it for reasons of their own.
    #[arg(long, value_name = "REASON")]
    pub failed: Option<String>,
    /// Nothing will come of the trial: it counts for nothing.
    #[arg(long, conflicts_with_all = ["log", "failed"])]
    pub give_up: bool,
    /// Take back trial N, which was told: it counts for nothing any more, another may be asked for in its place. The journal keeps what
    /// was told and why it was taken back.
    #[arg(long, value_name = "N", requires = "reason", conflicts_with_all = ["log", "failed", "give_up", "trial"])]
    pub withdraw: Option<usize>,
    /// Why it is taken back, in your words.
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
    /// Noise, and warmth of a truth that warms up, of this trial of a campaign [default: noise of the seed, cold].
    #[arg(long, value_name = "N", conflicts_with = "trajectory")]
    pub trial: Option<usize>,
    /// Compensator: none, oracle, a tuned.yaml, or a model file to believe in.
    #[arg(long, default_value = "none", value_name = "none|oracle|FILE")]
    pub compensation: String,
    /// Multiplies the friction that the compensator believes: 1.5 is half as much again.
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
    /// Push the tool along each axis in turn with this force (N) and --pulse-moment (Nm).
    #[arg(long, value_name = "N", default_value_t = 0.0, allow_negative_numbers = true)]
    pub pulse_force: f64,
    /// Moment of the pulses (Nm).
    #[arg(long, value_name = "NM", default_value_t = 0.0, allow_negative_numbers = true)]
    pub pulse_moment: f64,
    /// Play the motion of --trajectory on a Panda or FR3 at this address instead, and record it. The arm moves.
    #[arg(long, value_name = "HOST", requires_all = ["trajectory", "log"])]
    pub live: Option<String>,
    /// How the live robot is driven.
    #[command(flatten)]
    pub drive: LiveDrive,
}

/// Arguments of `investigate`.
#[derive(Debug, Args)]
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
    /// Model that the robot is held against (YAML, schema tribo.model/1) [default: the bare robot without friction].
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// The robot of --robot-command, when no --model says it: a preset or the path of a URDF with seven joints.
    #[arg(long, value_name = "NAME|URDF", conflicts_with_all = ["model", "live"])]
    pub robot: Option<String>,
    /// Side of the gears of the torque, when no --model says it: of a live robot what its motors were sent (motor), or its sensors (link);
    /// of a command what it logs as tau_J.
    #[arg(long, default_value = "motor", value_parser = PossibleValuesParser::new(["motor", "link"]), conflicts_with = "model")]
    pub torque_side: String,
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

/// Arguments of `estimate`.
#[derive(Debug, Args)]
pub struct Estimate {
    /// The log, in any format that convert reads. Where it has torque on both sides of the gears and no --model is given,
    /// their friction is all that is estimated.
    pub log: PathBuf,
    /// Go on with a log that is refused; what speaks against it is said.
    #[arg(long)]
    pub anyway: bool,
    /// Model of the robot (YAML, schema tribo.model/1) [default: the bare robot without friction].
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// The robot, when no --model says it: a preset or the path of a URDF [default: panda, if the log has 7 joints].
    #[arg(long, value_name = "NAME|URDF", conflicts_with = "model")]
    pub robot: Option<String>,
    /// Side of the gears on which tau_J was measured, when no --model says it.
    #[arg(long, default_value = "motor", value_parser = PossibleValuesParser::new(["motor", "link"]), conflicts_with = "model")]
    pub torque_side: String,
    /// Which estimators to run.
    #[arg(long, default_value = "all", value_parser = PossibleValuesParser::new(["all", "ekf", "momentum", "qp", "thermal", "double_encoder", "torque"]))]
    pub residual: String,
    /// A log of the same robot in motion that nobody touches: friction band, noise and tare of the estimators come from it
    /// [default: the band of the model's friction, the noise of a Panda, no tare].
    #[arg(long, value_name = "LOG")]
    pub free: Option<PathBuf>,
    /// Share of the samples in which a component of the wrench is expected to be touched, above 0: what its interval does not
    /// tell from nothing, stiction of a standing arm above all, is then reported as next to nothing [default: the wrench as
    /// the estimator has it].
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

/// Arguments of `diagnose`.
#[derive(Debug, Args)]
pub struct Diagnose {
    /// The logs of one session, in any format that convert reads.
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// Go on with a log that is refused; what speaks against it is said.
    #[arg(long)]
    pub anyway: bool,
    /// Model that the logs are held against (YAML, schema tribo.model/1) [default: the bare robot without friction; rotors
    /// without inertia where link-side torque was logged too].
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// The robot, when no --model says it: a preset or the path of a URDF [default: panda, if the logs have 7 joints].
    #[arg(long, value_name = "NAME|URDF", conflicts_with = "model")]
    pub robot: Option<String>,
    /// Side of the gears on which tau_J was measured, when no --model says it.
    #[arg(long, default_value = "motor", value_parser = PossibleValuesParser::new(["motor", "link"]), conflicts_with = "model")]
    pub torque_side: String,
    /// Write the model with the findings added (YAML); tune, simulate and estimate read it.
    #[arg(long, value_name = "FILE")]
    pub extend: Option<PathBuf>,
    /// Write a report with all evidence (one HTML file).
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Try the extended model on this log, which no parameter is fitted to; may be repeated.
    #[arg(long, value_name = "LOG")]
    pub validate: Vec<PathBuf>,
    /// A log of the same arm with nothing at the flange; may be repeated. It shares all but the payload with the others, which
    /// tells a payload from heavier links and from torques of another scale.
    #[arg(long, value_name = "UNLOADED")]
    pub reference: Vec<PathBuf>,
    /// Write the via points of the next experiment (YAML, schema tribo.trajectory/1).
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// Simulate what the findings are worth to a controller.
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
    /// The log to read; its format is found from its content: CSV (canonical, libfranka, Kinova Gen3), Parquet, MCAP or the
    /// directory of a rosbag2, the text directory of the public Panda data set.
    pub log: PathBuf,
    /// The log to write: .csv, .csv.gz, .parquet or .mcap.
    pub out: PathBuf,
    /// Whom a CSV file is for: tribo has columns like q_0, plotjuggler a tree like /joint_0/q. Both are read back.
    #[arg(long = "for", value_name = "READER", default_value = "tribo", value_parser = PossibleValuesParser::new(["tribo", "plotjuggler"]))]
    pub reader: String,
}

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct Export {
    /// A campaign directory or a tuned.yaml.
    pub source: PathBuf,
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

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub struct Bench {
    /// The arm: panda, fr3, ur10e, kinova_gen3, iiwa14 or the path of a URDF [default: panda].
    #[arg(long, value_name = "NAME|URDF")]
    pub robot: Option<String>,
    /// Ticks to be timed [default: 1000000].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1000..=100_000_000), conflicts_with = "realtime")]
    pub ticks: Option<u64>,
    /// A few seconds in place of a minute: 30000 ticks, everything else once.
    #[arg(long, conflicts_with = "realtime")]
    pub quick: bool,
    /// Run the loop on the clock for this long (s) instead, with SCHED_FIFO and locked memory where they are permitted.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub realtime: Option<f64>,
    /// Keep every core busy meanwhile.
    #[arg(long, requires = "realtime")]
    pub load: bool,
    /// Missed deadlines in a row at which the loop gives up and sends the safe torque; before, the last command is held.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000), requires = "realtime")]
    pub overruns: u32,
    /// Let the loop stand still once for this long (ms), to see what happens.
    #[arg(long, value_name = "MS", requires = "realtime", allow_negative_numbers = true)]
    pub stall: Option<f64>,
    /// When (s) [default: in the middle].
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
    /// View to begin with.
    #[arg(long, value_parser = PossibleValuesParser::new(["campaign", "trial", "arm", "log", "diagnosis", "compare"]))]
    pub view: Option<String>,
    /// Second campaign directory, of the view `compare`.
    #[arg(long, value_name = "DIR")]
    pub compare: Option<PathBuf>,
    /// Model that a log is held against (YAML, schema tribo.model/1) [default: the bare robot without friction].
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// The robot, when no --model says it: a preset or the path of a URDF [default: panda, if the log has 7 joints].
    #[arg(long, value_name = "NAME|URDF", conflicts_with = "model")]
    pub robot: Option<String>,
    /// Side of the gears on which tau_J was measured, when no --model says it.
    #[arg(long, default_value = "motor", value_parser = PossibleValuesParser::new(["motor", "link"]), conflicts_with = "model")]
    pub torque_side: String,
    /// Draw the view into this PNG and end; needs no display.
    #[arg(long, value_name = "FILE")]
    pub screenshot: Option<PathBuf>,
    /// Size of the picture (px).
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = picture_size)]
    pub size: [usize; 2],
    /// Dark picture.
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
    /// Only the first seeds.
    #[arg(long, value_name = "N")]
    pub seeds: Option<u64>,
    /// Write the results as JSON to this file.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Compare with such a file; exit code 1 if a figure differs by more than it repeats to.
    #[arg(long, value_name = "FILE")]
    pub check: Option<PathBuf>,
}
