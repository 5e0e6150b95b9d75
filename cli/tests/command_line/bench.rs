//! `tribo bench`: the document, the loop on the clock, refusals. Times themselves are the computer's affair.

use crate::common::{run, scratch};

#[test]
fn the_document_has_its_keys() {
    let at = scratch();
    let document = run(at.path(), "bench --quick --ticks 2000 --robot ur10e --json").ok().json();
    assert_eq!(document["schema"], "tribo.bench/1");
    assert_eq!((&document["robot"], &document["ticks"]), (&"ur10e".into(), &2000.into()));
    for key in ["mean", "p50", "p99", "p999", "max"] {
        for histogram in ["tick_us", "tick_itself_us", "tick_with_plant_us", "plant_us"] {
            assert!(document[histogram][key].as_f64().is_some_and(|us| us > 0.0), "{histogram} {key}");
        }
        let least_of_three = &document["tick_itself_us"][key];
        assert!(least_of_three.as_f64() <= document["tick_us"][key].as_f64(), "one of the three is `tick_us`: {key}");
    }
    let tick = &document["tick_us"];
    assert!(tick["p50"].as_f64() <= tick["p99"].as_f64() && tick["p999"].as_f64() <= tick["max"].as_f64());
    for key in [
        "rnea_ns",
        "crba_ns",
        "aba_ns",
        "jacobian_ns",
        "ekf_us",
        "qp_us",
        "qp_interval_us",
        "trial_s",
        "realtime_factor",
        "gp_fit_ms",
        "bo_suggest_ms",
    ] {
        assert!(document[key].as_f64().is_some_and(|value| value > 0.0), "{key}");
    }
    let answer = document["verdict"]["answer"].as_str().expect("an answer");
    assert!(["fit with reserve", "fit for 1 kHz", "not fit"].contains(&answer), "{answer}");
    assert!(document["verdict"]["because"].as_str().is_some_and(|because| because.contains("99.9 %")));
}

/// However busy the computer: a stall of 20 periods is seen, stops the loop, and leaves the arm standing.
#[test]
fn a_stall_stops_the_loop_and_the_arm_is_safe() {
    let at = scratch();
    let document = run(at.path(), "bench --realtime 2 --stall 20 --stall-at 0.8 --load --check --json").ok().json();
    let run = &document["realtime"];
    let number = |key: &str| run[key].as_u64().expect("a number");
    assert!(number("missed") >= 20 && number("missed_in_a_row") >= 20, "{run}");
    assert!(number("periods") >= 2000 && number("periods") >= number("ticks"), "{run}");
    let ticks: u64 =
        run["response_counts"].as_array().expect("classes").iter().filter_map(|count| count.as_u64()).sum();
    assert_eq!(ticks, number("ticks"));
    let after = &run["after_fault"];
    assert_eq!(after["safe"], true, "{after}");
    assert!(after["at_s"].as_f64().is_some_and(|at_s| at_s <= 0.83), "the stall at the latest: {after}");
    assert_eq!(run["verdict"]["answer"], "not fit");
}

/// Missed deadlines fail the check, unless they are on purpose.
#[test]
fn check_is_about_missed_deadlines() {
    let at = scratch();
    let run = run(at.path(), "bench --realtime 1 --check --json");
    let missed = run.stdout.contains("\"answer\": \"not fit\"");
    assert_eq!(run.code, Some(i32::from(missed)), "{}", run.stderr);
}
