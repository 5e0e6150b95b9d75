//! Story: exported URDF and MJCF are the believed arm with its friction.
//!
//! Witnesses: `urdf-rs` through our own reader, always; Pinocchio and MuJoCo where a Python has them (`TRIBO_PYTHON`).

#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{Draws, exported, largest_nm, laws, model, output, python, tuned};
use nalgebra::{Matrix3, Rotation3, SVector, Vector3};
use serde_json::{Value, json};
use tribo_export::{ExportError, Format, TunedCompensator, export};
use tribo_friction::law::{CoulombViscous, GazSigmoid, Stribeck};
use tribo_friction::{FrictionModel, VelocitySource};
use tribo_model::TunedFile;
use tribo_robot::DescribedArm;
use tribo_robot::urdf::{self, to_urdf};
use tribo_robot::{Arm, bias_torque, mass_matrix, presets};

/// Of the largest element of the mass matrix, and of the bias.
const TOLERANCE: f64 = 1e-9;
/// A name that ends comments, strings, elements and lines.
const ODD_NAME: &str = "a\"b'<&> --> */ ??/\\\n\t// \u{202e}τ {0}";

/// The robot whose links no body could be.
const IMPOSSIBLE: &str = "impossible";

/// Payload, tilt, heavier link, rotors, spring.
const RIGID: &str = "\
robot: panda
payload: {mass_kg: 1.3, com_m: [0.01, -0.02, 0.08]}
effects:
- {cause: base_tilt, angle_rad: 0.3, axis: [0.6, 0.8, 0.0]}
- {cause: link_inertial, link: 3, delta_mass_kg: 0.4, delta_first_moment_kg_m: [0.01, 0.0, 0.02]}
- {cause: rotor_inertia, joint: 5, delta_rotor_inertia_kg_m2: 0.1}
- {cause: position_spring, joint: 2, stiffness_nm_per_rad: 3.5, rest_rad: 0.4}
";

/// The odd arm that Pinocchio's reference numbers are about: turned axes, welded links, own joint names. Its moments of
/// inertia are drawn, and no body has such; `tr(I) 1 − I` of any is one that a body can have.
fn odd_urdf(possible: bool) -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/reference/odd_urdf_dynamics.json");
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path).expect("there")).expect("JSON");
    let text = file["urdf"].as_str().expect("a URDF");
    if !possible {
        return text.to_owned();
    }
    let mut odd = urdf::parse(text, None, None).expect("a URDF").arm::<7>().expect("seven joints");
    odd.arm = odd.arm.altered(|mechanism| {
        for link in &mut mechanism.links {
            link.inertia_kg_m2 = Matrix3::identity() * link.inertia_kg_m2.trace() - link.inertia_kg_m2;
        }
    });
    odd.to_urdf()
}

/// Tuned files of all presets, of an extended model, and of URDF arms with odd axes and an odd name.
fn robots() -> Vec<TunedFile> {
    let mut files = Vec::new();
    for name in presets::NAMES {
        let joints = presets::find(name).map(|preset| preset.joints());
        files.push(match joints {
            Some(6) => tuned(name, laws::<6>()[0], VelocitySource::Hybrid),
            _ => tuned(name, laws::<7>()[1], VelocitySource::Hybrid),
        });
    }
    let with_model = |text: &str, robot: &str, urdf: Option<String>| {
        let mut file = tuned(robot, laws::<7>()[0], VelocitySource::Measured);
        let mut model = model(text);
        model.urdf = urdf;
        file.model = Some(model);
        file
    };
    files.push(with_model(RIGID, "panda", None));
    let odd = "robot: odd.urdf\nrotor_inertia_kg_m2: [0.1, 0, 0.2, 0, 0.1, 0.1, 0.1]\n";
    files.push(with_model(odd, IMPOSSIBLE, Some(odd_urdf(false))));
    files.push(with_model(odd, "odd", Some(odd_urdf(true))));
    // A point, and a rod that is askew: bodies without extent in some direction.
    let turn = Rotation3::from_euler_angles(0.3, -0.7, 1.1).into_inner();
    let thin = presets::panda().altered(|thin| {
        thin.links[6].inertia_kg_m2 = Matrix3::zeros();
        thin.links[4].inertia_kg_m2 = turn * Matrix3::from_diagonal(&Vector3::new(0.03, 0.03, 0.0)) * turn.transpose();
    });
    files.push(with_model("robot: thin.urdf\n", "thin", Some(to_urdf(&thin))));
    let mut arm = presets::panda();
    ODD_NAME.clone_into(&mut arm.name);
    files.push(with_model("robot: odd_name.urdf\n", ODD_NAME, Some(to_urdf(&arm))));
    files
}

