//! Story: arms that are no Panda — six joints, seven, from a preset or from a URDF — go the whole way.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::{Path, PathBuf};

use crate::common::{journal, result, run, scratch};
use crate::python_witness::{answer, python};
use serde_json::Value;
use tribo_robot::presets;
use tribo_robot::urdf::to_urdf;

/// J of the best trial over that without compensation, and over that of the true friction.
fn ratios(document: &Value) -> [f64; 2] {
    let best = document["best"]["cost"].as_f64().unwrap_or(f64::INFINITY);
    ["uncompensated_cost", "oracle_cost"].map(|cost| best / document[cost].as_f64().unwrap())
}

/// A campaign of the six-joint arm: tuned as well as by an oracle, resumed to the same bits, told and drawn.
#[test]
fn a_campaign_of_the_ur10e_goes_the_whole_way() {
    let at = scratch();
    let whole = run(at.path(), "tune --robot ur10e --trials 5 --out whole --json --quiet").ok().json();
    let [against_nothing, against_oracle] = ratios(&whole);
    println!("J / J uncompensated = {against_nothing:.3}, J / J oracle = {against_oracle:.3}");
    assert!(against_nothing < 0.15 && against_oracle < 1.1, "{against_nothing} {against_oracle}");
    assert_eq!(whole["robot"], "ur10e");
    let params = whole["params"].as_object().unwrap();
    assert_eq!(params.len(), 6);
    // The friction of the preset is found where the joint slides: 6.6 Nm in joint 1 of the truth.
    let coulomb = params["joint_1"]["coulomb_nm"].as_f64().unwrap();
    assert!((coulomb - 6.6).abs() < 0.4, "{coulomb} Nm");
    let trials = journal(&at.path().join("whole"));
    assert!(
        trials[0].params.contains_key("joint_5.coulomb_nm") && !trials[0].params.contains_key("joint_6.coulomb_nm")
    );
    let settings = std::fs::read_to_string(at.path().join("whole/campaign.yaml")).unwrap();
    assert!(settings.contains("robot: ur10e\n"), "{settings}");

    // Stopped after three trials and resumed, it ends with the same bits.
    run(at.path(), "tune --robot ur10e --trials 3 --out parts --json --quiet").ok();
    let resumed = run(at.path(), "tune --resume --trials 5 --out parts --json --quiet").ok().json();
    assert_eq!(result(&whole), result(&resumed));
    let refused = run(at.path(), "tune --resume --robot panda --out parts");
    assert!(refused.code == Some(2) && refused.stderr.contains("--robot"), "{refused:?}");

    // Report, export, window.
    run(at.path(), "report whole").ok();
    let page = std::fs::read_to_string(at.path().join("whole/report.html")).unwrap();
    assert!(page.contains("robot: ur10e") && page.contains("Torque by term, wrist_3_joint (5)"));
    assert!(!page.contains("Torque by term, joint"));
    let tuned = run(at.path(), "export whole --format json").ok().json();
    assert_eq!(
        (tuned["robot"].as_str(), tuned["friction"]["joints"].as_array().map(Vec::len)),
        (Some("ur10e"), Some(6))
    );
    for view in ["campaign", "trial", "arm"] {
        run(at.path(), &format!("dashboard whole --view {view} --screenshot {view}.png")).ok();
    }

    // The tuned parameters drive the arm.
    let cost = |call: &str| run(at.path(), call).ok().json()["cost"].as_f64().unwrap();
    let tuned = cost("simulate --robot ur10e --compensation whole/tuned.yaml --seed 3 --json");
    let none = cost("simulate --robot ur10e --compensation none --seed 3 --json");
    assert!(tuned < 0.15 * none, "{tuned} {none}");
}

