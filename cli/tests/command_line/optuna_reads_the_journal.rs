//! Story: journal.log is an Optuna journal, so optuna-dashboard and every other tool of that world opens a campaign.
//!
//! Two witnesses: the format, line by line, always; and Optuna's own loader, where a Python with `optuna` is found
//! (`TRIBO_PYTHON`, else `python3` on the path). The law of the format, for trial k and parameter p:
//!
//! ```text
//! 0 create study | 2 (attribute of the study) | 4 create trial | 5 (k, p, value, FloatDistribution{low, high}) | 8 (k, attribute) | 6 end (k, [J])
//! ```

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::io::Write;
use std::path::Path;
use std::process::Command;

use crate::common::{journal_lines, run, scratch};
use crate::python_witness::python;
use serde_json::Value;

/// A campaign whose trials run side by side, with the law that has most parameters.
const TUNE: &str = "tune --trials 6 --init 4 --strategy paper --friction stribeck --seed 31 --threads 2 --json --out c";
/// Seven joints, five parameters.
const PARAMETERS: usize = 35;

/// 2026-01-31T12:34:56.123456+00:00, what Python's `datetime.isoformat` writes and `fromisoformat` reads.
fn is_iso_datetime(text: &str) -> bool {
    const PATTERN: &str = "dddd-dd-ddTdd:dd:dd.dddddd+00:00";
    let fits = |(c, p): (char, char)| if p == 'd' { c.is_ascii_digit() } else { c == p };
    text.len() == PATTERN.len() && text.chars().zip(PATTERN.chars()).all(fits)
}

/// Keys of a record, sorted.
fn keys(record: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = record.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

#[test]
fn every_line_keeps_the_format() {
    let at = scratch();
    let result = run(at.path(), TUNE).ok().json();
    let text = std::fs::read_to_string(at.path().join("c/journal.log")).unwrap();
    assert!(text.ends_with('\n') && !text.contains("\n\n"));
    let lines = journal_lines(&at.path().join("c"));

    let (mut created, mut ended) = (0, vec![None; 6]);
    let mut values = vec![Vec::new(); 6];
    for (index, line) in lines.iter().enumerate() {
        let trial = || {
            let trial = line["trial_id"].as_u64().unwrap() as usize;
            assert!(trial < created, "trial {trial} comes before it is created: {line}");
            trial
        };
        assert_eq!(line["worker_id"], "tribo");
        match line["op_code"].as_u64().unwrap() {
            0 => {
                assert_eq!(index, 0);
                assert_eq!(keys(line), ["directions", "op_code", "study_name", "worker_id"]);
                assert_eq!((&line["study_name"], &line["directions"]), (&"tribo".into(), &vec![1].into()));
            }
            2 => {
                assert_eq!(keys(line), ["op_code", "study_id", "user_attr", "worker_id"]);
                assert_eq!((&line["study_id"], line["user_attr"].as_object().unwrap().len()), (&0.into(), 1));
                let attributes = &line["user_attr"];
                match keys(attributes).as_slice() {
                    [name] if *name == "settings" => assert_eq!(attributes["settings"]["strategy"], "paper"),
                    // After every batch: what the trials that have ended by then amount to.
                    _ => assert_eq!(attributes["conclusion"]["trials"], ended.iter().flatten().count(), "{line}"),
                }
            }
            4 => {
                assert_eq!(keys(line), ["datetime_start", "op_code", "study_id", "worker_id"]);
                assert_eq!(line["study_id"], 0);
                assert!(is_iso_datetime(line["datetime_start"].as_str().unwrap()), "{line}");
                created += 1;
            }
            5 => {
                let wanted = ["distribution", "op_code", "param_name", "param_value_internal", "trial_id", "worker_id"];
                assert_eq!(keys(line), wanted);
                let value = line["param_value_internal"].as_f64().unwrap();
                let distribution: Value = serde_json::from_str(line["distribution"].as_str().unwrap()).unwrap();
                assert_eq!(distribution["name"], "FloatDistribution");
                let attributes = &distribution["attributes"];
                assert_eq!(keys(attributes), ["high", "log", "low", "step"]);
                assert_eq!((&attributes["log"], &attributes["step"]), (&false.into(), &Value::Null));
                let (low, high) = (attributes["low"].as_f64().unwrap(), attributes["high"].as_f64().unwrap());
                assert!(low < high && (low..=high).contains(&value), "{line}");
                values[trial()].push((line["param_name"].as_str().unwrap().to_owned(), value));
            }
            8 => {
                assert_eq!(keys(line), ["op_code", "trial_id", "user_attr", "worker_id"]);
                assert_eq!(line["user_attr"].as_object().unwrap().len(), 1);
                assert_eq!(ended[trial()], None);
            }
            6 => {
                assert_eq!(keys(line), ["datetime_complete", "op_code", "state", "trial_id", "values", "worker_id"]);
                assert_eq!(line["state"], 1);
                assert!(is_iso_datetime(line["datetime_complete"].as_str().unwrap()), "{line}");
                let number = trial();
                assert_eq!(ended[number].replace(line["values"][0].as_f64().unwrap()), None, "ended twice: {line}");
            }
            other => panic!("op_code {other}: {line}"),
        }
    }

    // What the journal says is what the command printed.
    assert_eq!(created, 6);
    for (number, trial) in result["trials"].as_array().unwrap().iter().enumerate() {
        assert_eq!(ended[number], trial["cost"].as_f64());
        assert_eq!(values[number], parameters(trial));
    }
}

/// The parameters of a trial in the document of `tune`, by their names in the journal.
fn parameters(trial: &Value) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    for (joint, values) in trial["params"].as_object().unwrap() {
        for (name, value) in values.as_object().unwrap() {
            found.push((format!("{joint}.{name}"), value.as_f64().unwrap()));
        }
    }
    assert_eq!(found.len(), PARAMETERS);
    found
}

