//! Programs of other people in Python, unmodified from PyPI: libfranka 0.21 twice, libfranka 0.9.

use std::net::{IpAddr, Ipv4Addr};
use std::sync::atomic::{AtomicBool, Ordering};

use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector3};
use serde_json::{Value, json};
use tribo_fci::{FciVersion, GripperServer, Pace};
use tribo_robot::{Arm, Kinematics, Payload, gravity_torque, mass_matrix, presets, rnea};

use crate::python_witness::{answer, numbers, python};
use crate::served::served_at;

/// What a script saw of a robot that serves at this loopback address, hand included; libfranka knows no port but its own.
fn seen(module: &str, script: &str, version: FciVersion, last: u8) -> Option<Value> {
    let python = python(module, "the server is not tried by this program")?;
    let host = Ipv4Addr::new(127, 0, 0, last);
    let _server = served_at(version, Pace::Lockstep, host, None);
    let mut hand = GripperServer::bind(IpAddr::V4(host), None).unwrap();
    let stop = AtomicBool::new(false);
    Some(std::thread::scope(|scope| {
        scope.spawn(|| hand.run(&stop));
        let ended = EndsOnDrop(&stop);
        let seen = answer(&python, script, &json!({"host": host.to_string()}));
        drop(ended);
        seen
    }))
}

/// Ends the hand's server even where the script fails.
struct EndsOnDrop<'a>(&'a AtomicBool);

impl Drop for EndsOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn text<'a>(seen: &'a Value, key: &str) -> &'a str {
    seen[key].as_str().unwrap()
}

fn number(seen: &Value, key: &str) -> f64 {
    seen[key].as_f64().unwrap()
}

fn joints(seen: &Value, key: &str) -> SVector<f64, 7> {
    SVector::from_column_slice(&numbers(&seen[key]))
}

/// Difference of a client's numbers from ours.
#[track_caller]
fn close(theirs: &Value, ours: &[f64], tolerance: f64) {
    let theirs = numbers(theirs);
    assert_eq!(theirs.len(), ours.len());
    let worst = theirs.iter().zip(ours).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < tolerance, "differs by {worst}");
}

fn coriolis(arm: &Arm<7>, q: &SVector<f64, 7>, qd: &SVector<f64, 7>) -> SVector<f64, 7> {
    let zero = SVector::zeros();
    rnea(arm, q, qd, &zero) - rnea(arm, q, &zero, &zero)
}

#[test]
fn pylibfranka_drives_the_fr3() {
    let Some(seen) = seen("pylibfranka", include_str!("pylibfranka.py"), FciVersion::V10, 41) else { return };
    assert!((number(&seen, "load") - 0.2).abs() < 1e-6);
    assert!(number(&seen, "torque").abs() > 0.01, "the arm moved by torque");
    assert!((number(&seen, "joint") - 0.2).abs() < 0.01, "{}", seen["joint"]);
    assert!(text(&seen, "jump").contains("controller_torque_discontinuity"), "{}", seen["jump"]);
    assert!(text(&seen, "mode").contains("Reflex") && text(&seen, "recovered").contains("Idle"));
    assert!(
        text(&seen, "refused").contains("command rejected") || text(&seen, "refused").contains("not possible"),
        "{}",
        seen["refused"]
    );
    assert!(text(&seen, "collision").contains("joint_reflex"), "{}", seen["collision"]);
    assert!((number(&seen, "width") - 0.03).abs() < 1e-6);

    let (arm, q, qd) = (presets::fr3().link_side(), joints(&seen, "q"), joints(&seen, "dq"));
    close(&seen["mass"], mass_matrix(&arm, &q).as_slice(), 1e-6);
    close(&seen["gravity"], gravity_torque(&arm, &q).as_slice(), 1e-6);
    close(&seen["coriolis"], coriolis(&arm, &q, &qd).as_slice(), 1e-6);
}