/// States of an arm and what its mass matrix and bias torque are there, as Python takes them.
fn cases<const N: usize>(arm: &Arm<N>) -> Value {
    let mut draws = Draws::new(5);
    let case = |_| {
        let q = SVector::<f64, N>::from_fn(|_, _| draws.between(-2.0, 2.0));
        let qd = SVector::<f64, N>::from_fn(|_, _| draws.between(-2.0, 2.0));
        let mass = mass_matrix(arm, &q);
        json!({"q": q.as_slice(), "qd": qd.as_slice(), "M": mass.as_slice(), "bias": bias_torque(arm, &q, &qd).as_slice()})
    };
    (0..20).map(case).collect()
}

/// What Python is to find in the file of one robot.
fn expectation<const N: usize>(tuned: &TunedFile, rotors: bool) -> Value {
    let it = TunedCompensator::<N>::of(tuned).expect("valid");
    let arm = it.arm.expect("known");
    let seen = if rotors { arm.clone() } else { arm.clone().link_side() };
    let spring = |j: usize| (it.compensator.effects[j].spring_nm_per_rad, it.compensator.effects[j].spring_rest_rad);
    let names = it.joint_names.unwrap_or_else(|| std::array::from_fn(|j| format!("joint_{}", j + 1)));
    json!({
        "cases": cases(&seen), "names": names.to_vec(), "gravity": arm.gravity_m_s2.as_slice(),
        "armature": arm.rotor_inertia_kg_m2.as_slice(),
        "range": [arm.limits.q_min_rad.as_slice(), arm.limits.q_max_rad.as_slice()],
        "torque": arm.limits.tau_max_nm.as_slice(),
        "stiffness": (0..N).map(|j| spring(j).0).collect::<Vec<_>>(),
        "rest": (0..N).map(|j| spring(j).1).collect::<Vec<_>>(),
        "pose": it.pose_rad.expect("known").as_slice(),
    })
}

/// `damping` and `friction` of the file, read by our own reader of URDF.
fn friction_of_urdf(text: &str) -> [Vec<f64>; 2] {
    fn of<const N: usize>(arm: DescribedArm<N>) -> [Vec<f64>; 2] {
        [arm.viscous_nm_s_per_rad.to_vec(), arm.coulomb_nm.to_vec()]
    }
    let chain = urdf::parse(text, None, None).expect("a URDF");
    match chain.joints() {
        6 => of(chain.arm::<6>().expect("six")),
        _ => of(chain.arm::<7>().expect("seven")),
    }
}

/// Runs a script with the expectation as its last argument; it prints the largest errors by name.
#[track_caller]
fn errors(at: &Path, python: &str, script: &str, expectation: &Value) -> Vec<(String, f64)> {
    std::fs::write(at.join("expected.json"), expectation.to_string()).expect("written");
    let printed: Value = serde_json::from_slice(&output(at, python, &["-c", script])).expect("JSON");
    printed.as_object().expect("errors").iter().map(|(k, v)| (k.clone(), v.as_f64().expect("a number"))).collect()
}

