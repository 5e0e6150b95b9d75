//! Logs with the torque on both sides of the gears beside logs with one: a diagnosis of either kind is held against either kind. It ended in a panic.

use tribo_diagnose::{DiagnoseSettings, Diagnosis, diagnose};
use tribo_friction::FrictionModel;
use tribo_logs::RobotLog;
use tribo_regression::Nominal;
use tribo_robot::{Arm, presets};
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{Effect, Recording, TorqueSide, Truth, record};

/// A log of motors' torque of an arm with friction of many kinds in every joint, and the same with the torque behind the gears.
fn logs(arm: &Arm<7>, ready_rad: nalgebra::SVector<f64, 7>, duration_s: f64, seed: u64) -> [RobotLog; 2] {
    let friction = (0..7).flat_map(|joint| {
        let dry_nm = 0.06 * arm.limits.tau_max_nm[joint];
        [
            Effect::Coulomb { joint, delta_coulomb_nm: dry_nm },
            Effect::Viscous { joint, delta_viscous_nm_s_per_rad: dry_nm },
            Effect::TorqueOffset { joint, offset_nm: 0.2 * dry_nm },
            Effect::LoadFriction { joint, load_coefficient: 0.1 },
            Effect::FrictionCurve { joint, amplitude_nm: 0.5 * dry_nm, width_rad_s: 0.2 },
        ]
    });
    let rigid = Truth::new(arm.clone(), FrictionModel::none());
    let truth = Truth { effects: friction.collect(), ..rigid.clone() };
    let motion = Excitation::Multisine.draw(&Envelope::around(arm, ready_rad), duration_s, seed);
    let [motor, link] = [(&truth, TorqueSide::Motor), (&rigid, TorqueSide::Link)].map(|(truth, torque_side)| {
        let recording = Recording { rate_hz: 250.0, torque_sd_nm: 0.05, torque_side, ..Recording::default() };
        record(truth, 0.005, motion.as_ref(), &recording, seed).unwrap()
    });
    let mut columns = motor.clone().into_columns();
    columns.tau_link_nm = Some(link.tau_j_nm.clone());
    [motor, columns.validate().unwrap()]
}

#[test]
fn either_kind_of_log_is_held_against_either() {
    let preset = presets::find("kinova_gen3").unwrap();
    let preset = preset.with_joints::<7>().unwrap();
    let arm = preset.arm.clone();
    let nominal =
        Nominal { smoothing_rad_s: 0.005, ..Nominal::new(arm.clone(), FrictionModel::none(), TorqueSide::Motor) };
    let [motor, both] = logs(&arm, preset.poses_rad[0], 20.0, 4);
    let [unseen_motor, unseen_both] = logs(&arm, preset.poses_rad[0], 10.0, 5);
    let diagnosed = |log: &RobotLog, validate: &[(&str, &RobotLog)]| -> Diagnosis {
        let validate: Vec<(String, RobotLog)> =
            validate.iter().map(|(name, log)| ((*name).to_owned(), (*log).clone())).collect();
        diagnose(std::slice::from_ref(log), &nominal, &validate, &DiagnoseSettings::default(), &|_, _| true).unwrap()
    };

    // The gears alone were asked: a log of the motors is held against the whole model, which says so.
    let of_gears = diagnosed(&both, &[("both", &unseen_both), ("motor", &unseen_motor)]);
    let [gears, whole] = &of_gears.validation[..] else { panic!("{:?}", of_gears.validation) };
    assert!(gears.plain_nm.len() == 7 && gears.inside95.is_some() && gears.gain > 0.8, "{gears:?}");
    assert!(whole.plain_nm.is_empty() && whole.inside95.is_none() && whole.gain > 0.8, "{whole:?}");
    let said: Vec<&String> = of_gears.notes.iter().filter(|note| note.contains("no link-side torque")).collect();
    assert!(said.len() == 1 && said[0].starts_with("motor "), "{said:?}");

    // The whole arm was asked: the link side of an unseen log is nothing that anybody compares with.
    let of_arm = diagnosed(&motor, &[("unseen", &unseen_motor)]);
    assert_eq!(of_arm, diagnosed(&motor, &[("unseen", &unseen_both)]));
    assert!(of_arm.validation[0].gain > 0.8, "{:?}", of_arm.validation);
}