#[test]
fn franky_plans_motions_of_the_fr3() {
    let Some(seen) = seen("franky", include_str!("franky_control.py"), FciVersion::V10, 42) else { return };
    assert!(number(&seen, "joint_error") < 0.01, "{}", seen["joint_error"]);
    assert!((number(&seen, "moved") - 0.0707).abs() < 0.01, "{}", seen["moved"]);
    assert!(text(&seen, "collision").contains("joint_reflex"), "{}", seen["collision"]);
    assert_eq!(seen["has_errors"], true);
    let (arm, q) = (presets::fr3().link_side(), joints(&seen, "q"));
    close(&seen["mass"], mass_matrix(&arm, &q).as_slice(), 1e-6);
    close(&seen["gravity"], gravity_torque(&arm, &q).as_slice(), 1e-6);
}

/// Loads our model library, too: thirty functions in C against the crate of the arm.
#[test]
fn panda_python_drives_the_panda_and_loads_our_model() {
    let Some(seen) = seen("panda_py", include_str!("panda_py.py"), FciVersion::V5, 43) else { return };
    assert!(number(&seen, "joint_error") < 0.02, "{}", seen["joint_error"]);
    assert!(number(&seen, "height_error") < 0.01, "{}", seen["height_error"]);
    assert!((number(&seen, "sideways") - 0.02).abs() < 0.01, "{}", seen["sideways"]);
    assert_eq!((text(&seen, "push"), text(&seen, "recovered")), ("", ""));
    assert!(text(&seen, "collision").contains("joint_reflex"), "{}", seen["collision"]);
    assert!(
        text(&seen, "refused").contains("command rejected") || text(&seen, "refused").contains("not possible"),
        "{}",
        seen["refused"]
    );

    let bare = presets::panda().link_side();
    let (q, qd) = (joints(&seen, "q"), joints(&seen, "dq"));
    let load = Payload {
        mass_kg: seen["load"][1].as_f64().unwrap(),
        com_m: Vector3::from_column_slice(&numbers(&seen["load"][2])),
        inertia_kg_m2: Matrix3::from_column_slice(&numbers(&seen["load"][0])),
    };
    let arm = bare.clone().with_payload(&load);
    close(&seen["mass"], mass_matrix(&arm, &q).as_slice(), 1e-10);
    close(&seen["gravity"], gravity_torque(&arm, &q).as_slice(), 1e-10);
    close(&seen["coriolis"], coriolis(&arm, &q, &qd).as_slice(), 1e-10);

    let kinematics = Kinematics::at(&bare, &q);
    let tool = Matrix4::from_column_slice(&numbers(&seen["frame"]));
    let framed = |rotation: &Matrix3<f64>, origin: &Vector3<f64>| {
        let mut pose = rotation.to_homogeneous();
        pose.fixed_view_mut::<3, 1>(0, 3).copy_from(origin);
        pose
    };
    let flange = framed(&kinematics.flange_rotation, &kinematics.flange_origin);
    let mut frames: Vec<(usize, Matrix4<f64>)> = [1, 2, 4, 7]
        .map(|j| {
            let (rotation, origin) = kinematics.link(&bare, j - 1);
            (j, framed(&rotation, &origin))
        })
        .into();
    frames.extend([(7, flange), (7, flange * tool)]);
    for (index, (joint_count, pose)) in frames.iter().enumerate() {
        close(&seen["poses"][index], pose.as_slice(), 1e-10);
        let origin = pose.fixed_view::<3, 1>(0, 3).into_owned();
        let mut jacobian = SMatrix::<f64, 6, 7>::zeros();
        for k in 0..*joint_count {
            let z = kinematics.axis(k);
            jacobian.fixed_view_mut::<3, 1>(0, k).copy_from(&z.cross(&(origin - kinematics.link(&bare, k).1)));
            jacobian.fixed_view_mut::<3, 1>(3, k).copy_from(&z);
        }
        close(&seen["zero_jacobians"][index], jacobian.as_slice(), 1e-10);
        let rotation = pose.fixed_view::<3, 3>(0, 0).transpose();
        let mut own = jacobian;
        own.fixed_view_mut::<3, 7>(0, 0).copy_from(&(rotation * jacobian.fixed_view::<3, 7>(0, 0)));
        own.fixed_view_mut::<3, 7>(3, 0).copy_from(&(rotation * jacobian.fixed_view::<3, 7>(3, 0)));
        close(&seen["body_jacobians"][index], own.as_slice(), 1e-10);
    }
}