/// Loads model.urdf; prints its largest errors.
const PINOCCHIO: &str = r#"
import json, numpy as np, pinocchio as pin
e = json.load(open("expected.json"))
m = pin.buildModelFromXML(open("model.urdf", encoding="utf-8").read())
m.gravity.linear = np.array(e["gravity"])
d = m.createData()
mass = bias = 0.0
for c in e["cases"]:
    q, v = np.array(c["q"]), np.array(c["qd"])
    upper = np.triu(pin.crba(m, d, q))
    M = upper + np.triu(upper, 1).T
    want = np.array(c["M"]).reshape(M.shape)
    mass = max(mass, abs(M - want).max() / abs(want).max())
    b = pin.nle(m, d, q, v)
    bias = max(bias, abs(b - c["bias"]).max() / abs(np.array(c["bias"])).max())
friction = getattr(m, "upperDryFrictionLimit", None)
friction = m.friction if friction is None else friction
print(json.dumps({
    "mass": mass, "bias": bias,
    "damping": abs(m.damping - e["damping"]).max(), "friction": abs(friction - e["friction"]).max(),
    "range": max(abs(m.lowerPositionLimit - e["range"][0]).max(), abs(m.upperPositionLimit - e["range"][1]).max()),
    "torque": abs(m.effortLimit - e["torque"]).max(),
    "names": float(list(m.names)[1:] != e["names"]),
}))
"#;

/// Loads model.xml; prints its largest errors. Passive torque is damping and springs; at the ready pose nothing touches.
const MUJOCO: &str = r#"
import json, numpy as np, mujoco
e = json.load(open("expected.json"))
m = mujoco.MjModel.from_xml_path("model.xml")
d = mujoco.MjData(m)
n = m.nv
mass = bias = passive = 0.0
for c in e["cases"]:
    d.qpos[:], d.qvel[:] = c["q"], c["qd"]
    mujoco.mj_forward(m, d)
    M = np.zeros((n, n))
    for j in range(n):
        column = np.zeros(n)
        mujoco.mj_mulM(m, d, column, np.eye(n)[j])
        M[:, j] = column
    want = np.array(c["M"]).reshape(n, n)
    mass = max(mass, abs(M - want).max() / abs(want).max())
    bias = max(bias, abs(d.qfrc_bias - c["bias"]).max() / abs(np.array(c["bias"])).max())
    spring = np.array(e["stiffness"]) * (np.array(c["q"]) - e["rest"])
    passive = max(passive, abs(d.qfrc_passive + np.array(e["damping"]) * c["qd"] + spring).max())
mujoco.mj_resetDataKeyframe(m, d, 0)
mujoco.mj_forward(m, d)
limits = sum(int(kind != mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF) for kind in d.efc_type)
print(json.dumps({
    "mass": mass, "bias": bias, "passive": passive,
    "damping": abs(m.dof_damping.ravel()[:n] - e["damping"]).max(), "friction": abs(m.dof_frictionloss - e["friction"]).max(),
    "armature": abs(m.dof_armature - e["armature"]).max(),
    "range": abs(m.jnt_range.T - e["range"]).max(),
    "torque": abs(m.actuator_ctrlrange[:, 1] - e["torque"]).max() + abs(m.actuator_ctrlrange.sum(1)).max(),
    "pose": abs(d.qpos - e["pose"]).max(), "touching": float(limits + d.ncon),
    "names": float([m.joint(j).name for j in range(n)] != e["names"]),
}))
"#;

#[track_caller]
fn hold(program: &str, robot: &str, errors: &[(String, f64)]) {
    println!(
        "{program}, {robot:?}: {}",
        errors.iter().map(|(name, off)| format!("{name} {off:.1e}")).collect::<Vec<_>>().join(", ")
    );
    assert!(errors.len() >= 7);
    for (name, off) in errors {
        assert!(*off <= TOLERANCE, "{program}, {robot:?}: {name} is off by {off}");
    }
}

