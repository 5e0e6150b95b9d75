//! Story: the answer names the experiment that would tell more, and it is made. What the arm does in it, most joints held while one
//! moves, must not become a cause.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::collections::BTreeSet;
use std::path::Path;

use crate::common::{run, scratch};

#[test]
fn the_advised_experiment_adds_no_cause_that_is_not_there() {
    let at = scratch();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments/06_diagnosis/example");
    for name in ["robot.yaml", "nominal.yaml", "trajectory.yaml"] {
        std::fs::copy(example.join(name), at.path().join(name)).unwrap();
    }
    run(at.path(), "simulate --truth robot.yaml --trajectory trajectory.yaml --log log.csv -q").ok();
    run(at.path(), "diagnose log.csv --model nominal.yaml --trajectory next.yaml -q").ok();
    run(at.path(), "simulate --truth robot.yaml --trajectory next.yaml --log next.csv -q").ok();
    let both = run(at.path(), "diagnose log.csv next.csv --model nominal.yaml --json -q").ok().json();
    let findings = both["findings"].as_array().unwrap();
    let found: BTreeSet<(&str, Option<u64>)> =
        findings.iter().map(|finding| (finding["label"].as_str().unwrap(), finding["joint"].as_u64())).collect();
    let hidden = [("payload", None), ("coulomb", Some(2)), ("torque_offset", Some(4))];
    assert_eq!(found, BTreeSet::from(hidden), "{both:#}");
}
