//! Story: a tuned compensator goes to other programs, and the command says what they will not get.
//!
//! What is in the files is held against their consumers in `export/tests/formats/`.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::Path;

use crate::common::{run, scratch};
use serde_json::Value;
use tribo_robot::presets;
use tribo_robot::{DescribedArm, urdf};

const FORMATS: [&str; 8] = ["yaml", "json", "ros2", "crisp", "urdf", "mjcf", "c", "rust"];

/// Changes a text file.
fn edit(path: &Path, change: impl Fn(&str) -> String) {
    let text = std::fs::read_to_string(path).unwrap();
    let changed = change(&text);
    assert_ne!(text, changed, "{text}");
    std::fs::write(path, changed).unwrap();
}

/// Every format, to the terminal, to a file and as JSON, is the same text with the same losses.
#[test]
fn every_format_is_written_and_says_what_it_lacks() {
    let at = scratch();
    run(at.path(), "tune --trials 2 --friction stribeck --truth stribeck --out c --quiet --json").ok();
    for format in FORMATS {
        let shown = run(at.path(), &format!("export c --format {format}")).ok();
        let written = run(at.path(), &format!("export c/tuned.yaml --format {format} --out file.{format}")).ok();
        let file = std::fs::read_to_string(at.path().join(format!("file.{format}"))).unwrap();
        assert_eq!(file.trim_end(), shown.stdout.trim_end(), "{format}");
        assert_eq!(written.stdout, "");
        assert!(written.stderr.ends_with(&format!("written file.{format}\n")), "{written:?}");
        assert_eq!(written.stderr.replace(&format!("written file.{format}\n"), ""), shown.stderr);

        let document = run(at.path(), &format!("export c --format {format} --json --quiet")).ok();
        assert_eq!(document.stderr, "");
        let document = document.json();
        assert_eq!((&document["schema"], &document["format"]), (&"tribo.export/1".into(), &format.into()));
        assert_eq!(document["text"].as_str(), Some(file.as_str()));
        let losses = document["losses"].as_array().unwrap();
        assert_eq!(losses.is_empty(), ["yaml", "json", "ros2", "c", "rust"].contains(&format), "{losses:?}");
        assert_eq!(shown.stderr.lines().count(), losses.len(), "{shown:?}");
        for loss in losses {
            let lost = loss["lost"].as_str().unwrap();
            assert!(shown.stderr.contains(&format!("tribo: not in the {format} file: {lost}: ")), "{shown:?}");
        }
        let torques = losses.iter().filter_map(|loss| loss["largest_nm"].as_array());
        for torque in torques {
            assert!(torque.len() == 7 && torque.iter().all(|it| it.as_f64().is_some_and(|it| it >= 0.0)));
        }
    }
    let to_file = run(at.path(), "export c --format c --json --out v.h").ok().json();
    assert_eq!((&to_file["out"], &to_file["text"]), (&"v.h".into(), &Value::Null));
    let named = run(at.path(), "export c --format c --name left").ok().stdout;
    assert!(named.contains("left_compensate(") && named.contains("LEFT_JOINTS 7"), "{named}");
}

/// The arm of a URDF campaign goes along, with its own names of joints, whatever has become of its file.
#[test]
fn the_arm_of_a_urdf_campaign_is_exported() {
    let at = scratch();
    let urdf = DescribedArm {
        arm: presets::ur10e(),
        joint_names: std::array::from_fn(|j| format!("axis {j} <\"&'>")),
        coulomb_nm: [6.0, 6.0, 3.0, 1.0, 1.0, 1.0],
        viscous_nm_s_per_rad: [6.0, 6.0, 3.0, 1.0, 1.0, 1.0],
    };
    let text = urdf.to_urdf().replace("name=\"ur10e\"", "name=\"my arm\"");
    std::fs::write(at.path().join("arm.urdf"), text).unwrap();
    run(at.path(), "tune --robot arm.urdf --trials 1 --strategy zero --out c --json --quiet").ok();
    std::fs::remove_file(at.path().join("arm.urdf")).unwrap();
    let exported = run(at.path(), "export c --format urdf --quiet").ok();
    assert_eq!(exported.stderr, "");
    let back = urdf::parse(&exported.stdout, None, None).unwrap().arm::<6>().unwrap();
    assert_eq!((back.arm.name.as_str(), &back.joint_names), ("my arm", &urdf.joint_names));
    // Links that are welded go through their inertia about the origin: to rounding.
    let whole = urdf::parse(&urdf.to_urdf(), None, None).unwrap().arm::<6>().unwrap();
    for (exported, read) in back.arm.links.iter().zip(&whole.arm.links) {
        assert!((exported.mass_kg, exported.com_m) == (read.mass_kg, read.com_m), "{exported:?} {read:?}");
        assert!((exported.inertia_kg_m2 - read.inertia_kg_m2).amax() < 1e-15, "{exported:?} {read:?}");
    }
    // Nothing was compensated in that campaign.
    assert_eq!(back.coulomb_nm, [0.0; 6]);
    let parameters = run(at.path(), "export c --format ros2").ok().stdout;
    assert!(parameters.contains(r#"joints: ["axis 0 <\"&'>", "#), "{parameters}");
    for format in FORMATS {
        run(at.path(), &format!("export c --format {format}")).ok();
    }
    // The tuned file alone drives the arm, too.
    run(at.path(), "simulate --robot ur10e --compensation c/tuned.yaml --json").ok();
}

#[test]
fn what_cannot_be_exported_is_refused() {
    let at = scratch();
    run(at.path(), "tune --trials 1 --strategy zero --out c --quiet --json").ok();
    let tuned = at.path().join("c/tuned.yaml");
    let refused = |call: &str, parts: &[&str]| {
        let run = run(at.path(), &format!("{call} --out never"));
        assert_eq!(run.code, Some(2), "{call}: {run:?}");
        for part in parts {
            assert!(run.stderr.contains(part), "{call}: {run:?} lacks {part}");
        }
        assert!(!at.path().join("never").exists(), "{call}");
    };
    refused("export c --format ros2 --name a:b", &["c/tuned.yaml as ros2: --name is `a:b`; allowed: "]);
    refused("export c --format c --name 7up", &["c/tuned.yaml as c: --name is `7up`; allowed: letters"]);
    refused("export c --format rust --name x", &["--name is `x`; allowed: nothing"]);
    edit(&tuned, |text| text.replace("viscous_nm_s_per_rad: 0", "viscous_nm_s_per_rad: 1"));
    refused(
        "export c/tuned.yaml --format crisp",
        &["joint 0: friction without a dry part (2.175 Nm at the speed limit)", "crisp"],
    );
    edit(&tuned, |text| text.replace("robot: panda", "robot: its_own"));
    refused("export c/tuned.yaml --format mjcf", &["robot `its_own` is no preset", "yaml, json, ros2, c and rust"]);
    run(at.path(), "export c --format c").ok();
}
