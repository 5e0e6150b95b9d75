//! Story: what the command says has bounds: figures where there are some, memory within reason, and limits of the simulation.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{run, scratch};
use tribo_logs::{LogColumns, RobotLog, read_log, write_csv};

const POSE: [f64; 7] = [0.0, -0.7, 0.0, -2.3, 0.0, 1.5, 0.7];

/// An arm that swings by 0.1 rad, with torques of so many Nm.
fn swinging(rows: usize, torque_nm: f64) -> RobotLog {
    let time_s: Vec<f64> = (0..rows).map(|k| k as f64 * 1e-3).collect();
    let each = |value: &dyn Fn(usize, f64) -> f64| -> Vec<Vec<f64>> {
        (0..7).map(|j| time_s.iter().map(|t| value(j, *t)).collect()).collect()
    };
    LogColumns {
        q_rad: each(&|j, t| POSE[j] + 0.1 * (t + j as f64).sin()),
        dq_rad_s: each(&|j, t| 0.1 * (t + j as f64).cos()),
        tau_j_nm: each(&|_, t| torque_nm * t.sin()),
        time_s: time_s.clone(),
        ..LogColumns::default()
    }
    .validate()
    .unwrap()
}

/// Torques of 1e200 Nm overflow when they are squared, and a log of ten rows gives no estimate.
#[test]
fn no_table_of_estimate_says_inf_or_nan() {
    let at = scratch();
    let at = at.path();
    write_csv(at.join("huge.csv"), &swinging(2_000, 1e200)).unwrap();
    write_csv(at.join("ten.csv"), &swinging(10, 1.0)).unwrap();
    for call in ["estimate huge.csv", "estimate huge.csv --residual momentum", "estimate ten.csv --residual ekf"] {
        let told = run(at, call).ok().stdout;
        let words = told.split(|letter: char| !letter.is_ascii_alphabetic());
        assert!(words.clone().all(|word| !["inf", "NaN", "nan"].contains(&word)), "{call}: {told}");
        assert!(told.split_whitespace().all(|word| word.len() < 60), "{call}: {told}");
    }
    let told = run(at, "estimate ten.csv --residual ekf").ok().stdout;
    assert!(told.contains("no figures: estimators settle for 0.5 s"), "{told}");
    let row = told.lines().find(|line| line.contains("Fx [N]")).unwrap();
    assert_eq!(row.split_whitespace().skip(3).collect::<Vec<_>>(), ["-"; 5], "{told}");
}

fn model(at: &Path, name: &str, more: &str) {
    let joints = "  - {coulomb_nm: 1, viscous_nm_s_per_rad: 1}\n".repeat(7);
    let head = "schema: tribo.model/1\nrobot: panda\nfriction:\n  law: coulomb_viscous\n  joints:\n";
    std::fs::write(at.join(name), format!("{head}{joints}{more}")).unwrap();
}

/// What is in the log's torque alone, or nowhere, is said; what is said to be in the log is there.
#[test]
fn simulate_says_what_it_leaves_out() {
    let at = scratch();
    let at = at.path();
    std::fs::write(at.join("exact.yaml"), "schema: tribo.tune/1\nmodel_error: {noise_factor: 0}\n").unwrap();
    model(at, "plain.yaml", "");
    model(
        at,
        "gain.yaml",
        "effects:\n- {cause: torque_gain, joint: 1, gain_error: 0.2}\n- {cause: torque_gain, joint: 3, gain_error: -0.1}\n",
    );
    model(at, "late.yaml", "effects: [{cause: time_delay, delay_s: 0.01}]\n");
    model(at, "early.yaml", "effects: [{cause: time_delay, delay_s: -0.01}]\n");
    let told = |name: &str| {
        let run = run(at, &format!("simulate exact.yaml --truth {name}.yaml --log {name}.csv --json")).ok();
        let document = run.json();
        (run.stderr, document["not_simulated"].clone(), read_log(at.join(format!("{name}.csv"))).unwrap().0)
    };
    let (plain, gain, late, early) = (told("plain"), told("gain"), told("late"), told("early"));
    assert!(plain.0.is_empty() && plain.1.is_null(), "{plain:?}");
    let where_it_is = "is simulated in tau_J of the log alone";
    assert!(
        gain.0.contains(&format!("tribo: torque_gain of panda_joint2 (1) and panda_joint4 (3) {where_it_is}")),
        "{}",
        gain.0
    );
    assert!(late.0.contains(&format!("tribo: time_delay {where_it_is}")), "{}", late.0);
    assert!(early.0.contains("tribo: time_delay below zero is not simulated"), "{}", early.0);
    let tuned = run(at, "tune --truth late.yaml --trials 1 --out tuned --json").ok();
    assert!(tuned.stderr.contains(&format!("tribo: time_delay {where_it_is}")), "{tuned:?}");
    assert!(tuned.json()["not_simulated"][0].as_str().unwrap().starts_with("time_delay"), "{tuned:?}");
    assert_eq!(early.1.as_array().unwrap().len(), 1);
    assert_eq!(early.2, plain.2);
    // Without noise: a torque that is a fifth larger, and one that is that of ten periods ago.
    let (whole, scaled) = (&plain.2.tau_j_nm[1], &gain.2.tau_j_nm[1]);
    assert!(whole.iter().zip(scaled).all(|(a, b)| (1.2 * a - b).abs() < 1e-9));
    let late = &late.2.tau_j_nm[1];
    assert!(late[11..].iter().zip(&whole[1..]).all(|(a, b)| (a - b).abs() < 1e-9));
    // Quiet says nothing.
    assert_eq!(run(at, "simulate --truth gain.yaml --json --quiet").ok().stderr, "");
}

/// The file about a preset says where the arm starts, and that its rotors weigh nothing.
#[test]
fn poses_and_weightless_rotors_of_a_truth_count() {
    let at = scratch();
    let at = at.path();
    model(at, "posed.yaml", "poses_rad:\n- [0.3, -0.5, 0.1, -2, 0.2, 1.6, 0.4]\n");
    run(at, "simulate --truth posed.yaml --log posed.csv --json --quiet").ok();
    let start = read_log(at.join("posed.csv")).unwrap().0;
    for (j, expected) in [0.3, -0.5, 0.1, -2.0, 0.2, 1.6, 0.4].into_iter().enumerate() {
        assert!((start.q_rad[j][0] - expected).abs() < 1e-3, "joint {j}: {}", start.q_rad[j][0]);
    }

    model(at, "rotors.yaml", "");
    model(at, "weightless.yaml", "rotor_inertia_kg_m2: [0, 0, 0, 0, 0, 0, 0]\n");
    model(at, "light.yaml", "rotor_inertia_kg_m2: [1e-9, 0, 0, 0, 0, 0, 0]\n");
    let cost =
        |name: &str| run(at, &format!("simulate --truth {name} --json --quiet")).ok().json()["cost"].as_f64().unwrap();
    let [rotors, weightless, light] = ["rotors.yaml", "weightless.yaml", "light.yaml"].map(cost);
    // One of 1e-9 kg m² counted before: none at all is next to it, and not what the preset says.
    assert!((weightless - light).abs() < 1e-3 * light, "{weightless} {light}");
    assert!((rotors - light).abs() > 1e-3 * light, "{rotors} {light}");
}