/// A log of the six-joint arm is read by estimators, diagnosis and window; nobody takes it for a Panda's.
#[test]
fn a_log_of_the_ur10e_is_read() {
    let at = scratch();
    let call = "simulate --robot ur10e --compensation oracle --pulse-force 15 --log pushed.csv --seed 2 --json";
    run(at.path(), call).ok();
    run(at.path(), "simulate --robot ur10e --compensation oracle --log free.csv --seed 3 --json").ok();
    for call in ["estimate pushed.csv", "diagnose pushed.csv"] {
        let refused = run(at.path(), call);
        assert_eq!(refused.code, Some(2), "{refused:?}");
        for part in ["pushed.csv", "6 joints", "--robot", "--model"] {
            assert!(refused.stderr.contains(part), "{refused:?}");
        }
    }
    let refused = run(at.path(), "estimate pushed.csv --robot iiwa14");
    assert!(refused.code == Some(2) && refused.stderr.contains("6 joints; the model has 7"), "{refused:?}");

    // The model with the true friction sees the push of 15 N to a few newtons with a robot that stands still or slides.
    std::fs::write(at.path().join("ur10e.yaml"), UR10E).unwrap();
    let seen =
        run(at.path(), "estimate pushed.csv --model ur10e.yaml --free free.csv --residual all --json").ok().json();
    for name in ["ekf", "momentum", "qp", "thermal"] {
        let error = seen["estimators"][name]["rmse_force_n"].as_f64().unwrap();
        assert!(error < 5.0, "{name}: {error} N");
    }

    // Held against the bare arm, a motion of all joints shows the friction that was put into them, and nothing else.
    std::fs::write(at.path().join("move.yaml"), MOVE).unwrap();
    run(at.path(), "simulate --robot ur10e --trajectory move.yaml --compensation oracle --log move.csv --seed 3").ok();
    let found = run(at.path(), "diagnose move.csv --robot ur10e --extend found.yaml --json --quiet").ok().json();
    assert_eq!(found["verdict"], "named", "{found}");
    let parameter = |label: &str, joint: usize, name: &str| {
        let mut findings = found["findings"].as_array().unwrap().iter();
        let finding = findings.find(|finding| finding["label"] == label && finding["joint"] == joint);
        finding
            .and_then(|finding| finding["params"][name].as_f64())
            .unwrap_or_else(|| panic!("{label} {joint}: {found}"))
    };
    for (joint, truth) in [6.6, 6.6, 3.0, 1.1, 1.1, 1.1].into_iter().enumerate() {
        let coulomb = parameter("coulomb", joint, "delta_coulomb_nm");
        let viscous = parameter("viscous", joint, "delta_viscous_nm_s_per_rad");
        assert!((coulomb - truth).abs() < 0.02 * truth, "joint {joint}: {coulomb} Nm, truth {truth} Nm");
        assert!((viscous - truth).abs() < 0.05 * truth, "joint {joint}: {viscous} Nm s/rad, truth {truth}");
    }
    let extended = run(at.path(), "simulate --robot ur10e --compensation found.yaml --seed 4 --json").ok().json();
    assert!(extended["cost"].as_f64().unwrap() < 7.0, "the oracle has 6.2: {extended}");
    run(at.path(), "dashboard free.csv --robot ur10e --view log --screenshot log.png").ok();
    run(at.path(), "dashboard free.csv --robot ur10e --view arm --screenshot arm.png").ok();
}

/// Every joint both ways, at several speeds.
const MOVE: &str = "\
schema: tribo.trajectory/1
robot: ur10e
via_points:
- {time_s: 0, q_rad: [0, -1.8, 2.0, -1.77, -1.57, 0]}
- {time_s: 2, q_rad: [0.8, -1.2, 1.4, -1.2, -0.9, 0.7]}
- {time_s: 5, q_rad: [-0.6, -2.0, 2.2, -2.2, -2.0, -0.8]}
- {time_s: 6.5, q_rad: [0.4, -1.4, 1.5, -1.4, -1.2, 0.5]}
- {time_s: 11, q_rad: [-0.3, -1.9, 2.1, -1.9, -1.8, -0.4]}
- {time_s: 13, q_rad: [0.7, -1.3, 1.2, -2.3, -1.0, 0.9]}
- {time_s: 15, q_rad: [-0.5, -1.8, 2.1, -1.3, -2.1, -0.6]}
- {time_s: 18, q_rad: [0.5, -1.1, 1.6, -2.0, -1.3, 0.4]}
- {time_s: 20, q_rad: [0, -1.8, 2.0, -1.77, -1.57, 0]}
";