#[test]
fn urdf_and_mjcf_are_the_arm_with_its_friction() {
    let at = tempfile::tempdir().expect("a directory");
    let at = at.path();
    let pinocchio = python("pinocchio", "exported URDF is UNTESTED against Pinocchio");
    let mujoco = python("mujoco", "exported MJCF is UNTESTED against MuJoCo");
    for file in robots() {
        let expectation = |rotors| match file.joints() {
            6 => expectation::<6>(&file, rotors),
            _ => expectation::<7>(&file, rotors),
        };
        let urdf = exported(&file, Format::Urdf, None).text;
        let [damping, friction] = friction_of_urdf(&urdf);
        let laws = &file.friction.joints;
        for (j, law) in laws.iter().enumerate() {
            // The curve of the Stribeck law here has faded long before the speed limit.
            assert_eq!(law.viscous_nm_s_per_rad, Some(damping[j]));
            let coulomb_nm = law.coulomb_nm.expect("a dry law");
            assert!((coulomb_nm - friction[j]).abs() < 1e-6, "{coulomb_nm} {}", friction[j]);
        }
        let with_friction = |mut expectation: Value| {
            (expectation["damping"], expectation["friction"]) = (json!(damping), json!(friction));
            expectation
        };
        if let Some(python) = &pinocchio {
            std::fs::write(at.join("model.urdf"), &urdf).expect("written");
            hold("Pinocchio", &file.robot, &errors(at, python, PINOCCHIO, &with_friction(expectation(false))));
        }
        if file.robot == IMPOSSIBLE {
            let refusal = export(&file, Format::Mjcf, None).expect_err("refused").to_string();
            assert!(refusal.starts_with("joint 4: link of 1.633693 kg with moments of inertia [0.03"), "{refusal}");
            continue;
        }
        let mjcf = exported(&file, Format::Mjcf, None).text;
        if let Some(python) = &mujoco {
            std::fs::write(at.join("model.xml"), &mjcf).expect("written");
            hold("MuJoCo", &file.robot, &errors(at, python, MUJOCO, &with_friction(expectation(true))));
        }
    }
}

