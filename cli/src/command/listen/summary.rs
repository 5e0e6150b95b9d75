//! What was heard, at the end.

use serde_json::{Value, json};
use tribo_ros2::{Counts, ListenSettings, Listened};

use crate::arguments::Common;
use crate::output::{fixed, print, print_json, table};

/// Prints it.
pub fn show(listened: &Listened, settings: &ListenSettings, common: &Common) {
    if common.json {
        print_json(&json(listened, settings));
    } else if !common.quiet {
        rows(listened);
    }
}

/// `tribo.listen/1`.
fn json(listened: &Listened, settings: &ListenSettings) -> Value {
    let Counts { received, used, incomplete, not_later, unusable, lost, gaps, restarts, faults, published, unsent } =
        listened.counts;
    let (age, took) = latencies(listened);
    let times = |times: Option<[f64; 3]>| times.map(|[p50, p99, max]| json!({ "p50": p50, "p99": p99, "max": max }));
    json!({
        "schema": "tribo.listen/1",
        "robot": settings.robot,
        "estimator": settings.estimator,
        "frame_id": settings.frame_id,
        "duration_s": listened.duration_s,
        "period_s": listened.period_s,
        "received": received,
        "used": used,
        "published": published,
        "lost": lost,
        "not_later": not_later,
        "incomplete": incomplete,
        "unusable": unusable,
        "gaps": gaps,
        "restarts": restarts,
        "faults": faults,
        "unsent": unsent,
        "stamp_to_wrench_ms": times(age),
        "taken_to_wrench_ms": times(took),
        "record": settings.record.as_ref().map(|path| path.display().to_string()),
    })
}

/// Median, 99th percentile and longest (ms), from the stamp and from when a message was taken.
fn latencies(listened: &Listened) -> (Option<[f64; 3]>, Option<[f64; 3]>) {
    let Some(ages) = &listened.ages else { return (None, None) };
    let of = |times: &tribo_runtime::LatencyHistogram| {
        let ms = [times.quantile_us(0.5), times.quantile_us(0.99), times.max_us()].map(|us| us * 1e-3);
        (times.count() > 0).then_some(ms)
    };
    (of(&ages.stamp_to_wrench), of(&ages.taken_to_wrench))
}

fn rows(listened: &Listened) {
    let counts = &listened.counts;
    let mut rows = table(&["", ""]);
    for (name, count) in [
        ("joint states", counts.received),
        ("wrenches", counts.published),
        ("lost on the way", counts.lost),
        ("not later than the one before", counts.not_later),
        ("without the arm's joints", counts.incomplete),
        ("unusable", counts.unusable),
        ("gaps", counts.gaps + counts.restarts),
        ("faults of the estimator", counts.faults),
        ("not sent", counts.unsent),
    ] {
        rows.add_row([name.to_owned(), count.to_string()]);
    }
    let (age, took) = latencies(listened);
    for (name, times) in [("from stamp to wrench", age), ("from arrival to wrench", took)] {
        if let Some([p50, p99, max]) = times {
            let of = |ms: f64| fixed(ms, 3);
            rows.add_row([
                format!("{name} [ms]: median, 99 %, longest"),
                format!("{}, {}, {}", of(p50), of(p99), of(max)),
            ]);
        }
    }
    print(rows);
}