/// The UR10e as the named truth `coulomb_viscous` has it.
const UR10E: &str = "\
schema: tribo.model/1
robot: ur10e
friction:
  law: coulomb_viscous
  joints:
  - {coulomb_nm: 6.6, viscous_nm_s_per_rad: 6.6}
  - {coulomb_nm: 6.6, viscous_nm_s_per_rad: 6.6}
  - {coulomb_nm: 3.0, viscous_nm_s_per_rad: 3.0}
  - {coulomb_nm: 1.1, viscous_nm_s_per_rad: 1.1}
  - {coulomb_nm: 1.1, viscous_nm_s_per_rad: 1.1}
  - {coulomb_nm: 1.1, viscous_nm_s_per_rad: 1.1}
";

/// Runs a campaign in which no trial may be stopped, nor the one with the true friction; J of the best trial is below these shares of J without
/// compensation and of J of the true friction.
#[track_caller]
fn tuned_well(at: &Path, name: &str, call: &str, below: [f64; 2]) {
    let document = run(at, call).ok().json();
    let [against_nothing, against_oracle] = ratios(&document);
    println!("{name}: J / J uncompensated = {against_nothing:.3}, J / J oracle = {against_oracle:.3}");
    assert!(against_nothing < below[0] && against_oracle < below[1], "{name}: {against_nothing} {against_oracle}");
    let stopped = document["trials"].as_array().unwrap().iter().any(|trial| trial["state"] != "complete");
    assert!(!stopped && document["oracle_failed"].is_null(), "{name}: {document}");
}

/// As well as the Panda, to the figures of docs/robots.md.
#[test]
fn every_other_arm_is_tuned() {
    let at = scratch();
    for robot in ["fr3", "ur3e", "ur5e", "xarm6", "xarm7", "kinova_gen3", "iiwa14"] {
        let call = format!("tune --robot {robot} --trials 4 --out {robot} --json --quiet");
        tuned_well(at.path(), robot, &call, [0.25, 1.12]);
    }
}

/// Folder of the robots that the package `example-robot-data` ships; none without it.
fn example_robots() -> Option<PathBuf> {
    let python = python("sysconfig", "arms that others describe are not tuned")?;
    let packages =
        answer(&python, "import json, sysconfig; print(json.dumps(sysconfig.get_paths()['purelib']))", &Value::Null);
    let robots = Path::new(packages.as_str()?).join("cmeel.prefix/share/example-robot-data/robots");
    robots.is_dir().then_some(robots)
}

/// Arms whose files somebody else wrote: a UFactory xArm 7 with 1 Nm s/rad and 1 Nm in every joint, a Unitree Z1.
#[test]
fn arms_that_others_describe_are_tuned() {
    let Some(robots) = example_robots() else {
        eprintln!("SKIPPED: no Python with example-robot-data (set TRIBO_PYTHON)");
        return;
    };
    let at = scratch();
    for (name, file) in [("xarm7", "xarm_description/urdf/xarm7.urdf"), ("z1", "z1_description/urdf/z1.urdf")] {
        let call = format!("tune --robot {} --out {name} --json --quiet", robots.join(file).display());
        tuned_well(at.path(), name, &call, [0.2, 1.1]);
    }
}

/// Writes the UR10e as `arms/arm.urdf`, friction included, and a model file beside it that puts in what a URDF cannot say.
fn urdf(at: &Path) {
    let mut text = to_urdf(&presets::ur10e()).replace("name=\"ur10e\"", "name=\"my_arm\"");
    for (friction, effort) in [(6.0, "330"), (3.0, "150"), (1.2, "56")] {
        let limit = format!("effort=\"{effort}\"/>");
        text = text.replace(&limit, &format!("{limit}<dynamics damping=\"{friction}\" friction=\"{friction}\"/>"));
    }
    std::fs::create_dir_all(at.join("arms")).unwrap();
    std::fs::write(at.join("arms/arm.urdf"), text).unwrap();
    let model = "schema: tribo.model/1\nrobot: arm.urdf\nrotor_inertia_kg_m2: [0.1, 0.1, 0.1, 0.1, 0.1, 0.1]\n\
                 poses_rad: [[0, -1.8, 2.0, -1.77, -1.57, 0]]\nlimits:\n  tau_rate_max_nm_s: [2000, 2000, 2000, 1000, 1000, 1000]\n";
    std::fs::write(at.join("arms/arm.yaml"), model).unwrap();
}

