//! Story: the simulated arm has more friction than the model says; the command says so, in every form it has.
//!
//! What is asserted here is the command; how well causes are told apart is the engine's own test.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{run, scratch};
use serde_json::Value;

/// Coulomb friction (Nm) and viscous friction of the model.
const FRICTION: [(f64, f64); 7] =
    [(0.60, 1.0), (0.90, 1.4), (0.55, 0.8), (0.80, 1.1), (0.40, 0.5), (0.30, 0.4), (0.35, 0.3)];

fn model(effects: &str) -> String {
    let joint =
        |&(coulomb, viscous): &(f64, f64)| format!("  - {{coulomb_nm: {coulomb}, viscous_nm_s_per_rad: {viscous}}}\n");
    let joints: String = FRICTION.iter().map(joint).collect();
    format!("schema: tribo.model/1\nrobot: panda\nfriction:\n  law: coulomb_viscous\n  joints:\n{joints}{effects}")
}

/// Moves of all joints, slow and fast, 35 s.
fn motion() -> String {
    let centre = [0.0, -0.6, 0.0, -2.0, 0.0, 1.8, 0.5];
    let mut text = "schema: tribo.trajectory/1\nrobot: panda\nvia_points:\n".to_owned();
    let mut time_s = 0.0;
    for k in 0..17 {
        let amplitude = if k == 0 || k == 16 { 0.0 } else { 0.35 };
        let angle = |j: usize| centre[j] + amplitude * (2.4 * f64::from(k) * (j as f64 + 1.0) + j as f64).sin();
        let angles: Vec<String> = (0..7).map(|j| format!("{:.4}", angle(j))).collect();
        time_s += if k == 0 { 0.0 } else { [1.2, 2.0, 3.5][k as usize % 3] };
        text += &format!("- {{time_s: {time_s:.1}, q_rad: [{}]}}\n", angles.join(", "));
    }
    text
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn a_flaw_is_reported_in_every_form() {
    let at = scratch();
    let read = |name: &str| std::fs::read_to_string(at.path().join(name)).unwrap();
    std::fs::write(at.path().join("m.yaml"), model("")).unwrap();
    let flaw = "effects:\n  - {cause: viscous, joint: 3, delta_viscous_nm_s_per_rad: 4}\n";
    std::fs::write(at.path().join("t.yaml"), model(flaw)).unwrap();
    std::fs::write(at.path().join("move.yaml"), motion()).unwrap();
    run(at.path(), "simulate --truth t.yaml --trajectory move.yaml --seed 61 --log a.parquet --quiet").ok();

    // As JSON, with all files; asked to check, it fails after having done its work.
    let call = "diagnose a.parquet --model m.yaml --json --check --report r.html --extend x.yaml --seed 1";
    let first = run(at.path(), call);
    assert_eq!(first.code, Some(1), "{first:?}");
    assert!(first.stderr.contains("check failed: the verdict is "), "{}", first.stderr);
    let document = first.json();
    assert_eq!(document["schema"], "tribo.diagnosis/1");
    let findings = document["findings"].as_array().unwrap();
    assert!(!findings.is_empty());
    assert_eq!(keys(&findings[0])[..4], ["label", "cause", "joint", "link"]);
    let rms = &document["rms_nm"];
    assert_eq!(keys(rms), ["before", "after", "held_out_before", "held_out_after"]);
    let of_joint_3 = |key: &str| rms[key][3].as_f64().unwrap();
    assert!(of_joint_3("held_out_after") < 0.7 * of_joint_3("held_out_before"), "{rms}");
    assert_eq!((&document["closed_loop"], &document["written"]["report"]), (&Value::Null, &Value::from("r.html")));
    let page = read("r.html");
    assert!(page.starts_with("<!doctype html>") && page.ends_with("</html>\n") && !page.contains("NaN"));

    // The extended model is a model: it goes in again, and out over its own file; the same call gives the same bits.
    assert!(read("x.yaml").contains("effects:"), "{}", read("x.yaml"));
    run(at.path(), "estimate a.parquet --model x.yaml --residual torque --quiet").ok();
    let again = run(at.path(), call);
    assert_eq!((again.stdout, read("r.html")), (first.stdout, page));

    // For people: the verdict comes first.
    let told = run(at.path(), "diagnose a.parquet --model m.yaml --seed 1 -v").ok().stdout;
    let unwrapped = told.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(unwrapped.contains("of the residual on unseen"), "{told}");
    assert!(told.contains("rejected") && told.contains("Assumptions:"), "{told}");
    // The answer alone is printed even when nothing else may be.
    let quiet = run(at.path(), "diagnose a.parquet --model m.yaml --seed 1 --quiet").ok().stdout;
    let answer = quiet.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(!answer.is_empty() && unwrapped.starts_with(&answer), "{quiet}");
}

/// A hand lifts the flange with 20 N: by the robot on the environment that is −20 N along z, and both commands say so.
#[test]
fn a_push_has_the_sign_of_estimate() {
    let at = scratch();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments/06_diagnosis/example");
    let nominal = std::fs::read_to_string(example.join("nominal.yaml")).unwrap();
    let push =
        "effects:\n- {cause: external_contact, force_n: [0, 0, 20], moment_nm: [0, 0, 0], start_s: 8, end_s: 24}\n";
    std::fs::write(at.path().join("pushed.yaml"), format!("{}\n{push}", nominal.trim_end())).unwrap();
    std::fs::write(at.path().join("nominal.yaml"), nominal).unwrap();
    std::fs::copy(example.join("trajectory.yaml"), at.path().join("move.yaml")).unwrap();
    run(at.path(), "simulate --truth pushed.yaml --trajectory move.yaml --seed 3 --log a.parquet --quiet").ok();

    let document = run(at.path(), "diagnose a.parquet --model nominal.yaml --json --seed 1").ok().json();
    // A push is in all joints; none of them has a cause of its own for that.
    assert_eq!(document["findings"].as_array().unwrap().len(), 1, "{document:#}");
    let found = &document["findings"][0];
    assert_eq!(found["cause"], "external_contact");
    let edge = |name: &str| found["params"][name].as_f64().unwrap();
    assert!((edge("start_s") - 8.01).abs() < 0.01 && (edge("end_s") - 23.99).abs() < 0.01, "{found:#}");
    let by_robot = found["wrench_by_robot"]["force_n"][2].as_f64().unwrap();
    assert!((-20.1..-19.9).contains(&by_robot), "{found:#}");
    assert_eq!(found["params"]["force_n"][2].as_f64().unwrap(), -by_robot, "params hold the push itself");

    let estimated = run(at.path(), "estimate a.parquet --model nominal.yaml --residual momentum --json").ok().json();
    let mean = estimated["estimators"]["momentum"]["mean"][2].as_f64().unwrap();
    assert!((-8.5..-6.0).contains(&mean), "16 of 44.5 s at −20 N: {mean} N");

    let said = run(at.path(), "diagnose a.parquet --model nominal.yaml --seed 1").ok().stdout;
    let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("by the robot on the environment: (") && words.contains("force_by_robot_n[2] -"), "{said}");
    assert!(!words.contains(" force_n["), "{said}");
}
