//! Story: exported ROS 2 parameters are read back to the same numbers, and CRISP's sigmoid is the friction it can be.
//!
//! Witnesses: serde, always; PyYAML, whose YAML 1.1 is that of ROS launch files, where a Python has it (`TRIBO_PYTHON`).

#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use crate::common::{EFFECTS, SOURCES, exported, largest_nm, laws, model, output, python, tuned};
use serde_json::{Value, json};
use tribo_export::{ExportError, Format, TunedCompensator, export};
use tribo_friction::law::{Asymmetric, CoulombViscous, GazSigmoid};
use tribo_friction::{FrictionModel, VelocitySource};
use tribo_model::TunedFile;

fn parsed(text: &str) -> Value {
    serde_saphyr::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// A file whose numbers are awkward: whole, tiny, huge, of seventeen digits.
fn awkward() -> TunedFile {
    let mut file = tuned("panda", laws::<7>()[0], VelocitySource::Hybrid);
    let values = [3.0, 1e-5, 0.1 + 0.2, 1e-300, 123.456_789_012_345_67, 0.0, 1e3];
    for (joint, value) in file.friction.joints.iter_mut().zip(values) {
        joint.coulomb_nm = Some(value);
    }
    file.model = Some(model(&format!("robot: panda\n{EFFECTS}")));
    file
}

#[test]
fn ros2_parameters_come_back_to_the_last_bit() {
    for source in SOURCES {
        for friction in laws::<7>() {
            let file = tuned("panda", friction, source);
            let text = exported(&file, Format::Ros2, None).text;
            let node = &parsed(&text)["/**"]["friction_compensator"]["ros__parameters"];
            assert_eq!(node["law"], json!(file.friction.law));
            assert_eq!(node["velocity_source"], json!(source));
            assert_eq!(node["smoothing_rad_s"].as_f64(), Some(file.friction.smoothing_rad_s));
            assert_eq!(node["hybrid_threshold_rad_s"].as_f64(), Some(file.hybrid_threshold_rad_s));
            let arrays = node["friction"].as_object().expect("arrays");
            assert_eq!(arrays.len(), file.friction.joints[0].given().len());
            for (j, joint) in file.friction.joints.iter().enumerate() {
                for (name, value) in joint.given() {
                    assert_eq!(arrays[name][j].as_f64().map(f64::to_bits), Some(value.to_bits()), "{name} {j}");
                }
            }
        }
    }
    let text = exported(&tuned("ur10e", laws::<6>()[0], SOURCES[0]), Format::Ros2, Some("arms/left")).text;
    assert_eq!(
        parsed(&text)["arms/left"]["ros__parameters"]["friction"]["coulomb_nm"].as_array().map(Vec::len),
        Some(6)
    );
}

#[test]
fn ros2_parameters_have_every_effect() {
    let file = awkward();
    let it = TunedCompensator::<7>::of(&file).expect("valid");
    let text = exported(&file, Format::Ros2, Some("/**")).text;
    let effects = parsed(&text)["/**"]["ros__parameters"]["effects"].clone();
    for (j, joint) in it.compensator.effects.iter().enumerate() {
        let seen = |name: &str| effects[name][j].as_f64().unwrap_or_else(|| panic!("{name}: {text}"));
        assert_eq!(seen("coulomb_nm"), joint.coulomb_nm);
        assert_eq!(seen("viscous_nm_s_per_rad"), joint.viscous_nm_s_per_rad);
        assert_eq!(seen("breakaway_minus_coulomb_nm"), joint.breakaway_minus_coulomb_nm);
        assert_eq!(seen("stribeck_velocity_rad_s"), joint.stribeck_velocity_rad_s);
        assert_eq!(seen("asymmetry_nm"), joint.asymmetry_nm);
        assert_eq!(seen("offset_nm"), joint.offset_nm);
        assert_eq!(seen("load_coefficient"), joint.load_coefficient);
        assert_eq!(seen("spring_nm_per_rad"), joint.spring_nm_per_rad);
        assert_eq!(seen("spring_rest_rad"), joint.spring_rest_rad);
        assert_eq!(seen("presliding_distance_rad"), joint.presliding_distance_rad);
        for (k, ripple) in joint.ripples.iter().enumerate().take(2) {
            let seen = |name: &str| effects[format!("ripple_{k}")][name][j].as_f64();
            assert_eq!(seen("cycles_per_rev"), Some(ripple.cycles_per_rev));
            assert_eq!(seen("amplitude_nm"), Some(ripple.amplitude_nm));
            assert_eq!(seen("phase_rad"), Some(ripple.phase_rad));
        }
        for (k, (curve, part)) in joint.curves.iter().zip(&joint.bristles).enumerate().take(2) {
            let seen = |group: &str, name: &str| effects[format!("{group}_{k}")][name][j].as_f64();
            assert_eq!(seen("curve", "amplitude_nm"), Some(curve.amplitude_nm));
            assert_eq!(seen("curve", "width_rad_s"), Some(curve.width_rad_s));
            assert_eq!(seen("bristle", "amplitude_nm"), Some(part.amplitude_nm));
            assert_eq!(seen("bristle", "distance_rad"), Some(part.distance_rad));
        }
    }
    assert_eq!(it.compensator.effects[6].curves[1].amplitude_nm, -0.1);
    assert!(effects.get("curve_2").is_none() && effects.get("bristle_2").is_none(), "{text}");
}

/// Prints every number of the parameters that is no `float`, and the parameters again as JSON.
const PYYAML: &str = r#"
import json, sys, yaml
def wrong(x):
    if isinstance(x, dict): return [w for v in x.values() for w in wrong(v)]
    if isinstance(x, list): return [w for v in x for w in wrong(v)]
    return [] if isinstance(x, (float, str)) else [repr(x)]
tree = yaml.safe_load(open("parameters.yaml", encoding="utf-8"))
print(json.dumps({"wrong": wrong(tree), "tree": tree}))
"#;

#[test]
fn pyyaml_reads_doubles_as_doubles() {
    let Some(python) = python("yaml", "exported parameter files are UNTESTED against PyYAML") else { return };
    let at = tempfile::tempdir().expect("a directory");
    let mut odd = awkward();
    odd.robot = "a\"b'<&> --> */ ??/\\\n\t// \u{202e}τ {0}: # \u{0}".to_owned();
    for file in [awkward(), odd] {
        let text = exported(&file, Format::Ros2, None).text;
        std::fs::write(at.path().join("parameters.yaml"), &text).expect("written");
        let seen: Value = serde_json::from_slice(&output(at.path(), &python, &["-c", PYYAML])).expect("JSON");
        assert_eq!(seen["wrong"], json!([]), "{text}");
        assert_eq!(seen["tree"], parsed(&text));
        assert_eq!(seen["tree"]["/**"]["friction_compensator"]["ros__parameters"]["robot"], json!(file.robot));
    }
}

/// fp1, fp2 and fp3 of a file.
fn crisp(file: &TunedFile) -> ([[f64; 7]; 3], String) {
    let text = exported(file, Format::Crisp, None).text;
    let node = parsed(&text)["/**"]["cartesian_impedance_controller"]["ros__parameters"].clone();
    assert_eq!(node["use_friction"], true);
    let array = |name: &str| {
        let values = node["friction"][name].as_array().expect("an array");
        std::array::from_fn(|j| values[j].as_f64().expect("a number"))
    };
    (["fp1", "fp2", "fp3"].map(array), text)
}

/// The torque of CRISP's `get_friction`, written anew from its formula.
fn crisp_torque([fp1, fp2, fp3]: &[[f64; 7]; 3], j: usize, qd: f64) -> f64 {
    fp1[j] / (1.0 + (-fp2[j] * (qd + fp3[j])).exp()) - fp1[j] / (1.0 + (-fp2[j] * fp3[j]).exp())
}

#[test]
fn crisp_has_the_sigmoid_as_it_is() {
    let friction = laws::<7>()[2];
    let file = tuned("panda", friction, VelocitySource::Measured);
    let (parameters, _) = crisp(&file);
    for j in 0..7 {
        for qd in [-2.0, -0.1, -1e-3, 0.0, 0.02, 1.3] {
            assert!((crisp_torque(&parameters, j, qd) - friction.joints[j].torque(qd, 0.0)).abs() < 1e-15);
        }
    }
    // Nothing is lost.
    assert_eq!(exported(&file, Format::Crisp, None).losses, []);
}

#[test]
fn crisp_has_dry_friction_and_says_what_the_rest_is_worth() {
    let uniform = |law: tribo_friction::JointFriction, source| tuned("panda", FrictionModel::<7>::uniform(law), source);
    let dry = CoulombViscous { coulomb_nm: 0.6, viscous_nm_s_per_rad: 0.0 };
    let file = uniform(dry.into(), VelocitySource::Measured);
    let (parameters, _) = crisp(&file);
    for qd in [-2.0_f64, -3e-3, 0.0, 1e-3, 0.5] {
        // fp1 = 2 Fc, fp2 = 2/v, fp3 = 0: the compensator's own tanh.
        assert!((crisp_torque(&parameters, 0, qd) - 0.6 * (qd / 0.005).tanh()).abs() < 1e-15);
    }
    assert_eq!([parameters[0][0], parameters[1][0], parameters[2][0]], [1.2, 400.0, 0.0]);
    assert_eq!(exported(&file, Format::Crisp, None).losses, []);

    let slope = CoulombViscous { viscous_nm_s_per_rad: 0.8, ..dry };
    let lossy = exported(&uniform(slope.into(), VelocitySource::Hybrid), Format::Crisp, None);
    let viscous = largest_nm(&lossy, "viscous friction");
    assert!((viscous[0] - 0.8 * 2.175).abs() < 1e-9 && (viscous[6] - 0.8 * 2.61).abs() < 1e-9, "{viscous:?}");
    assert!(lossy.losses.iter().any(|loss| loss.lost == "velocity source hybrid"));
    assert!(lossy.text.contains("Not in this file: velocity source hybrid"), "{}", lossy.text);
    let smoother = largest_nm(&lossy, "smoothing")[0];
    assert!(smoother > 0.3 && smoother < 0.6, "{smoother}");

    // Both directions of dry friction, to rounding; at rest nothing.
    let law = Asymmetric {
        coulomb_positive_nm: 0.5,
        coulomb_negative_nm: 0.8,
        viscous_positive_nm_s_per_rad: 0.0,
        viscous_negative_nm_s_per_rad: 0.0,
    };
    let (parameters, _) = crisp(&uniform(law.into(), VelocitySource::Measured));
    for (qd, torque) in [(2.0, 0.5), (-2.0, -0.8), (0.0, 0.0)] {
        assert!((crisp_torque(&parameters, 3, qd) - torque).abs() < 1e-12, "{qd}");
    }
}

#[test]
fn names_and_laws_that_a_target_does_not_take_are_refused() {
    let file = tuned("panda", laws::<7>()[0], VelocitySource::Hybrid);
    for (format, name) in [
        (Format::Ros2, "my node"),
        (Format::Ros2, ""),
        (Format::Ros2, "a//b"),
        (Format::Crisp, "a:\n  b"),
        (Format::C, "2arm"),
        (Format::C, "_arm"),
        (Format::C, "left-arm"),
        (Format::Json, "arm"),
        (Format::Rust, "arm"),
    ] {
        let refusal = export(&file, format, Some(name)).expect_err(name);
        assert!(matches!(refusal, ExportError::Name { .. }), "{refusal}");
    }
    let slope = CoulombViscous { coulomb_nm: 0.0, viscous_nm_s_per_rad: 0.8 };
    let file = tuned("panda", FrictionModel::<7>::uniform(slope.into()), VelocitySource::Hybrid);
    let refusal = export(&file, Format::Crisp, None).expect_err("no dry friction").to_string();
    assert!(refusal.contains("1.74 Nm at the speed limit") && refusal.contains("crisp"), "{refusal}");
    // No friction at all is no loss.
    let none = GazSigmoid { phi1_nm: 0.0, phi2_s_per_rad: 5.0, phi3_rad_s: 0.0 };
    exported(&tuned("panda", FrictionModel::<7>::uniform(none.into()), VelocitySource::Measured), Format::Crisp, None);
}