/// An arm from a URDF is a robot like any other, and a campaign does not need the file any more.
#[test]
fn an_arm_from_a_urdf_is_tuned_and_its_file_may_go() {
    let at = scratch();
    urdf(at.path());
    run(at.path(), "tune --model arms/arm.yaml --trials 2 --out mine --json --quiet").ok();
    run(at.path(), "tune --robot arms/arm.urdf --trials 1 --strategy zero --out bare --json --quiet").ok();
    run(at.path(), "simulate --robot arms/arm.urdf --log log.csv --quiet").ok();
    run(at.path(), "estimate log.csv --robot arms/arm.urdf --residual ekf --quiet").ok();
    std::fs::rename(at.path().join("arms"), at.path().join("moved")).unwrap();
    let tuned = run(at.path(), "tune --resume --trials 4 --out mine --json --quiet").ok().json();
    let [against_nothing, against_oracle] = ratios(&tuned);
    println!("J / J uncompensated = {against_nothing:.3}, J / J oracle = {against_oracle:.3}");
    assert!(against_nothing < 0.2 && against_oracle < 1.2, "{against_nothing} {against_oracle}");
    run(at.path(), "report mine").ok();
    let cost = |call: &str| run(at.path(), call).ok().json()["cost"].as_f64().unwrap();
    let call = "simulate --model moved/arm.yaml --compensation";
    assert!(
        cost(&format!("{call} none --json"))
            > 3.0 * cost("simulate --robot moved/arm.urdf --compensation oracle --json")
    );
}

#[test]
fn robots_that_cannot_be_are_refused() {
    let at = scratch();
    urdf(at.path());
    let write = |name: &str, text: &str| std::fs::write(at.path().join(name), text).unwrap();
    let good = std::fs::read_to_string(at.path().join("arms/arm.urdf")).unwrap();
    write("prismatic.urdf", &good.replacen("type=\"revolute\"", "type=\"prismatic\"", 1));
    write("torn.urdf", &good[..good.len() / 2]);
    write("bare.urdf", &to_urdf(&presets::ur10e()));
    write("prismatic.yaml", "schema: tribo.model/1\nrobot: prismatic.urdf\n");
    write("lost.yaml", "schema: tribo.model/1\nrobot: lost.urdf\n");
    write("tip.yaml", "schema: tribo.model/1\nrobot: arms/arm.urdf\ntip_link: nowhere\n");
    write("ends.yaml", "schema: tribo.model/1\nrobot: panda\ntip_link: flange\n");
    write("rotors.yaml", "schema: tribo.model/1\nrobot: ur10e\nrotor_inertia_kg_m2: [1, 1, 1, 1, 1, 1, 1]\n");
    write("limits.yaml", "schema: tribo.model/1\nrobot: ur10e\nlimits:\n  q_min_rad: [9, 0, 0, 0, 0, 0]\n");
    write("poses.yaml", "schema: tribo.model/1\nrobot: ur10e\nposes_rad:\n- [0, 0, 4, 0, 0, 0]\n");
    for (call, parts) in [
        (
            "tune --robot ur5",
            &["`robot` is ur5", "panda, fr3, ur3e, ur5e, ur10e, xarm6, xarm7, kinova_gen3, iiwa14", "URDF"][..],
        ),
        ("tune --robot prismatic.urdf", &["prismatic.urdf: joint `joint_1` is prismatic"]),
        ("tune --robot torn.urdf", &["torn.urdf: not a URDF"]),
        ("tune --robot bare.urdf", &["`truth` is coulomb_viscous", "the friction of this robot is not known"]),
        ("tune --robot ur10e --truth gaz", &["`truth` is gaz", "the friction of a Panda"]),
        ("tune --robot iiwa14 --strategy gaz", &["`strategy` is gaz", "one Panda"]),
        ("tune --model prismatic.yaml", &["prismatic.urdf: joint `joint_1` is prismatic"]),
        ("tune --model lost.yaml", &["lost.yaml:2: field `robot` is lost.urdf"]),
        ("tune --model tip.yaml", &["arm.urdf: tip_link `nowhere` is not among the links"]),
        ("tune --model ends.yaml", &["ends.yaml:3: field `tip_link` is flange", "URDF"]),
        ("tune --model rotors.yaml", &["rotors.yaml:3: field `rotor_inertia_kg_m2` is 7 entries; allowed: 6 entries"]),
        ("tune --model limits.yaml", &["limits.yaml:4: field `limits.q_min_rad` is 9"]),
        ("tune --model poses.yaml", &["poses.yaml:4: field `poses_rad[0]` is 4", "joint 2"]),
        ("tune --robot panda --model poses.yaml", &["poses.yaml"]),
        ("tune --robot panda --truth arms/arm.yaml", &["`truth` is about a robot with 6 joints", "7 joints"]),
    ] {
        let refused = run(at.path(), &format!("{call} --out never --trials 1 --quiet"));
        assert_eq!(refused.code, Some(2), "{call}: {refused:?}");
        for part in parts {
            assert!(refused.stderr.contains(part), "{call}: {refused:?} lacks {part}");
        }
        assert!(!at.path().join("never").exists(), "{call} left something");
    }
}

