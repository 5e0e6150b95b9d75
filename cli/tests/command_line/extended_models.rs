//! Story: a model with effects goes wherever a model goes — as the truth, as a belief, as the eye on a log — and a
//! joint-space trajectory is followed.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::fmt::Write;
use std::path::Path;

use crate::common::{number, result, run, scratch, snapshot};
use serde_json::Value;

/// The Panda with Coulomb and viscous friction, motor side.
const NOMINAL: &str = "\
schema: tribo.model/1
robot: panda
friction:
  law: coulomb_viscous
  joints:
  - {coulomb_nm: 0.60, viscous_nm_s_per_rad: 1.0}
  - {coulomb_nm: 0.90, viscous_nm_s_per_rad: 1.4}
  - {coulomb_nm: 0.55, viscous_nm_s_per_rad: 0.8}
  - {coulomb_nm: 0.80, viscous_nm_s_per_rad: 1.1}
  - {coulomb_nm: 0.40, viscous_nm_s_per_rad: 0.5}
  - {coulomb_nm: 0.30, viscous_nm_s_per_rad: 0.4}
  - {coulomb_nm: 0.35, viscous_nm_s_per_rad: 0.3}
";

/// What a diagnosis might have added to it.
const EFFECTS: &str = "\
effects:
- {cause: payload, mass_kg: 0.4, com_m: [0.01, 0.0, 0.05]}
- {cause: coulomb, joint: 3, delta_coulomb_nm: 0.5}
- {cause: torque_offset, joint: 1, offset_nm: 0.6}
- {cause: position_spring, joint: 5, stiffness_nm_per_rad: 2.0, rest_rad: 1.2}
";

const TRAJECTORY: &str = "\
schema: tribo.trajectory/1
robot: panda
comment: there and back
via_points:
- {time_s: 0.0, q_rad: [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]}
- {time_s: 2.0, q_rad: [0.5, -0.285, 0.3, -1.956, 0.3, 1.971, 0.285]}
- {time_s: 4.5, q_rad: [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]}
";

fn write(at: &Path, name: &str, text: &str) {
    std::fs::write(at.join(name), text).unwrap();
}

/// A directory with `nominal.yaml`, `extended.yaml` and `move.yaml`.
fn models() -> tempfile::TempDir {
    let at = scratch();
    write(at.path(), "nominal.yaml", NOMINAL);
    write(at.path(), "extended.yaml", &format!("{NOMINAL}{EFFECTS}"));
    write(at.path(), "move.yaml", TRAJECTORY);
    at
}

/// The plant obeys every effect; who believes the extended model is as good as the oracle, who believes the old one is
/// better than who believes nothing, and worse.
#[test]
fn believing_the_extended_model_pays() {
    let at = models();
    let cost = |compensation: &str| {
        let call = format!("simulate --truth extended.yaml --compensation {compensation} --seed 5 --json");
        number(&run(at.path(), &call).ok().json()["cost"])
    };
    let [none, nominal, extended, oracle] = ["none", "nominal.yaml", "extended.yaml", "oracle"].map(cost);
    println!("J: none {none:.2}, nominal {nominal:.2}, extended {extended:.2}, oracle {oracle:.2}");
    assert_eq!(extended, oracle, "the same belief, the same noise");
    assert!(extended < 0.5 * nominal && nominal < none, "{extended} {nominal} {none}");
    assert!(extended < 4.0, "the oracle of the plain truth reaches 3.1: {extended}");
}

