//! `tribo bench`.

use std::time::Duration;

use serde_json::json;
use tribo_bench::{
    BenchReport, BenchSettings, Fitness, OverrunPolicy, Percentiles, RealTimeReport, RealTimeSettings, Rights, Stall,
    Verdict, any_bench, any_real_time,
};
use tribo_campaign::{AnyTune, TuneConfig};

use crate::arguments::{Bench, Common};
use crate::failure::{BadInput, CheckFailed};
use crate::output::{print, print_json, significant, table};

/// Longest run on the clock (s): a day.
const LONGEST_S: f64 = 86_400.0;
/// Longest delay on purpose (ms).
const LONGEST_STALL_MS: f64 = 10_000.0;

/// Measures this computer.
pub fn run(arguments: &Bench, common: &Common) -> anyhow::Result<()> {
    let tune = TuneConfig {
        robot: arguments.robot.clone(),
        base_link: arguments.ends.base_link.clone(),
        tip_link: arguments.ends.tip_link.clone(),
        ..TuneConfig::default()
    }
    .validate_any()?;
    match arguments.realtime {
        Some(seconds) => on_the_clock(&tune, &settings(arguments, seconds)?, arguments.check, common),
        None => speed(&tune, arguments, common),
    }
}

fn speed(tune: &AnyTune, arguments: &Bench, common: &Common) -> anyhow::Result<()> {
    let usual = if arguments.quick { BenchSettings::QUICK } else { BenchSettings::FULL };
    let settings = BenchSettings { ticks: arguments.ticks.unwrap_or(usual.ticks), ..usual };
    let report = any_bench(tune, settings, |stage| {
        if !(common.quiet || common.json) {
            message!("tribo: measuring: {stage}");
        }
    })?;
    if common.json {
        print_json(&serde_json::to_value(&report)?);
    } else {
        show_speed(&report);
    }
    checked(arguments.check, &report.verdict)
}

fn settings(arguments: &Bench, seconds: f64) -> anyhow::Result<RealTimeSettings> {
    let within = |name: &str, value: f64, low: f64, high: f64| {
        if (low..=high).contains(&value) {
            return Ok(value);
        }
        Err(BadInput(format!("{name} is {value}; allowed: {low} to {high}")))
    };
    let seconds = within("--realtime", seconds, 1.0, LONGEST_S)?;
    let stall = arguments.stall.map(|stall_ms| {
        let stall_ms = within("--stall", stall_ms, 0.0, LONGEST_STALL_MS)?;
        let at_s = within("--stall-at", arguments.stall_at.unwrap_or(0.5 * seconds), 0.0, seconds)?;
        Ok::<_, BadInput>(Stall { length: Duration::from_secs_f64(1e-3 * stall_ms), at_s })
    });
    let policy = OverrunPolicy { fault_after: arguments.overruns };
    Ok(RealTimeSettings { seconds, policy, load: arguments.load, stall: stall.transpose()? })
}

fn on_the_clock(tune: &AnyTune, settings: &RealTimeSettings, check: bool, common: &Common) -> anyhow::Result<()> {
    let report = any_real_time(tune, settings)?;
    if common.json {
        print_json(&json!({"schema": "tribo.bench/1", "robot": tune.robot(), "realtime": report}));
    } else {
        show_clock(&report);
    }
    if settings.stall.is_none() {
        return checked(check, &report.verdict);
    }
    match &report.after_fault {
        Some(after) if check && !after.safe => {
            Err(CheckFailed("the arm was not safe after the fault".to_owned()).into())
        }
        _ => Ok(()),
    }
}

fn checked(check: bool, verdict: &Verdict) -> anyhow::Result<()> {
    if check && verdict.answer == Fitness::NotFit {
        return Err(CheckFailed(verdict.because.clone()).into());
    }
    Ok(())
}

/// A table of percentiles (µs).
fn percentiles(rows: &[(&str, Percentiles)]) -> comfy_table::Table {
    let mut table = table(&["us", "mean", "50 %", "99 %", "99.9 %", "longest"]);
    for (name, p) in rows {
        let mut row = vec![(*name).to_owned()];
        row.extend([p.mean, p.p50, p.p99, p.p999, p.max].map(|us| significant(us, 3)));
        table.add_row(row);
    }
    table
}