/// An arm of six hinges as MJCF, with a gripper, in two files.
fn mjcf(at: &Path) {
    let mut bodies = String::new();
    for (k, (axis, length, mass)) in [
        ("0 0 1", 0.15, 4.0),
        ("0 1 0", 0.4, 8.0),
        ("0 1 0", 0.35, 4.0),
        ("0 1 0", 0.1, 1.5),
        ("0 0 1", 0.1, 1.5),
        ("0 1 0", 0.1, 0.6),
    ]
    .into_iter()
    .enumerate()
    {
        let below = [0.1, 0.15, 0.4, 0.35, 0.1, 0.1][k];
        let class = if k < 3 { "large" } else { "small" };
        bodies += &format!(
            "<body name=\"link_{k}\" pos=\"0 0 {below}\"><joint name=\"turn_{k}\" class=\"{class}\" axis=\"{axis}\"/>\
             <geom type=\"capsule\" fromto=\"0 0 0 0 0 {length}\" size=\"0.05\" mass=\"{mass}\"/>"
        );
    }
    let finger = |name: &str| {
        format!("<body name=\"{name}\"><joint name=\"{name}\" type=\"slide\"/><geom size=\"0.02\"/></body>")
    };
    let drives: String = (0..6)
        .map(|k| format!("<motor joint=\"turn_{k}\" ctrlrange=\"-1 1\" gear=\"{}\"/>", if k < 3 { 200 } else { 60 }))
        .collect();
    let model = format!(
        "<mujoco model=\"six\"><include file=\"classes.xml\"/><worldbody><body name=\"base\">{bodies}<site name=\"tool\" pos=\"0 0 0.2\"/>{}{}{}</worldbody>\
         <actuator>{drives}</actuator></mujoco>",
        finger("left"),
        finger("right"),
        "</body>".repeat(7)
    );
    let classes = "<mujoco><default><default class=\"large\"><joint armature=\"0.2\" damping=\"2\" frictionloss=\"3\" range=\"-160 160\"/></default>\
                   <default class=\"small\"><joint armature=\"0.05\" damping=\"0.6\" frictionloss=\"0.9\" range=\"-160 160\"/></default></default></mujoco>";
    std::fs::create_dir_all(at.join("arms")).unwrap();
    std::fs::write(at.join("arms/six.xml"), model).unwrap();
    std::fs::write(at.join("arms/classes.xml"), classes).unwrap();
}