/// The plant's friction jumps where the model's is smooth: a robot that is as its model says is told so, and the width of its sign with it.
#[test]
fn a_robot_as_its_model_says_lacks_nothing() {
    let at = models();
    let via = |(k, q): (usize, [f64; 3])| {
        let [a, b, c] = q;
        format!(
            "- {{time_s: {}, q_rad: [{a}, {}, {b}, {}, {c}, {}, {}]}}\n",
            3 * k,
            b - 0.785,
            a - 2.1,
            1.6 + c,
            0.5 - b
        )
    };
    let poses = [
        [0.0, 0.0, 0.0],
        [0.3, 0.2, -0.3],
        [0.28, 0.22, -0.25],
        [-0.4, -0.1, 0.3],
        [-0.38, -0.15, 0.33],
        [0.1, 0.3, 0.0],
    ];
    let points: String = poses.into_iter().chain(poses.into_iter().rev()).enumerate().map(via).collect();
    write(at.path(), "around.yaml", &format!("schema: tribo.trajectory/1\nrobot: panda\nvia_points:\n{points}"));
    run(at.path(), "simulate --truth nominal.yaml --trajectory around.yaml --log right.parquet --seed 3 -q").ok();
    let answer =
        run(at.path(), "diagnose right.parquet --model nominal.yaml --extend found.yaml --json -q").ok().json();
    assert_eq!(answer["verdict"], "nothing_missing", "{}", answer["findings"]);
    let width = number(&answer["smoothing_rad_s"]);
    assert!(width < 1e-3, "{width}");
    let found = std::fs::read_to_string(at.path().join("found.yaml")).unwrap();
    assert!(found.contains(&format!("smoothing_rad_s: {width}\n")), "{found}");
    let sum = |which: &str| answer["rms_nm"][which].as_array().unwrap().iter().map(number).sum::<f64>();
    assert!(sum("after") < 0.7 * sum("before"), "{} {}", sum("after"), sum("before"));
}

/// What cannot be cancelled is said, with the reason, and does no harm.
#[test]
fn what_cannot_be_cancelled_is_said() {
    let at = models();
    let rest = "- {cause: time_delay, delay_s: 0.001}\n- {cause: backlash, joint: 2, half_gap_rad: 0.0001}\n";
    write(at.path(), "rest.yaml", &format!("{NOMINAL}{EFFECTS}{rest}"));
    let spoken = run(at.path(), "simulate --compensation rest.yaml --json").ok();
    for words in ["time_delay is not cancelled: ", "backlash of panda_joint3 (2) is not cancelled: "] {
        assert!(spoken.stderr.contains(words), "{spoken:?}");
    }
    assert_eq!(spoken.json()["not_cancelled"].as_array().map(Vec::len), Some(2));
    assert_eq!(run(at.path(), "simulate --compensation rest.yaml --quiet").ok().stderr, "");
    assert!(run(at.path(), "simulate --compensation extended.yaml --json").ok().json().get("not_cancelled").is_none());
}

/// A campaign on an extended truth: it keeps the files it began with, whatever becomes of them.
#[test]
fn a_campaign_keeps_its_models() {
    let at = models();
    let tune = "tune --truth extended.yaml --model extended.yaml --seed 6 --json";
    let whole = run(at.path(), &format!("{tune} --trials 3 --out whole")).ok().json();
    run(at.path(), &format!("{tune} --trials 2 --out halved")).ok();
    for change in ["", "robot: ur5\n"] {
        write(at.path(), "extended.yaml", change);
    }
    let settings = std::fs::read_to_string(at.path().join("halved/campaign.yaml")).unwrap();
    assert!(settings.contains("truth_content:") && settings.contains("model_content:"), "{settings}");
    std::fs::remove_file(at.path().join("extended.yaml")).unwrap();
    let resumed = run(at.path(), "tune --resume --trials 3 --json --out halved").ok().json();
    assert_eq!(result(&resumed), result(&whole));
    assert!(number(&whole["best"]["cost"]) < 1.3 * number(&whole["oracle_cost"]), "{}", whole["best"]);

    // The tuned file has the belief in it, and other programs get it too.
    let again = run(at.path(), "export whole --format json").ok().json();
    assert_eq!(again["model"]["effects"].as_array().map(Vec::len), Some(4));
    write(at.path(), "extended.yaml", &format!("{NOMINAL}{EFFECTS}"));
    let call = "simulate --truth extended.yaml --compensation whole/tuned.yaml --seed 77 --json";
    let cost = number(&run(at.path(), call).ok().json()["cost"]);
    assert!(cost < 1.3 * number(&whole["oracle_cost"]), "{cost}");
}

