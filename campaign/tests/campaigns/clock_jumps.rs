//! Story: the clock of the computer is set back and forth while a campaign runs. Only the times of day in its journal change.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::sync::atomic::{AtomicU64, Ordering};

use tribo_campaign::{Campaign, Changes, TuneConfig};

fn steady() -> String {
    "2026-01-01T12:00:00.000000".to_owned()
}

/// A year on, a year back, over and over; now and then no time at all.
fn jumping() -> String {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    match CALLS.fetch_add(1, Ordering::Relaxed) % 3 {
        0 => "2027-01-01T12:00:00.000000".to_owned(),
        1 => "1970-01-01T00:00:00.000000".to_owned(),
        _ => String::new(),
    }
}

#[test]
fn results_do_not_depend_on_the_clock() {
    let at = tempfile::tempdir().unwrap();
    let config = TuneConfig { trials: 3, ..TuneConfig::default() };
    let tune = || config.clone().validate::<7>().unwrap();
    let (one, other) = (at.path().join("one"), at.path().join("other"));
    let whole = Campaign::create(&one, tune(), steady).unwrap().run(&mut ()).unwrap();

    let short = TuneConfig { trials: 2, ..config.clone() }.validate::<7>().unwrap();
    Campaign::create(&other, short, jumping).unwrap().run(&mut ()).unwrap();
    let resumed = Campaign::<7>::resume(&other, Changes { trials: Some(3), ..Changes::default() }, jumping)
        .unwrap()
        .run(&mut ())
        .unwrap();
    assert_eq!(resumed.trials, whole.trials);
    assert_eq!(resumed.conclusion.best, whole.conclusion.best);
    for name in ["tuned.yaml", "references.yaml", "trials/0002.parquet"] {
        assert!(std::fs::read(one.join(name)).unwrap() == std::fs::read(other.join(name)).unwrap(), "{name}");
    }
}
