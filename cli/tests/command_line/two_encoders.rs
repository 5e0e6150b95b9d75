//! Story: a robot with two encoders per joint reads its gears as torque sensors, by the stiffness that its model knows.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use serde_json::Value;

use crate::common::{number, run, scratch};

/// Two encoders read torque off gears whose stiffness the model knows, or does not.
#[test]
fn two_encoders_take_the_stiffness_of_the_model() {
    let at = scratch();
    let friction = [(0.6, 1.0), (0.9, 1.4), (0.55, 0.8), (0.8, 1.1), (0.4, 0.5), (0.3, 0.4), (0.35, 0.3)];
    let joint = |(fc, fv)| format!("  - {{coulomb_nm: {fc}, viscous_nm_s_per_rad: {fv}}}\n");
    let model = format!(
        "schema: tribo.model/1\nrobot: panda\nfriction:\n  law: coulomb_viscous\n  joints:\n{}",
        friction.into_iter().map(joint).collect::<String>()
    );
    let gear = |(joint, stiffness): (usize, u32)| {
        format!(
            "- {{cause: joint_elasticity, joint: {joint}, stiffness_nm_per_rad: {stiffness}, damping_nm_s_per_rad: 10}}\n"
        )
    };
    let gears: String = [20000, 20000, 15000, 15000, 8000, 8000, 8000].into_iter().enumerate().map(gear).collect();
    std::fs::write(at.path().join("assumed.yaml"), &model).unwrap();
    std::fs::write(at.path().join("known.yaml"), format!("{model}effects:\n{gears}")).unwrap();
    std::fs::write(at.path().join("two.yaml"), "schema: tribo.tune/1\nresidual: double_encoder\n").unwrap();
    let push = "simulate two.yaml --truth known.yaml --compensation oracle --pulse-force 15 --pulse-moment 2.5";
    run(at.path(), &format!("{push} --log pushed.csv.gz --seed 5 -q")).ok();
    let judged = |model: &str| {
        let call = format!("estimate pushed.csv.gz --model {model} --residual double_encoder --json -q");
        run(at.path(), &call).ok().json()["estimators"]["double_encoder"].clone()
    };
    let [known, assumed] = [judged("known.yaml"), judged("assumed.yaml")];
    let error_n = |estimate: &Value| number(&estimate["rmse_force_n"]);
    assert!(error_n(&known) < 0.6 && error_n(&assumed) > 3.0 * error_n(&known), "{known} {assumed}");
    for axis in 0..6 {
        assert!(number(&known["coverage95"][axis]) > 0.9, "axis {axis}: {known}");
    }
}

/// A campaign judges its trials by the same springs.
#[test]
fn a_campaign_of_two_encoders_takes_the_stiffness_of_the_model_too() {
    let at = scratch();
    let model = "schema: tribo.model/1\nrobot: panda\n";
    let gears: String = (0..7)
        .map(|joint| {
            format!(
                "- {{cause: joint_elasticity, joint: {joint}, stiffness_nm_per_rad: 4000, damping_nm_s_per_rad: 10}}\n"
            )
        })
        .collect();
    let friction: String =
        (0..7).map(|joint| format!("- {{cause: coulomb, joint: {joint}, delta_coulomb_nm: 0.6}}\n")).collect();
    let write = |name: &str, text: String| std::fs::write(at.path().join(name), text).unwrap();
    write("truth.yaml", format!("{model}effects:\n{gears}{friction}"));
    write("assumed.yaml", model.to_owned());
    write("known.yaml", format!("{model}effects:\n{gears}"));
    let last = |model: &str| {
        let call = format!(
            "tune --truth truth.yaml --model {model} --residual double_encoder --trials 3 --out {model}.c --json -q"
        );
        let document = run(at.path(), &call).ok().json();
        number(&document["best"]["cost"]) / number(&document["oracle_cost"])
    };
    let [known, assumed] = [last("known.yaml"), last("assumed.yaml")];
    println!("J of the best trial over that of the true friction: {known} with the gears known, {assumed} assumed");
    assert!(known < 1.2 && assumed > 1.1 * known, "{known} {assumed}");
}