/// An arm from an MJCF is a robot like any other: tuned, simulated, diagnosed, exported, and no longer in need of its files.
#[test]
fn an_arm_from_an_mjcf_is_tuned_and_diagnosed() {
    let at = scratch();
    mjcf(at.path());
    let said = run(at.path(), "tune --robot arms/six.xml --trials 2 --out mine --json").ok().stderr;
    for part in [
        "six.xml: held where the file draws them",
        "left, right",
        "six.xml: no speed limit of 6 joints, `turn_0` to `turn_5`",
    ] {
        assert!(said.contains(part), "{said:?} lacks {part:?}");
    }
    assert!(!said.contains("no torque limit"), "{said}");
    run(at.path(), "simulate --robot arms/six.xml --tip-link tool --log log.csv --quiet").ok();
    let diagnosis = run(at.path(), "diagnose log.csv --robot arms/six.xml --tip-link tool --json --quiet").ok().json();
    assert_ne!(diagnosis["verdict"], "nothing_missing", "{diagnosis}");
    std::fs::rename(at.path().join("arms"), at.path().join("moved")).unwrap();
    let tuned = run(at.path(), "tune --resume --trials 3 --out mine --json --quiet").ok().json();
    let [against_nothing, against_oracle] = ratios(&tuned);
    println!("J / J uncompensated = {against_nothing:.3}, J / J oracle = {against_oracle:.3}");
    assert!(against_nothing < 0.3 && against_oracle < 1.3, "{against_nothing} {against_oracle}");
}

/// A robot goes from one format into another without a campaign, and stays what it is.
#[test]
fn robots_are_exported_without_a_campaign() {
    let at = scratch();
    mjcf(at.path());
    run(at.path(), "export --robot arms/six.xml --format urdf --out six.urdf --quiet").ok();
    run(at.path(), "export --robot six.urdf --format mjcf --out again.xml --quiet").ok();
    let read = |file: &str| {
        let text = std::fs::read_to_string(at.path().join(file)).unwrap();
        tribo_robot::parse_description(&text, None, None).unwrap().arm::<6>().unwrap()
    };
    let (urdf, again) = (read("six.urdf"), read("again.xml"));
    assert_eq!(urdf.joint_names, again.joint_names);
    assert_eq!(
        (urdf.coulomb_nm, urdf.viscous_nm_s_per_rad),
        ([3.0, 3.0, 3.0, 0.9, 0.9, 0.9], [2.0, 2.0, 2.0, 0.6, 0.6, 0.6])
    );
    assert_eq!(urdf.coulomb_nm, again.coulomb_nm);
    assert_eq!(urdf.arm.limits.tau_max_nm, again.arm.limits.tau_max_nm);
    let q = urdf.arm.limits.q_min_rad * 0.3;
    let mass = |arm| tribo_robot::mass_matrix(arm, &q);
    assert!((mass(&urdf.arm) - mass(&again.arm)).amax() < 1e-9);
    let losses = run(at.path(), "export --robot ur5e --format urdf --json").ok().json()["losses"].to_string();
    assert!(losses.contains("rotor inertia") && !losses.contains("velocity source"), "{losses}");
    for (call, part) in [
        ("export --robot ur5e --format c", "about a tuned compensator"),
        ("export --format mjcf", "<SOURCE>"),
        ("export --robot nothing --format mjcf", "field `robot` is nothing"),
        ("export --robot ur5e --tip-link tool0 --format mjcf", "only where robot is a URDF or MJCF"),
        ("export campaigns/0001 --robot ur5e --format mjcf", "cannot be used with"),
        ("export --robot arms/six.xml --tip-link left --format mjcf", "`left` is prismatic (slide)"),
        ("tune --tip-link tool", "--robot"),
    ] {
        let refused = run(at.path(), &format!("{call} --out never"));
        assert_eq!(refused.code, Some(2), "{call}: {refused:?}");
        assert!(refused.stderr.contains(part), "{call}: {refused:?} lacks {part}");
        assert!(!at.path().join("never").exists());
    }
}
