//! Story: the log of a trial is a robot log, which every command reads that reads logs.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use crate::common::{run, scratch};

/// Largest difference of the dry friction of a joint (Nm) between what campaign and diagnosis find in the same arm: one reads the wrench of
/// 7 joints together, the other each joint's torque.
const SAME_NM: f64 = 0.15;

#[test]
fn a_trial_is_converted_estimated_and_diagnosed() {
    let at = scratch();
    run(at.path(), "tune --trials 3 --out c -q").ok();
    run(at.path(), "convert c/trials/0001.parquet log.csv -q").ok();
    let text = std::fs::read_to_string(at.path().join("log.csv")).unwrap();
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    assert_eq!((header[0], header[1], header[8], header[15]), ("time", "q_0", "dq_0", "tau_J_0"));
    assert_eq!(header[22..], [0, 1, 2, 3, 4, 5, 6].map(|j| format!("tau_friction_{j}")));

    let wrench = run(at.path(), "estimate c/trials/0001.parquet --robot panda --residual momentum --json").ok().json();
    assert_eq!(wrench["schema"], "tribo.estimate/1", "{wrench}");

    // What its reader noticed of a log stands in the answer, not on the terminal alone.
    std::fs::write(at.path().join("cut.csv"), text.trim_end()).unwrap();
    let noted = run(at.path(), "diagnose cut.csv --robot panda --json -q").ok().json();
    let note = noted["notes"][0].as_str().unwrap();
    assert!(note.starts_with("cut.csv: line ") && note.contains("has no line ending"), "{note}");

    // Two ways from the same friction to its size.
    let tuned = run(at.path(), "export c --format json -q").ok().stdout;
    let tuned: serde_json::Value = serde_json::from_str(&tuned).unwrap();
    let found = run(at.path(), "diagnose c/trials/0000.parquet --robot panda --json").ok().json();
    let coulomb = found["findings"].as_array().unwrap().iter().find(|finding| finding["label"] == "coulomb").unwrap();
    let joints: Vec<u64> = serde_json::from_value(coulomb["joints"].clone()).unwrap();
    assert_eq!(joints, [0, 1, 2, 3, 4, 5, 6]);
    for joint in 0..7 {
        let diagnosed = coulomb["params"]["delta_coulomb_nm"][joint].as_f64().unwrap();
        let tuned = tuned["friction"]["joints"][joint]["coulomb_nm"].as_f64().unwrap();
        assert!((diagnosed - tuned).abs() < SAME_NM, "joint {joint}: {diagnosed} Nm, {tuned} Nm");
    }
}