/// Closed forms of what two numbers per joint cannot say, at a speed limit of 2.175 rad/s.
#[test]
fn losses_say_how_much_torque_they_are_worth() {
    let close = |seen: f64, want: f64| assert!((seen - want).abs() < 1e-3 * want.abs().max(1e-6), "{seen} {want}");
    let law = Stribeck {
        coulomb_nm: 0.5,
        viscous_nm_s_per_rad: 1.0,
        breakaway_minus_coulomb_nm: 0.3,
        inverse_stribeck_velocity_s_per_rad: 8.0,
        shape: 1.6,
    };
    let file = tuned("panda", FrictionModel::<7>::uniform(law.into()), VelocitySource::Hybrid);
    let urdf = exported(&file, Format::Urdf, None);
    close(largest_nm(&urdf, "Stribeck curve")[0], 0.3);
    // A curve that never fades is Coulomb friction: dF exp(0) with an infinite Stribeck velocity.
    let flat = Stribeck { inverse_stribeck_velocity_s_per_rad: 0.0, ..law };
    let file = tuned("panda", FrictionModel::<7>::uniform(flat.into()), VelocitySource::Hybrid);
    let urdf = exported(&file, Format::Urdf, None);
    assert!((friction_of_urdf(&urdf.text)[1][0] - 0.8).abs() < 1e-12);
    assert!(urdf.losses.iter().all(|loss| loss.largest_nm.is_none()), "{:?}", urdf.losses);

    // A steep sigmoid is dry friction of half its height; a shallow one is viscous friction φ1 φ2/4.
    let sigmoid = |phi2_s_per_rad: f64| {
        let law = GazSigmoid { phi1_nm: 1.2, phi2_s_per_rad, phi3_rad_s: 0.0 };
        exported(&tuned("panda", FrictionModel::<7>::uniform(law.into()), VelocitySource::Hybrid), Format::Mjcf, None)
            .text
    };
    let attribute = |text: &str, name: &str| -> f64 {
        let from = text.find(&format!(" {name}=\"")).expect(name) + name.len() + 3;
        text[from..from + text[from..].find('"').expect("its end")].parse().expect("a number")
    };
    close(attribute(&sigmoid(1e4), "frictionloss"), 0.6);
    close(attribute(&sigmoid(1e-2), "damping"), 1.2 * 1e-2 / 4.0);

    // A narrow curve over speed is Coulomb friction, one that hardly bends within the speed limit is viscous friction A/w.
    let mut file = tuned("panda", laws::<7>()[0], VelocitySource::Hybrid);
    let plain = friction_of_urdf(&exported(&file, Format::Urdf, None).text);
    let curves = "- {cause: friction_curve, joint: 0, amplitude_nm: 0.3, width_rad_s: 1e-4}\n\
                  - {cause: friction_curve, joint: 1, amplitude_nm: 40, width_rad_s: 80}\n";
    file.model = Some(model(&format!("robot: panda\neffects:\n{curves}")));
    let urdf = exported(&file, Format::Urdf, None);
    let [damping, friction] = friction_of_urdf(&urdf.text);
    close(friction[0], plain[1][0] + 0.3);
    close(damping[0], plain[0][0]);
    close(friction[1], plain[1][1]);
    close(damping[1], plain[0][1] + 0.5);
    assert_eq!((&damping[2..], &friction[2..]), (&plain[0][2..], &plain[1][2..]));
    // All of it at speeds far below the narrow curve's width, where friction of the description has its step.
    close(largest_nm(&urdf, "curve over speed")[0], 0.3);

    file.model = Some(model(&format!("robot: panda\n{}", crate::common::EFFECTS)));
    let lost = |format| exported(&file, format, None);
    let urdf = lost(Format::Urdf);
    close(largest_nm(&urdf, "torque offset")[0], 0.5);
    close(largest_nm(&urdf, "friction that grows")[1], 0.06 * 87.0);
    close(largest_nm(&urdf, "torque ripple")[3], 0.1);
    close(largest_nm(&urdf, "position spring")[5], 1.1 * (3.7525 + 1.2));
    let coulomb_nm = file.friction.joints[4].coulomb_nm.expect("dry");
    close(largest_nm(&urdf, "presliding")[4], 2.0 * (coulomb_nm + 0.06));
    // Parts below zero pull the other way.
    close(largest_nm(&urdf, "presliding")[1], 2.0 * 0.3);
    close(largest_nm(&urdf, "Stribeck curve and difference")[3], 0.3);
    close(largest_nm(&urdf, "Stribeck curve and difference")[4], 0.04);
    // MuJoCo has springs.
    assert!(lost(Format::Mjcf).losses.iter().all(|loss| loss.lost != "position spring"));
    assert!(lost(Format::Mjcf).text.contains(" stiffness=\"1.1\" springref=\"-1.2\""));
    // Each loss is in the file too.
    for loss in &urdf.losses {
        let words = loss.lost.split([' ', ':', '"']).next().expect("a word");
        assert!(urdf.text.contains(&format!("Not in this file: {words}")), "{loss}");
    }
}

#[test]
fn what_cannot_be_represented_is_refused() {
    let refused = |file: &TunedFile, format| export(file, format, None).expect_err("refused").to_string();
    let plain = |robot: &str| {
        let law = CoulombViscous { coulomb_nm: 0.1, viscous_nm_s_per_rad: 0.2 };
        tuned(robot, FrictionModel::<7>::uniform(law.into()), VelocitySource::Hybrid)
    };
    let mut below_zero = plain("panda");
    below_zero.model = Some(model("robot: panda\neffects:\n- {cause: coulomb, joint: 2, delta_coulomb_nm: -0.4}\n"));
    for format in [Format::Urdf, Format::Mjcf, Format::Crisp] {
        let said = refused(&below_zero, format);
        assert!(said.starts_with("joint 2: Coulomb friction is -0.3"), "{said}");
    }
    let unknown = plain("my_arm");
    for format in [Format::Urdf, Format::Mjcf, Format::Crisp] {
        assert!(matches!(export(&unknown, format, None), Err(ExportError::UnknownArm { .. })));
    }
    for format in [Format::Yaml, Format::Json, Format::Ros2, Format::C, Format::Rust] {
        exported(&unknown, format, None);
    }
}