fn show_speed(report: &BenchReport) {
    print(format_args!("{}, {} ticks", report.robot, report.ticks));
    print(percentiles(&[
        ("tick", report.tick_us),
        ("… the least of three runs", report.tick_itself_us),
        ("simulated arm", report.plant_us),
        ("both", report.tick_with_plant_us),
    ]));
    print("");
    let mut times = table(&["what", "time", ""]);
    let (dynamics, estimators, optimiser) = (&report.dynamics, &report.estimators, &report.optimiser);
    for (name, value, unit) in [
        ("inverse dynamics (RNEA)", dynamics.rnea_ns, "ns"),
        ("mass matrix (CRBA)", dynamics.crba_ns, "ns"),
        ("forward dynamics (ABA)", dynamics.aba_ns, "ns"),
        ("bias torque", dynamics.bias_ns, "ns"),
        ("pose, Jacobian, drift", dynamics.jacobian_ns, "ns"),
        ("all terms of a tick", dynamics.control_terms_ns, "ns"),
        ("EKF", estimators.ekf_us, "us"),
        ("friction-band programme", estimators.qp_us, "us"),
        ("… with its 12 limits", estimators.qp_interval_us, "us"),
        ("trial", report.trial.trial_s, "s"),
        ("times real time", report.trial.realtime_factor, ""),
        ("Gaussian process, 60 trials", optimiser.gp_fit_ms, "ms"),
        ("suggestion, 14 parameters", optimiser.bo_suggest_ms, "ms"),
        ("suggestion, 35 parameters", optimiser.bo_suggest_35_ms, "ms"),
    ] {
        times.add_row([name.to_owned(), significant(value, 3), unit.to_owned()]);
    }
    print(times);
    print("");
    let i = &report.interference;
    print(format_args!(
        "Interference: {} ticks of 100 us and more, {} per second; a loop that does nothing sees {} per second here, the longest {} us.",
        i.ticks_above_100_us,
        significant(i.ticks_above_100_us_per_s, 3),
        significant(i.idle_gaps_above_100_us_per_s, 3),
        significant(i.idle_gap_max_us, 3),
    ));
    if i.ticks_above_100_us > 0 && i.ticks_above_100_us_per_s <= 1.5 * i.idle_gaps_above_100_us_per_s {
        print("So the computer disturbs them, not the loop itself: measure again when nothing else runs.");
    }
    if let Some(preempted) = i.preempted {
        print(format_args!("The system took the core away {preempted} times during the ticks."));
    }
    if report.records_lost > 0 {
        print(format_args!("{} records did not fit into the ring.", report.records_lost));
    }
    show_rights(&report.rights, false);
    show_verdict(&report.verdict);
}

fn show_clock(report: &RealTimeReport) {
    let load = if report.load { ", every core busy" } else { "" };
    print(format_args!("{} periods, {} ticks{load}", report.periods, report.ticks));
    print(percentiles(&[
        ("wake-up behind the period", report.wake_up_us),
        ("tick", report.tick_us),
        ("command behind the period", report.response_us),
    ]));
    print("");
    let mut classes = table(&["command behind the period [us]", "ticks"]);
    for (k, count) in report.response_counts.iter().enumerate() {
        let label = match (k.checked_sub(1).map(|before| report.edges_us[before]), report.edges_us.get(k)) {
            (None, Some(edge)) => format!("below {edge}"),
            (Some(first), Some(edge)) => format!("{first} to {edge}"),
            (first, None) => format!("{} and more", first.unwrap_or_default()),
        };
        classes.add_row([label, count.to_string()]);
    }
    print(classes);
    print("");
    print(format_args!(
        "Deadlines missed: {}, at most {} in a row (the loop gives up at {}).",
        report.missed, report.missed_in_a_row, report.overruns_allowed
    ));
    print(format_args!("Records lost on their way to the other thread: {}.", report.records_lost));
    if let Some(stall_ms) = report.stall_ms {
        print(format_args!("One delay of {stall_ms} ms was on purpose."));
    }
    if let Some(after) = &report.after_fault {
        let safe = if after.safe { "safe" } else { "NOT SAFE" };
        print(format_args!(
            "Stopped after {:.3} s: {}. In the {:.3} s after that the arm was {safe}: fastest joint at {} of its limit, at the end {} rad/s, joint limits {}, safe torque {}.",
            after.at_s,
            after.fault,
            after.watched_s,
            significant(after.max_speed_share, 2),
            significant(after.last_speed_rad_s, 2),
            if after.inside_limits { "kept" } else { "left" },
            if after.stayed { "to the end" } else { "given up" },
        ));
    }
    show_rights(&report.rights, true);
    show_verdict(&report.verdict);
}

fn show_rights(rights: &Rights, real_time: bool) {
    let core = rights.pinned_core.map_or("not kept on one core".to_owned(), |core| format!("kept on core {core}"));
    let more = match (real_time, rights.fifo, rights.memory_locked) {
        (false, ..) => "",
        (true, true, true) => ", SCHED_FIFO, memory locked",
        (true, true, false) => ", SCHED_FIFO, memory not locked",
        (true, false, true) => ", ordinary priority, memory locked",
        (true, false, false) => ", ordinary priority, memory not locked",
    };
    print(format_args!("The loop was {core}{more}."));
    for refused in &rights.refused {
        print(format_args!("Refused: {refused}"));
    }
}

fn show_verdict(verdict: &Verdict) {
    print(format_args!("\n{}: {}", verdict.answer, verdict.because));
}