/// Without the belief the strategy has only the friction law to work with, and stays above the oracle.
#[test]
fn the_belief_composes_with_the_tuned_law() {
    let at = models();
    let best = |model: &str| {
        let call = format!("tune --truth extended.yaml {model} --trials 3 --seed 8 --json --out c{}", model.len());
        let document = run(at.path(), &call).ok().json();
        number(&document["best"]["cost"]) / number(&document["oracle_cost"])
    };
    let (alone, with) = (best(""), best("--model extended.yaml"));
    println!("J/J_oracle at trial 2: law alone {alone:.2}, with the model's effects {with:.2}");
    assert!(with < 1.3 && alone > 1.5 * with, "{alone} {with}");
}

/// The wrench on a log is cleaner through the eyes of the right model.
#[test]
fn estimate_sees_through_the_effects() {
    let at = models();
    run(at.path(), "simulate --truth extended.yaml --compensation oracle --seed 9 --log x.csv --quiet").ok();
    let look = |model: &str| run(at.path(), &format!("estimate x.csv --model {model} --json")).ok().json();
    let (nominal, extended) = (look("nominal.yaml"), look("extended.yaml"));
    let rmse = |document: &Value| number(&document["estimators"]["ekf"]["rmse_force_n"]);
    println!("RMSE: nominal {:.2} N, extended {:.2} N", rmse(&nominal), rmse(&extended));
    assert!(rmse(&extended) < 0.5 * rmse(&nominal));
    let residual =
        |document: &Value, joint: usize| number(&document["torque_residual"]["joints"][joint]["rms_with_model_nm"]);
    for joint in [1, 3, 5] {
        let (before, after) = (residual(&nominal, joint), residual(&extended, joint));
        assert!(after < 0.6 * before, "joint {joint}: {before} {after}");
    }
}

/// A trajectory is followed within a milliradian or so, starts and ends where the file says, and its log reads back.
#[test]
fn a_trajectory_is_followed() {
    let at = models();
    let call = "simulate --truth extended.yaml --compensation oracle --trajectory move.yaml --log t.csv --json";
    let document = run(at.path(), call).ok().json();
    assert_eq!((number(&document["duration_s"]), &document["reason"]), (4.5, &Value::Null));
    let largest = document["tracking_max_rad"].as_array().unwrap().iter().map(number).fold(0.0, f64::max);
    println!("largest tracking error {:.2} mrad", 1e3 * largest);
    assert!(largest < 3e-3, "{document}");
    let text = std::fs::read_to_string(at.path().join("t.csv")).unwrap();
    assert_eq!(text.lines().count(), 4501);
    let table = run(at.path(), "simulate --trajectory move.yaml --compensation oracle").ok();
    assert!(table.stdout.contains("rms error [mrad]"), "{table:?}");
    run(at.path(), "estimate t.csv --model extended.yaml --quiet").ok();
    // Same seed, same bytes.
    run(at.path(), &call.replace("t.csv", "u.csv")).ok();
    assert_eq!(std::fs::read_to_string(at.path().join("u.csv")).unwrap(), text);
}