/// Loads the study with Optuna's storage and prints what it found as JSON.
const LOADER: &str = r#"
import json, sys, optuna
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend
optuna.logging.set_verbosity(optuna.logging.ERROR)
study = optuna.load_study(study_name=None, storage=JournalStorage(JournalFileBackend(sys.argv[1])))
print(json.dumps({
    "version": optuna.__version__,
    "name": study.study_name,
    "direction": study.direction.name,
    "best": study.best_trial.number,
    "attributes": study.user_attrs,
    "trials": [{
        "number": t.number,
        "state": t.state.name,
        "value": t.value,
        "params": t.params,
        "distributions": {k: [type(d).__name__, d.low, d.high] for k, d in t.distributions.items()},
        "attributes": sorted(t.user_attrs),
        "lasted_s": t.duration.total_seconds() if t.duration else None,
    } for t in study.get_trials()],
}))
"#;

fn load(python: &str, journal: &Path) -> Value {
    let output = Command::new(python).args(["-c", LOADER]).arg(journal).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn optunas_own_loader_finds_every_trial() {
    let Some(python) = python("optuna", "Optuna's loader is UNTESTED on journal.log") else { return };
    let at = scratch();
    let result = run(at.path(), TUNE).ok().json();
    let study = load(&python, &at.path().join("c/journal.log"));
    writeln!(std::io::stderr(), "optuna {} loads journal.log", study["version"]).unwrap();
    assert_eq!((&study["name"], &study["direction"]), (&"tribo".into(), &"MINIMIZE".into()));
    let trials = study["trials"].as_array().unwrap();
    assert_eq!(trials.len(), 6);
    for (number, (read, written)) in trials.iter().zip(result["trials"].as_array().unwrap()).enumerate() {
        assert_eq!((&read["number"], &read["state"]), (&number.into(), &"COMPLETE".into()));
        assert_eq!(read["value"].as_f64(), written["cost"].as_f64());
        assert!(read["lasted_s"].as_f64().unwrap() > 0.0, "{read}");
        assert_eq!(
            read["attributes"].to_string(),
            r#"["aborted","aborted_at_s","log_seal","max","mean","origin","penalty"]"#
        );
        assert_eq!(read["params"].as_object().unwrap().len(), PARAMETERS);
        for (name, value) in parameters(written) {
            assert_eq!(read["params"][&name].as_f64(), Some(value), "{name} of trial {number}");
            let distribution = &read["distributions"][&name];
            assert_eq!(distribution[0], "FloatDistribution");
            let (low, high) = (distribution[1].as_f64().unwrap(), distribution[2].as_f64().unwrap());
            assert!(low <= value && value <= high, "{name}: {distribution}");
        }
    }
    // Optuna's best is the luckiest trial; ours is the one expected to cost least, and never one that was aborted.
    let costs: Vec<f64> = trials.iter().map(|trial| trial["value"].as_f64().unwrap()).collect();
    let luckiest = (0..costs.len()).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap();
    assert_eq!(study["best"], luckiest);
}

/// A trial that was taken back stays what it was; that it counts no more is an attribute of the study.
#[test]
fn optuna_reads_that_a_trial_was_taken_back() {
    let Some(python) = python("optuna", "Optuna's loader is UNTESTED on a trial taken back") else { return };
    let at = scratch();
    for call in [
        "ask c --strategy sobol --trials 3 -q",
        "tell c --failed e-stop -q",
        "ask c --trials 4 -q",
        "tell c --withdraw 0 --reason wrong_tool -q",
    ] {
        run(at.path(), call).ok();
    }
    let study = load(&python, &at.path().join("c/journal.log"));
    let attributes = &study["attributes"];
    assert_eq!((&attributes["trials"], &attributes["withdrawn_0"]["reason"]), (&4.into(), &"wrong_tool".into()));
    assert_eq!(attributes["settings"]["strategy"], "sobol");
    let states: Vec<&Value> = study["trials"].as_array().unwrap().iter().map(|trial| &trial["state"]).collect();
    assert_eq!(states, ["COMPLETE", "RUNNING"]);
}

/// A journal cut in the middle of a trial, as a kill leaves it, opens too: the trial is running.
#[test]
fn optuna_opens_a_journal_that_was_killed() {
    let Some(python) = python("optuna", "Optuna's loader is UNTESTED on a cut journal") else { return };
    let at = scratch();
    run(at.path(), "tune --trials 2 --strategy grey_box --quiet --out c").ok();
    let path = at.path().join("c/journal.log");
    let text = std::fs::read_to_string(&path).unwrap();
    // Before the line that ends trial 1: after it stands the conclusion of the finished campaign.
    let (end, _) = text.match_indices("\n{\"op_code\":6,").nth(1).unwrap();
    std::fs::write(&path, &text[..=end]).unwrap();
    let states: Vec<String> =
        load(&python, &path)["trials"].as_array().unwrap().iter().map(|trial| trial["state"].to_string()).collect();
    assert_eq!(states, [r#""COMPLETE""#, r#""RUNNING""#]);
}
