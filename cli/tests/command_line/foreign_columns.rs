//! Story: somebody's log has columns of its own names, units and signs, and every command reads it all the same.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::fs;

use serde_json::json;
use tribo_logs::{LogColumns, RobotLog, read_log, write_csv};

use crate::common::{run, scratch};

/// A log of the simulated Panda, with what the other program knows too.
fn simulated(at: &std::path::Path) -> RobotLog {
    run(at, "simulate --log whole.csv --quiet").ok();
    let whole = read_log(at.join("whole.csv")).unwrap().0.into_columns();
    let log = LogColumns { tau_j_d_nm: None, tau_friction_nm: None, o_f_ext: None, ..whole }.validate().unwrap();
    write_csv(at.join("log.csv"), &log).unwrap();
    log
}

/// The log as another program writes it: degrees, milliseconds, joint 3 turned, torques in mNm.
fn foreign(log: &RobotLog) -> String {
    let mut text = "stamp".to_owned();
    for stem in ["pos", "vel", "eff"] {
        (1..=7).for_each(|j| text += &format!(";{stem}_{j}"));
    }
    for k in 0..log.rows() {
        text += &format!("\n{}", log.time_s[k] * 1e3);
        for (columns, factor) in
            [(&log.q_rad, 180.0 / std::f64::consts::PI), (&log.dq_rad_s, 1.0), (&log.tau_j_nm, 1e3)]
        {
            for (j, column) in columns.iter().enumerate() {
                let sign = if j == 2 && factor != 1.0 { -1.0 } else { 1.0 };
                text += &format!(";{}", sign * factor * column[k]);
            }
        }
    }
    text + "\n"
}

#[test]
fn a_log_of_other_columns_is_diagnosed_as_ours_is() {
    let at = scratch();
    let log = simulated(at.path());
    fs::write(at.path().join("mine.csv"), foreign(&log)).unwrap();
    let map = "time: stamp[ms]\nq: {columns: 'pos_{joint}', unit: deg, sign: [1, 1, -1, 1, 1, 1, 1]}\ndq: vel_{joint}\n\
               tau: {columns: 'eff_{joint}', unit: mNm, sign: [1, 1, -1, 1, 1, 1, 1]}\n";
    fs::write(at.path().join("map.yaml"), map).unwrap();
    let ours = run(at.path(), "diagnose log.csv --json --quiet").ok().json();
    let theirs = run(at.path(), "diagnose mine.csv --map map.yaml --json").ok();
    assert!(!theirs.stderr.contains("read as"), "who gave a map needs no line: {}", theirs.stderr);
    let theirs = theirs.json();
    // Two of nearly the same evidence may change places.
    let labels = |document: &serde_json::Value| -> Vec<String> {
        let findings = document["findings"].as_array().unwrap().iter();
        let mut labels: Vec<String> =
            findings.map(|finding| format!("{} {}", finding["label"], finding["joint"])).collect();
        labels.sort();
        labels
    };
    assert_eq!(labels(&theirs), labels(&ours));
    assert!(!labels(&ours).is_empty());
    let (got, expected) = (theirs["gain_heldout"].as_f64().unwrap(), ours["gain_heldout"].as_f64().unwrap());
    // Degrees and back are 1e-15 off, of which the search for causes makes 2e-4.
    assert!((got - expected).abs() < 5e-3, "{got} {expected}");
    let read_as = &theirs["logs"][0]["read_as"];
    assert_eq!(read_as["columns"][3], json!({"column": "q_2", "from": "pos_3", "unit": "deg"}));
    assert_eq!(ours["logs"][0]["read_as"], json!(null));
    let torque = run(at.path(), "estimate mine.csv --map map.yaml --residual torque --json --quiet").ok().json();
    assert_eq!(torque["log"]["read_as"]["joints"], "joints numbered from 1");
}

#[test]
fn names_are_taken_at_their_word_aloud_or_the_log_is_refused_with_the_way_out() {
    let at = scratch();
    let rows = |header: &str| format!("{header}\n0,1,2,3,4\n0.01,1.1,2,3,4\n0.02,1.2,2,3,4\n");
    fs::write(at.path().join("plain.csv"), rows("t,position_0,velocity_0,effort_0,note")).unwrap();
    let run_of = run(at.path(), "convert plain.csv out.csv --json").ok();
    let line = "tribo: plain.csv: read as time=t,q=position_{joint},dq=velocity_{joint},tau=effort_{joint}; joints numbered from 0; give --map to change it";
    assert!(run_of.stderr.contains(line), "{}", run_of.stderr);
    assert_eq!(run_of.json()["read_as"]["proposed"], true);
    assert_eq!(run_of.json()["unknown_columns"], json!(["note"]));
    assert!(run(at.path(), "convert plain.csv out.csv --quiet").ok().stderr.is_empty());

    fs::write(at.path().join("two.csv"), rows("t,position_0,velocity_0,effort_0,effort_cmd_0")).unwrap();
    let refused = run(at.path(), "convert two.csv none.csv");
    assert_eq!(refused.code, Some(2));
    let way_out = "--map 'time=t,q=position_{joint},dq=velocity_{joint},tau=effort_{joint},tau_d=effort_cmd_{joint}'";
    assert!(refused.stderr.contains(way_out), "{}", refused.stderr);
    assert!(!at.path().join("none.csv").exists());
    let taken = run(at.path(), "convert two.csv out.csv --map tau=effort_{joint} --json").ok().json();
    assert_eq!(taken["read_as"]["map"], "time=t,q=position_{joint},dq=velocity_{joint},tau=effort_{joint}");
    for (map, expected) in [
        ("tau=effort_{joint}[lb]", "unit `lb` is not known; allowed for tau_J_i: Nm, mNm, A*CONSTANT"),
        ("none.yaml", "none.yaml: no such file or directory"),
        ("q=a,q=b", "q is given twice"),
    ] {
        let refused = run(at.path(), &format!("convert two.csv none.csv --map {map}"));
        assert_eq!(refused.code, Some(2));
        assert!(refused.stderr.contains(expected), "{}", refused.stderr);
    }
}
