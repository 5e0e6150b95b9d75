//! Story: somebody reruns an experiment by its number and compares with what ships.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use crate::common::{run, scratch};

/// Experiment 04 is a second a seed; 03 takes half a minute and is checked by hand.
#[test]
fn the_shipped_result_is_met_and_another_is_not() {
    let at = scratch();
    let shipped = include_str!("../../../experiments/04_simoni2019/expected.json");
    std::fs::write(at.path().join("e.json"), shipped).unwrap();
    let answer = run(at.path(), "reproduce 04 --seeds 1 --check e.json").ok();
    assert!(answer.stdout.contains("unexplained variance, 273 min, with temperature"), "{}", answer.stdout);
    let by_name = run(at.path(), "reproduce simoni2019 --seeds 1 --json").ok();
    assert_eq!(by_name.json()["runs"][0]["seed"], 1);

    let first = by_name.json()["runs"][0]["values"][4].to_string();
    assert!(shipped.contains(&first));
    std::fs::write(at.path().join("f.json"), shipped.replace(&first, "-0.02")).unwrap();
    let refused = run(at.path(), "reproduce 04 --seeds 1 --check f.json");
    assert_eq!(refused.code, Some(1));
    assert!(refused.stderr.contains("seed 1: alpha"), "{}", refused.stderr);
}
