//! An arm of which nobody knows the friction, worked from pose to pose and logged with noise: every joint is wrong, and no joint says so loudly.

use std::sync::atomic::{AtomicUsize, Ordering};

use tribo_diagnose::{DiagnoseSettings, diagnose};
use tribo_friction::FrictionModel;
use tribo_regression::{CauseLabel, Location, Nominal};
use tribo_robot::presets;
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{Effect, Recording, Truth, record};

/// Steps of a search that nobody waits for.
const MOST_STEPS: usize = 200;

/// Such a log was searched cause by cause, through fifty of them and for minutes, now and then for ever.
#[test]
fn is_answered_by_families_and_soon() {
    let preset = presets::find("xarm6").unwrap();
    let arm = preset.with_joints::<6>().unwrap().arm.clone();
    let largest_nm = arm.limits.tau_max_nm;
    let effects = (0..6).flat_map(|joint| {
        let dry_nm = 0.06 * largest_nm[joint];
        [
            Effect::Coulomb { joint, delta_coulomb_nm: dry_nm },
            Effect::Viscous { joint, delta_viscous_nm_s_per_rad: dry_nm },
            Effect::LoadFriction { joint, load_coefficient: 0.05 },
            Effect::TorqueOffset { joint, offset_nm: 0.005 * largest_nm[joint] },
            Effect::Stribeck { joint, breakaway_minus_coulomb_nm: 0.5 * dry_nm, stribeck_velocity_rad_s: 0.08 },
        ]
    });
    let truth = Truth { effects: effects.collect(), ..Truth::new(arm.clone(), FrictionModel::none()) };
    let around = Envelope::around(&arm, preset.with_joints::<6>().unwrap().poses_rad[0]);
    let motion = Excitation::StaticPoses.draw(&around, 45.0, 4);
    let recording = Recording { rate_hz: 250.0, torque_sd_nm: 0.3, ..Recording::default() };
    let log = record(&truth, 0.01, motion.as_ref(), &recording, 3).unwrap();
    let torque_side = recording.torque_side;
    let nominal = Nominal { smoothing_rad_s: 0.005, ..Nominal::new(arm, FrictionModel::none(), torque_side) };
    let steps = AtomicUsize::new(0);
    let go_on = |_: &str, _: f64| steps.fetch_add(1, Ordering::Relaxed) < MOST_STEPS;
    let found = diagnose(&[log], &nominal, &[], &DiagnoseSettings::default(), &go_on).unwrap();
    println!("{} steps", steps.load(Ordering::Relaxed));
    let dry = found.findings.iter().find(|finding| finding.label == CauseLabel::Coulomb).unwrap();
    assert_eq!(dry.location, Location::Arm);
    assert!(dry.joints.len() >= 5, "{:?}", dry.joints);
    let unseen = found.unseen.unwrap();
    let ratio = unseen.ratio_to(&unseen.plain_nm);
    assert!(ratio < 0.9, "{ratio} of what plain least squares leaves");
}
