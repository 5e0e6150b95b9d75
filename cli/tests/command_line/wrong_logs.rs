//! Story: logs that cannot be right are refused before anything is made of them, in one sentence and quickly.
//!
//! One good trial, one good motion; each mutilation of the file is told, diagnosed or estimated. A refused log leaves the campaign as it was.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;
use std::time::Instant;

use tribo_robot::{gravity_torque, presets};

use crate::common::{run, scratch};

/// Longest that a refusal takes (s): reading a CSV of 33 s at 1 kHz and judging it, beside other tests on a slow computer.
const QUICK_S: f64 = 20.0;

/// Keeps one of four rows of a CSV log: what is wrong at 250 Hz is wrong at 1 kHz, and read four times as fast.
fn thin(log: &Path) {
    let text = std::fs::read_to_string(log).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let kept: Vec<&str> = rows.lines().step_by(4).collect();
    std::fs::write(log, format!("{header}\n{}\n", kept.join("\n"))).unwrap();
}

/// Writes a copy of a CSV log with every cell changed by `change(column, value)`.
fn mutilated(at: &Path, from: &str, to: &str, change: impl Fn(&str, f64) -> f64) {
    let text = std::fs::read_to_string(at.join(from)).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    let names: Vec<&str> = header.split(',').collect();
    let rows = lines.map(|line| {
        let cells = line.split(',').zip(&names).map(|(cell, name)| change(name, cell.parse().unwrap()).to_string());
        cells.collect::<Vec<_>>().join(",")
    });
    std::fs::write(at.join(to), format!("{header}\n{}\n", rows.collect::<Vec<_>>().join("\n"))).unwrap();
}

/// Writes a copy of a CSV log without the gravity of a Panda in its torques, as libfranka commands them.
fn without_gravity(at: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(at.join(from)).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let names: Vec<&str> = header.split(',').collect();
    let place = |name: String| names.iter().position(|column| **column == name).unwrap();
    let [q, commanded, measured] =
        ["q", "tau_J_d", "tau_J"].map(|stem| (0..7).map(|j| place(format!("{stem}_{j}"))).collect::<Vec<_>>());
    let rows = rows.lines().map(|line| {
        let mut cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let mut posture = presets::panda_ready_pose();
        posture.iter_mut().zip(&q).for_each(|(angle, place)| *angle = cells[*place]);
        let gravity = gravity_torque(&presets::panda(), &posture);
        for column in [&commanded, &measured] {
            column.iter().zip(gravity.iter()).for_each(|(place, gravity)| cells[*place] -= gravity);
        }
        cells.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
    });
    std::fs::write(at.join(to), format!("{header}\n{}\n", rows.collect::<Vec<_>>().join("\n"))).unwrap();
}

/// Exit code 2 with these words, quickly.
#[track_caller]
fn refused(at: &Path, command: &str, words: &[&str]) {
    let start = Instant::now();
    let refused = run(at, command);
    assert_eq!(refused.code, Some(2), "{command}: {refused:?}");
    assert!(words.iter().all(|word| refused.stderr.contains(word)), "{command}: {words:?} in {}", refused.stderr);
    assert!(start.elapsed().as_secs_f64() < QUICK_S, "{command} took {:?}", start.elapsed());
}

