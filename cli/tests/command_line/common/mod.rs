//! The harness of the stories: the real binary in a directory of its own, and its journal read back.
//!
//! `TRIBO_BIN` puts another binary in the place of the one that cargo built, to show that the stories can fail.

#![allow(clippy::unwrap_used, clippy::panic, reason = "test helpers")]

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

/// A call of the binary in directory `at`, standard input closed.
pub fn tribo(at: &Path, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
    let binary = std::env::var_os("TRIBO_BIN").unwrap_or_else(|| env!("CARGO_BIN_EXE_tribo").into());
    let mut command = Command::new(binary);
    command.current_dir(at).args(arguments).stdin(Stdio::null());
    command
}

/// What a call left on its streams.
#[derive(Debug)]
pub struct Run {
    /// Exit code; none if a signal killed it.
    pub code: Option<i32>,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Run {
    /// The run, which must have exit code 0.
    #[track_caller]
    pub fn ok(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }

    /// Standard output as one JSON document.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}

/// Runs `tribo` with a line of arguments (no spaces inside an argument) in directory `at`.
pub fn run(at: &Path, arguments: &str) -> Run {
    tribo(at, arguments.split_whitespace()).output().unwrap().into()
}

/// Starts `tribo` without waiting, both streams piped.
pub fn start(at: &Path, arguments: &str) -> Child {
    let mut command = tribo(at, arguments.split_whitespace());
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// An empty directory that goes away with the value.
pub fn scratch() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// Says that a story was not told, past the capture of the test harness.
#[allow(clippy::explicit_write, reason = "eprintln! is captured, this is not")]
pub fn skipped(why: &str) {
    writeln!(std::io::stderr(), "SKIPPED: {why}").unwrap();
}

/// Whether a Slurm cluster can be started here.
///
/// # Errors
/// Why not.
pub fn slurm_can_start() -> Result<(), &'static str> {
    // Without a cluster sbatch fails even to say its version; that it starts is enough.
    let is_there = |program: &&str| Command::new(program).arg("-V").output().is_ok();
    if !["slurmctld", "slurmd", "sbatch", "munged"].iter().all(is_there) {
        return Err("no slurm-wlm or munge here");
    }
    let user = Command::new("id").arg("-u").output().unwrap();
    if String::from_utf8_lossy(&user.stdout).trim() == "0" { Ok(()) } else { Err("slurmd needs root") }
}

/// Waits until `reached`, for at most a minute.
#[track_caller]
pub fn wait_until(what: &str, mut reached: impl FnMut() -> bool) {
    let started = Instant::now();
    while !reached() {
        assert!(started.elapsed() < Duration::from_secs(60), "never happened: {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The document of `tune --json` without its only varying part, the time it took; as text, so that every bit counts.
pub fn result(document: &Value) -> String {
    let mut document = document.clone();
    document.as_object_mut().unwrap().remove("wall_s").unwrap();
    document.to_string()
}

/// One trial of a journal. Numbers are kept as their text, so that equality is equality of bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trial {
    /// Value of each parameter.
    pub params: BTreeMap<String, String>,
    /// Distribution of each parameter.
    pub distributions: BTreeMap<String, String>,
    /// User attributes.
    pub attributes: BTreeMap<String, String>,
    /// State and values, once ended.
    pub end: Option<(u64, String)>,
}

/// Complete lines of a campaign's journal; none if it has no journal yet.
pub fn journal_lines(campaign: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(campaign.join("journal.log")).unwrap_or_default();
    let whole = text.rfind('\n').map_or(0, |last| last + 1);
    text[..whole].lines().map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}"))).collect()
}

/// The trials of a campaign's journal, by number.
pub fn journal(campaign: &Path) -> Vec<Trial> {
    let mut trials: Vec<Trial> = Vec::new();
    for line in journal_lines(campaign) {
        let op_code = line["op_code"].as_u64().unwrap();
        if op_code == 4 {
            trials.push(Trial::default());
        }
        let Some(trial) = line["trial_id"].as_u64().map(|number| &mut trials[number as usize]) else {
            continue;
        };
        assert_eq!(trial.end, None, "a line about a trial that has ended: {line}");
        match op_code {
            5 => {
                let name = line["param_name"].as_str().unwrap().to_owned();
                trial.distributions.insert(name.clone(), line["distribution"].as_str().unwrap().to_owned());
                let before = trial.params.insert(name, line["param_value_internal"].to_string());
                assert_eq!(before, None, "a parameter set twice: {line}");
            }
            6 => trial.end = Some((line["state"].as_u64().unwrap(), line["values"].to_string())),
            8 => {
                let attributes = line["user_attr"].as_object().unwrap();
                trial.attributes.extend(attributes.iter().map(|(key, value)| (key.clone(), value.to_string())));
            }
            other => panic!("op_code {other}: {line}"),
        }
    }
    trials
}

/// Number of trials that have ended: complete lines with op_code 6.
pub fn finished(campaign: &Path) -> usize {
    let text = std::fs::read_to_string(campaign.join("journal.log")).unwrap_or_default();
    text.split_inclusive('\n').filter(|line| line.starts_with("{\"op_code\":6,") && line.ends_with('\n')).count()
}

/// Path of the log of a trial.
pub fn trial_log(campaign: &Path, number: usize) -> PathBuf {
    campaign.join(format!("trials/{number:04}.parquet"))
}

/// Every file and directory below `root` with its content, by relative path.
pub fn snapshot(root: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut directories = vec![root.to_owned()];
    while let Some(directory) = directories.pop() {
        for entry in std::fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            let content = if path.is_dir() { Vec::new() } else { std::fs::read(&path).unwrap() };
            found.insert(path.strip_prefix(root).unwrap().to_owned(), content);
            if path.is_dir() {
                directories.push(path);
            }
        }
    }
    found
}

/// Names below `root` that no finished campaign has.
pub fn strangers(root: &Path) -> Vec<PathBuf> {
    let known = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy();
        let number = name.strip_suffix(".parquet").is_some_and(|number| number.parse::<usize>().is_ok());
        number
            || matches!(
                &*name,
                "campaign.yaml"
                    | "journal.log"
                    | "references.yaml"
                    | "early_stop.yaml"
                    | "tuned.yaml"
                    | "report.html"
                    | "trials"
            )
    };
    snapshot(root).into_keys().filter(|path| !known(path)).collect()
}

/// Copies a directory and all in it.
pub fn copy_directory(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for (path, content) in snapshot(from) {
        if from.join(&path).is_dir() {
            std::fs::create_dir_all(to.join(path)).unwrap();
        } else {
            std::fs::create_dir_all(to.join(&path).parent().unwrap()).unwrap();
            std::fs::write(to.join(path), content).unwrap();
        }
    }
}

/// Every number is one and is finite.
pub fn number(value: &Value) -> f64 {
    value.as_f64().filter(|x| x.is_finite()).unwrap_or_else(|| panic!("{value} is no number"))
}
