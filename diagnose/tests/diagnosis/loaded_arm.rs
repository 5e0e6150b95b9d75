//! Friction and the torque of a tilted base go with what an arm carries, which its model does not know: the fit took the load of the model, the written file that of the
//! payload, and dry friction and tilt of the file were too large by the difference.

use tribo_diagnose::{DiagnoseSettings, diagnose};
use tribo_friction::FrictionModel;
use tribo_regression::{CauseLabel, Nominal};
use tribo_robot::presets;
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{Effect, Recording, Truth, record};

const MASS_KG: f64 = 3.0;
const LOAD_COEFFICIENT: f64 = 0.15;
const TILT_RAD: f64 = 0.02;

/// Tilt, and dry and load friction of every joint that carries the payload, are found as they are.
#[test]
fn friction_and_tilt_go_with_the_load_of_the_payload() {
    let preset = presets::find("ur10e").unwrap();
    let preset = preset.with_joints::<6>().unwrap();
    let arm = preset.arm.clone();
    let dry_nm = |joint: usize| 0.03 * arm.limits.tau_max_nm[joint];
    let friction = (0..6).flat_map(|joint| {
        [
            Effect::Coulomb { joint, delta_coulomb_nm: dry_nm(joint) },
            Effect::Viscous { joint, delta_viscous_nm_s_per_rad: dry_nm(joint) },
            Effect::LoadFriction { joint, load_coefficient: LOAD_COEFFICIENT },
            Effect::TorqueOffset { joint, offset_nm: 0.004 * arm.limits.tau_max_nm[joint] },
        ]
    });
    let payload =
        Effect::Payload { mass_kg: MASS_KG, com_m: [0.0, 0.0, 0.08], inertia_kg_m2: [0.01, 0.0, 0.0, 0.01, 0.0, 0.01] };
    let truth = Truth {
        effects: friction.chain([payload, Effect::BaseTilt { angle_rad: TILT_RAD, axis: [1.0, 0.0, 0.0] }]).collect(),
        ..Truth::new(arm.clone(), FrictionModel::none())
    };
    let motion = Excitation::Multisine.draw(&Envelope::around(&arm, preset.poses_rad[0]), 40.0, 4);
    let recording = Recording { rate_hz: 500.0, torque_sd_nm: 0.05, ..Recording::default() };
    let log = record(&truth, 0.005, motion.as_ref(), &recording, 3).unwrap();
    let nominal =
        Nominal { smoothing_rad_s: 0.005, ..Nominal::new(arm.clone(), FrictionModel::none(), recording.torque_side) };
    let found = diagnose(&[log], &nominal, &[], &DiagnoseSettings::default(), &|_, _| true).unwrap();
    let labels: Vec<CauseLabel> = found.findings.iter().map(|finding| finding.label).collect();
    assert!(labels.contains(&CauseLabel::Payload) && labels.contains(&CauseLabel::LoadFriction), "{labels:?}");
    let effects = found.effects();
    let tilt = effects.iter().find_map(|effect| match *effect {
        Effect::BaseTilt { angle_rad, .. } => Some(angle_rad),
        _ => None,
    });
    println!("tilt {tilt:?}");
    assert!((tilt.unwrap() / TILT_RAD - 1.0).abs() < 0.02, "{tilt:?}");
    let of_joint = |joint: usize| {
        effects.iter().fold([0.0; 2], |[dry, load], effect| match *effect {
            Effect::Coulomb { joint: at, delta_coulomb_nm } if at == joint => [dry + delta_coulomb_nm, load],
            Effect::FrictionCurve { joint: at, amplitude_nm, .. } if at == joint => [dry + amplitude_nm, load],
            Effect::LoadFriction { joint: at, load_coefficient } if at == joint => [dry, load + load_coefficient],
            _ => [dry, load],
        })
    };
    // The last joint hardly feels the payload, the first not at all.
    for joint in 1..5 {
        let [dry, load] = of_joint(joint);
        println!("joint {joint}: dry {:.3} of {:.3} Nm, load coefficient {load:.3}", dry, dry_nm(joint));
        assert!((load / LOAD_COEFFICIENT - 1.0).abs() < 0.2, "joint {joint}: {load}");
        assert!((dry / dry_nm(joint) - 1.0).abs() < 0.06, "joint {joint}: {dry} Nm of {}", dry_nm(joint));
    }
}