/// Noise of 5 Nm at most.
fn noise(k: f64) -> f64 {
    5.0 * ((12.9898 * k).sin() * 43758.5453).fract()
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

#[test]
fn a_wrong_log_is_no_trial() {
    let scratch = scratch();
    let at = scratch.path();
    run(at, "ask mine --truth coulomb_viscous --trials 3 --out zero.yaml -q").ok();
    run(at, "simulate mine/campaign.yaml --trial 0 --compensation zero.yaml --log good.csv -q").ok();
    thin(&at.join("good.csv"));
    let journal = std::fs::read(at.join("mine/journal.log")).unwrap();
    let angle = |name: &str| name.starts_with("q_") || name.starts_with("dq_");
    let torque = |name: &str| name.starts_with("tau_J");
    let first = std::fs::read_to_string(at.join("good.csv")).unwrap();
    let header: Vec<String> = first.lines().next().unwrap().split(',').map(str::to_owned).collect();
    let start: Vec<f64> = first.lines().nth(1).unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
    let at_start = |name: &str| start[header.iter().position(|column| column == name).unwrap()];

    mutilated(at, "good.csv", "degrees.csv", |name, x| if angle(name) { x * DEGREES } else { x });
    refused(at, "tell mine degrees.csv", &["degrees.csv: degrees:", "as radians", "pi/180"]);
    mutilated(at, "good.csv", "ms.csv", |name, x| if name == "time" { x * 1e3 } else { x });
    refused(at, "tell mine ms.csv", &["milliseconds", "divide column time by 1e3"]);
    mutilated(at, "good.csv", "ns.csv", |name, x| if name == "time" { x * 1e9 } else { x });
    refused(at, "tell mine ns.csv", &["nanoseconds"]);
    mutilated(at, "good.csv", "mnm.csv", |name, x| if torque(name) { x * 1e3 } else { x });
    refused(at, "tell mine mnm.csv", &["torque_unit", "mNm"]);
    mutilated(at, "good.csv", "turned.csv", |name, x| if torque(name) { -x } else { x });
    refused(at, "tell mine turned.csv", &["torque_sign", "all joints", "multiply the torques by -1"]);
    mutilated(at, "good.csv", "one.csv", |name, x| if name == "tau_J_d_3" { -x } else { x });
    refused(at, "tell mine one.csv", &["fits the model with the opposite sign: correlation -0.8"]);
    // In so small a motion other joints are not explained well either: what turns one joint's torque from noise into sense is said.
    for joint in 0..7 {
        let column = format!("tau_J_d_{joint}");
        mutilated(at, "good.csv", "one.csv", |name, x| if name == column { -x } else { x });
        refused(at, "tell mine one.csv", &["_sign", &format!("panda_joint{} ({joint})", joint + 1)]);
        let columns = [format!("q_{joint}"), format!("dq_{joint}")];
        mutilated(at, "good.csv", "one.csv", |name, x| if columns.contains(&name.to_owned()) { -x } else { x });
        refused(at, "tell mine one.csv", &["_sign", &format!("panda_joint{} ({joint})", joint + 1)]);
    }
    mutilated(at, "good.csv", "one.csv", |name, x| if name == "tau_J_d_3" { 4.0 * x } else { x });
    refused(at, "tell mine one.csv", &["torque_unit", "the torque of panda_joint4 (3) is 3.99"]);
    mutilated(at, "good.csv", "one.csv", |name, x| if matches!(name, "q_5" | "dq_5") { x * DEGREES } else { x });
    refused(at, "tell mine one.csv", &["impossible_samples", "q_5 is ", "is it in degrees?"]);
    let swapped = first.replace("tau_J_d_5", "?").replace("tau_J_d_6", "tau_J_d_5").replace('?', "tau_J_d_6");
    std::fs::write(at.join("one.csv"), swapped).unwrap();
    refused(at, "tell mine one.csv", &["joint_order", "exchange columns tau_J_5 and tau_J_6"]);
    // The whole log of another arm.
    for robot in ["kinova_gen3", "iiwa14"] {
        run(at, &format!("ask {robot} --robot {robot} --trials 3 --out other.yaml -q")).ok();
        run(at, &format!("simulate {robot}/campaign.yaml --trial 0 --compensation other.yaml --log one.csv -q")).ok();
        refused(at, "tell mine one.csv", &["other_robot", robot]);
    }
    mutilated(at, "good.csv", "standing.csv", |name, x| match angle(name) {
        true if name.starts_with("dq") => 0.0,
        true => at_start(name),
        false => x,
    });
    refused(at, "tell mine standing.csv", &["standing.csv: standstill: no joint moves"]);
    let stands = |name: &str| name.rsplit('_').next().is_some_and(|joint| matches!(joint, "1" | "2" | "3" | "5"));
    mutilated(at, "good.csv", "mostly.csv", |name, x| match angle(name) && stands(name) {
        true if name.starts_with("dq") => 0.0,
        true => at_start(name) + 1e-4 * (1e3 * x).sin(),
        false => x,
    });
    refused(at, "tell mine mostly.csv", &["their friction costs nothing"]);
    // Torques that say nothing of the motion: noise, and a column that was never filled in.
    let row = std::cell::Cell::new(0.0);
    mutilated(at, "good.csv", "noise.csv", |name, x| {
        row.set(row.get() + 1.0);
        if torque(name) { noise(row.get()) } else { x }
    });
    refused(at, "tell mine noise.csv", &["torque_unexplained", "no more of these torques than a constant would"]);
    mutilated(at, "good.csv", "zero.csv", |name, x| if torque(name) { 0.0 } else { x });
    refused(
        at,
        "tell mine zero.csv",
        &["torque_unexplained", "all joints: the joints turn and their torque is the same in every row"],
    );
    // The torques of three joints, each in the place of the next.
    let order = [("tau_J_d_1", "?"), ("tau_J_d_5", "tau_J_d_1"), ("tau_J_d_3", "tau_J_d_5"), ("?", "tau_J_d_3")];
    let cycled = order.iter().fold(first.clone(), |text, (from, to)| text.replacen(from, to, 1));
    std::fs::write(at.join("one.csv"), cycled).unwrap();
    refused(at, "tell mine one.csv", &["joint_order", "panda_joint2 (1), panda_joint4 (3) and panda_joint6 (5)"]);
    mutilated(at, "good.csv", "frozen.csv", |name, x| if name == "q_1" { at_start(name) } else { x });
    refused(at, "tell mine frozen.csv", &["frozen_encoder", "the position of joint 1 keeps one value"]);
    mutilated(at, "good.csv", "speeds.csv", |name, x| if name.starts_with("dq") { -x } else { x });
    refused(at, "tell mine speeds.csv", &["velocity_sign"]);

    // What libfranka commands is without gravity: the campaign takes it where it is told so.
    without_gravity(at, "good.csv", "bare.csv");
    refused(at, "tell mine bare.csv", &["gravity_missing", "commanded_without_gravity"]);

    assert_eq!(std::fs::read(at.join("mine/journal.log")).unwrap(), journal, "a refused log left traces");
    let told = run(at, "tell mine good.csv --json").ok();
    assert!(told.stderr.is_empty(), "{told:?}");
    assert!(told.json()["cost"].as_f64().unwrap() > 1.0);
}

/// Joints that stand, or move one way only, may do so in a good trial if they are few: said, and not refused.
#[test]
fn few_joints_that_hardly_move_are_said() {
    let scratch = scratch();
    let at = scratch.path();
    run(at, "ask stands --truth coulomb_viscous --trials 3 --out zero.yaml -q").ok();
    run(at, "ask one_way --truth coulomb_viscous --trials 3 -q").ok();
    run(at, "simulate stands/campaign.yaml --trial 0 --compensation zero.yaml --log good.csv -q").ok();
    thin(&at.join("good.csv"));
    let time = std::cell::Cell::new(0.0);
    let last_joint = |of_time: fn(f64) -> [f64; 2]| {
        mutilated(at, "good.csv", "last.csv", |name, x| {
            if name == "time" {
                time.set(x);
            }
            match name {
                "q_6" => of_time(time.get())[0],
                "dq_6" => of_time(time.get())[1],
                _ => x,
            }
        });
    };
    last_joint(|t| [0.785 + 1e-5 * (1e3 * t).sin(), 0.0]);
    let told = run(at, "tell stands last.csv --json").ok();
    assert!(told.stderr.contains("joint 6 moves less than 0.005 rad one way or the other"), "{told:?}");
    last_joint(|t| [0.7 + 0.005 * t + 1e-5 * (1e3 * t).sin(), 0.005]);
    let told = run(at, "tell one_way last.csv --json").ok();
    assert!(told.stderr.contains("joint 6 moves less than 0.005 rad one way or the other"), "{told:?}");
}

/// The same of arms whose wrists hardly feel their friction.
#[test]
fn a_turned_joint_is_no_trial_of_any_arm() {
    let scratch = scratch();
    let at = scratch.path();
    for (robot, joints) in [("xarm7", [2, 5]), ("ur10e", [0, 1]), ("kinova_gen3", [3, 4]), ("iiwa14", [0, 4])] {
        run(at, &format!("ask {robot} --robot {robot} --trials 3 --out zero.yaml -q")).ok();
        run(at, &format!("simulate {robot}/campaign.yaml --trial 0 --compensation zero.yaml --log good.csv -q")).ok();
        for joint in joints {
            let column = format!("tau_J_d_{joint}");
            mutilated(at, "good.csv", "one.csv", |name, x| if name == column { -x } else { x });
            refused(at, &format!("tell {robot} one.csv"), &["_sign", &format!("({joint})")]);
            let columns = [format!("q_{joint}"), format!("dq_{joint}")];
            mutilated(at, "good.csv", "one.csv", |name, x| if columns.contains(&name.to_owned()) { -x } else { x });
            refused(at, &format!("tell {robot} one.csv"), &["_sign", &format!("({joint})")]);
        }
        let told = run(at, &format!("tell {robot} good.csv --json")).ok();
        assert!(told.json()["cost"].as_f64().unwrap() > 1.0, "{told:?}");
    }
}

#[test]
fn a_wrong_log_is_neither_diagnosed_nor_estimated_and_is_converted_with_a_warning() {
    let scratch = scratch();
    let at = scratch.path();
    run(at, "simulate --compensation oracle --log good.csv -q").ok();
    thin(&at.join("good.csv"));
    mutilated(at, "good.csv", "turned.csv", |name, x| if name == "tau_J_1" { -x } else { x });
    mutilated(at, "good.csv", "ms.csv", |name, x| if name == "time" { x * 1e3 } else { x });
    mutilated(at, "good.csv", "speeds.csv", |name, x| if name.starts_with("dq") { 1.05 * x } else { x });
    for command in ["diagnose", "estimate --residual torque", "estimate --residual ekf"] {
        refused(
            at,
            &format!("{command} turned.csv"),
            &["the torque of panda_joint2 (1)", "multiply column tau_J_1 by -1"],
        );
        refused(at, &format!("{command} ms.csv"), &["milliseconds"]);
    }
    without_gravity(at, "good.csv", "bare.csv");
    let angle = |name: &str| name.starts_with("q_") || name.starts_with("dq_");
    mutilated(at, "good.csv", "degrees.csv", |name, x| if angle(name) { x * DEGREES } else { x });
    mutilated(at, "good.csv", "mnm.csv", |name, x| if name.starts_with("tau_J") { x * 1e3 } else { x });
    mutilated(at, "good.csv", "ns.csv", |name, x| if name == "time" { x * 1e9 } else { x });
    let text = std::fs::read_to_string(at.join("good.csv")).unwrap();
    let swapped = text.replacen("tau_J_1", "?", 1).replacen("tau_J_3", "tau_J_1", 1).replacen('?', "tau_J_3", 1);
    std::fs::write(at.join("swapped.csv"), swapped).unwrap();
    for command in ["diagnose", "estimate --residual ekf"] {
        refused(at, &format!("{command} bare.csv"), &["gravity"]);
        refused(at, &format!("{command} degrees.csv"), &["degrees"]);
        refused(at, &format!("{command} mnm.csv"), &["torque_unit", "mNm"]);
        refused(at, &format!("{command} ns.csv"), &["nanoseconds"]);
        refused(at, &format!("{command} swapped.csv"), &["joint_order", "exchange columns tau_J_1 and tau_J_3"]);
    }
    // Somebody may know better.
    let taken = run(at, "estimate --residual torque --anyway turned.csv --json").ok();
    assert!(taken.stderr.contains("multiply column tau_J_1 by -1"), "{taken:?}");
    let converted = run(at, "convert ms.csv out.parquet").ok();
    assert!(converted.stdout.contains("divide column time by 1e3"), "{converted:?}");
    let warned = run(at, "estimate --residual ekf speeds.csv --json").ok();
    assert!(warned.stderr.contains("1.05") && warned.stderr.contains("time stamps"), "{warned:?}");
    // A diagnosis says in its document that there may be nothing to explain.
    let row = std::cell::Cell::new(0.0);
    mutilated(at, "good.csv", "noise.csv", |name, x| {
        row.set(row.get() + 1.0);
        if name.starts_with("tau_J") { noise(row.get()) } else { x }
    });
    let noted = run(at, "diagnose noise.csv --json -q").ok().json();
    let notes = noted["notes"].to_string();
    assert!(
        notes.contains("noise.csv: ") && notes.contains("no more of these torques than a constant would"),
        "{notes}"
    );
    let good = run(at, "estimate --residual ekf good.csv").ok();
    assert!(!good.stdout.contains("warning"), "{good:?}");
}

/// An arm that never moved has a wrench and can be diagnosed, but nobody takes it for one that moved.
#[test]
fn an_arm_that_never_moved_is_said_by_every_command() {
    let scratch = scratch();
    let at = scratch.path();
    run(at, "simulate --compensation oracle --log good.csv -q").ok();
    thin(&at.join("good.csv"));
    let first = std::cell::RefCell::new(std::collections::BTreeMap::new());
    mutilated(at, "good.csv", "standing.csv", |name, x| match name.split_once('_') {
        Some(("q", _)) => *first.borrow_mut().entry(name.to_owned()).or_insert(x),
        Some(("dq", _)) => 0.0,
        _ => x,
    });
    for command in ["estimate --residual ekf standing.csv --json", "diagnose standing.csv --json"] {
        let done = run(at, command).ok();
        assert!(done.stderr.contains("standing.csv: no joint moves"), "{command}: {done:?}");
    }
    let converted = run(at, "convert standing.csv out.parquet").ok();
    assert!(converted.stdout.contains("warning      no joint moves"), "{converted:?}");
    let converted = run(at, "convert standing.csv out.parquet --json").ok().json();
    assert_eq!(converted["remarks"][0]["fault"], "standstill", "{converted}");
}

/// A joint that hardly moves, of which least squares says nothing, has its sign from the energy that friction takes; at a quarter of the rate too.
#[test]
fn a_turned_joint_that_hardly_moves_is_no_trial_either() {
    let scratch = scratch();
    let at = scratch.path();
    for (robot, joints) in [("xarm7", &[2][..]), ("ur10e", &[0, 1]), ("kinova_gen3", &[3])] {
        run(at, &format!("ask {robot} --robot {robot} --truth coulomb_viscous --trials 3 --out zero.yaml -q")).ok();
        run(at, &format!("simulate {robot}/campaign.yaml --trial 0 --compensation zero.yaml --log good.csv -q")).ok();
        for joint in joints {
            let column = format!("tau_J_d_{joint}");
            mutilated(at, "good.csv", "one.csv", |name, x| if name == column { -x } else { x });
            refused(at, &format!("tell {robot} one.csv"), &["_sign", &format!("({joint})")]);
        }
        run(at, &format!("tell {robot} good.csv -q")).ok();
    }
}

/// A log without `dq` says the same as one with it, and says that it had none.
#[test]
fn velocities_are_worked_out_where_a_log_has_none() {
    let scratch = scratch();
    let at = scratch.path();
    run(at, "simulate --compensation oracle --log good.csv -q").ok();
    let text = std::fs::read_to_string(at.join("good.csv")).unwrap();
    let kept: Vec<usize> = text
        .lines()
        .next()
        .unwrap()
        .split(',')
        .enumerate()
        .filter(|(_, name)| !name.starts_with("dq_"))
        .map(|(k, _)| k)
        .collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        kept.iter().map(|k| cells[*k]).collect::<Vec<_>>().join(",")
    };
    std::fs::write(at.join("without.csv"), text.lines().map(row).collect::<Vec<_>>().join("\n") + "\n").unwrap();
    let converted = run(at, "convert without.csv with.csv").ok();
    assert!(converted.stdout.contains("no dq_i: worked out from q_i, slopes over 21 rows"), "{converted:?}");
    let force = |log: &str| run(at, &format!("estimate --residual momentum {log} --json")).ok().json();
    let [with, without] =
        ["good.csv", "without.csv"].map(|log| force(log)["estimators"]["momentum"]["rms"][2].as_f64().unwrap());
    assert!((with / without - 1.0).abs() < 0.1, "{with} {without}");
}
