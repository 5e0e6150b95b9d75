//! Wrong logs are recognised by physics, and good ones are believed.
//!
//! Logs are simulated by inverse dynamics on five arms, which knows nothing of the regression that judges them. A false alarm costs a user
//! a good log, so none is allowed: not on 200 logs with hidden effects, not on any real log.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

mod good;
mod real;
mod wrong;

use good::good;
use tribo_diagnose::{Diagnosable, recognise::recognise};
use tribo_logs::RobotLog;
use tribo_logs::recognise::{Remark, Severity};

/// Everything that is said of a log.
fn remarks(log: &RobotLog, nominal: &impl Diagnosable) -> Vec<Remark> {
    let mut all = tribo_logs::recognise::recognise(log);
    // What is refused for its own sake is not held against a model.
    if !all.iter().any(|remark| remark.severity == Severity::Refuse) {
        all.extend(recognise(log, nominal));
        all.sort_by_key(|remark| remark.severity == Severity::Warn);
    }
    all
}

#[test]
fn two_hundred_good_logs_are_believed() {
    let mut alarms = Vec::new();
    for seed in 0..40 {
        for name in ["panda", "fr3", "kinova_gen3", "iiwa14"] {
            let good = good::<7>(name, seed);
            alarms.extend(
                remarks(&good.log, &good.nominal).iter().map(|remark| format!("{}: {remark}", good.description)),
            );
        }
        let good = good::<6>("ur10e", seed);
        alarms.extend(remarks(&good.log, &good.nominal).iter().map(|remark| format!("{}: {remark}", good.description)));
    }
    assert!(alarms.is_empty(), "{} of 200:\n{}", alarms.len(), alarms.join("\n"));
}