/// Exit code 2, silence on standard output, everything named, nothing written.
#[test]
fn refusals() {
    let bad = |line: &str| format!("{NOMINAL}effects:\n- {{cause: torque_offset, joint: 0, offset_nm: 1}}\n{line}\n");
    let moved = |from: &str, to: &str| TRAJECTORY.replace(from, to);
    let joint = bad("- {cause: coulomb, joint: 7, delta_coulomb_nm: 1}");
    let joint_needles = &["m.yaml:15: field `effects[1].joint` is 7; allowed: 0 to 6"][..];
    let cases: Vec<(&str, String, &str, &[&str])> = vec![
        ("m.yaml", joint.clone(), "simulate --truth m.yaml --log z.csv", joint_needles),
        ("m.yaml", joint.clone(), "simulate --model m.yaml --log z.csv", joint_needles),
        ("m.yaml", joint.clone(), "simulate --compensation m.yaml --log z.csv", joint_needles),
        ("m.yaml", joint.clone(), "tune --truth m.yaml --trials 1 --out z", joint_needles),
        ("m.yaml", joint.clone(), "tune --model m.yaml --trials 1 --out z", joint_needles),
        ("m.yaml", joint, "estimate x.csv --model m.yaml", joint_needles),
        (
            "m.yaml",
            bad("- {cause: stribeck, joint: 1, breakaway_minus_coulomb_nm: 0.1, stribeck_velocity_rad_s: -0.1}"),
            "simulate --truth m.yaml",
            &["m.yaml:15: field `effects[1].stribeck_velocity_rad_s` is -0.1; allowed: 1e-5..10"],
        ),
        ("m.yaml", bad("- {cause: gremlins, joint: 1}"), "simulate --truth m.yaml", &["m.yaml:15", "`gremlins`"]),
        (
            "m.yaml",
            bad("- {cause: coulomb, joint: 1, delta_coulomb_nm: 1, color: red}"),
            "simulate --truth m.yaml",
            &["m.yaml:15", "`color`"],
        ),
        (
            "m.yaml",
            String::new(),
            "simulate --model nominal.yaml --compensation oracle",
            &["--model", "--compensation"],
        ),
        (
            "m.yaml",
            String::new(),
            "simulate --model nominal.yaml --compensation extended.yaml",
            &["--model", "--compensation extended.yaml"],
        ),
        ("m.yaml", String::new(), "tune --resume --model nominal.yaml", &["--model cannot be combined with --resume"]),
        (
            "t.yaml",
            moved("0.3, 1.971", "0.3, 9.9"),
            "simulate --trajectory t.yaml --log z.csv",
            &["t.yaml:6: field `via_points[1].q_rad[5]` is 9.9; allowed: -0.0175 to 3.7525"],
        ),
        (
            "t.yaml",
            moved("time_s: 2.0", "time_s: 0.1"),
            "simulate --trajectory t.yaml --log z.csv",
            &["t.yaml:6: field `via_points[1].q_rad[0]` is 0.5; allowed: ", "rad/s on its way"],
        ),
        (
            "t.yaml",
            moved("time_s: 4.5", "time_s: 1.5"),
            "simulate --trajectory t.yaml",
            &["t.yaml:7: field `via_points[2].time_s` is 1.5; allowed: greater than 2, at most 3600"],
        ),
        ("t.yaml", moved("comment", "remark"), "simulate --trajectory t.yaml", &["t.yaml:3:1: ", "`remark`"]),
        ("t.yaml", moved("trajectory/1", "model/1"), "simulate --trajectory t.yaml", &["t.yaml:1: field `schema`"]),
        ("t.yaml", String::new(), "simulate --trajectory nowhere.yaml", &["nowhere.yaml: No such file"]),
        ("t.yaml", TRAJECTORY.to_owned(), "simulate --trajectory t.yaml --fixed", &["--trajectory", "--fixed"]),
        ("t.yaml", TRAJECTORY.to_owned(), "simulate --trajectory t.yaml --pose 1", &["--trajectory", "--pose"]),
    ];
    let mut complaints = String::new();
    for (name, content, call, needles) in cases {
        let at = models();
        write(at.path(), name, &content);
        write(at.path(), "x.csv", "time\n0\n");
        let before = snapshot(at.path());
        let run = run(at.path(), call);
        let silent = run.stdout.is_empty() && snapshot(at.path()) == before;
        let told = needles.iter().all(|needle| run.stderr.contains(needle));
        if run.code != Some(2) || !silent || !told {
            writeln!(complaints, "tribo {call}: {needles:?}\n  {run:?}").unwrap();
        }
    }
    assert!(complaints.is_empty(), "\n{complaints}");
}
