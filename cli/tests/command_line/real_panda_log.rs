//! Story: somebody brings the log of a real Panda (gaz2019, four text files) and asks what is in its torques.
//!
//! `convert` makes it a canonical CSV, `estimate` tells the joint torque residual: measured less rigid model, both behind
//! the same low-pass filter of 10 Hz. Reference: an independent prototype on the same data.
//! Runs where `$TRIBO_DATA/panda_gaz2019` (default: ../shared/data beside the workspace) exists and says so where not.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::PathBuf;

use serde_json::Value;
use tribo_friction::FrictionModel;
use tribo_logs::read_log;
use tribo_regression::{FrictionReport, FrictionSettings, ResidualSettings, TorqueResidual};
use tribo_robot::presets;
use tribo_sim::panda_gaz_joints;

use crate::common::{run, scratch, skipped};

/// Standard deviation of the residual of the prototype without friction, and with the published friction (Nm).
const SD_RIGID_NM: [f64; 7] = [0.38, 0.45, 0.41, 0.61, 0.33, 0.18, 0.28];
const SD_GAZ_NM: [f64; 7] = [0.27, 0.46, 0.31, 0.32, 0.15, 0.09, 0.07];

/// Band at which our filter passes what the prototype's did, whose own is not recorded: all fourteen figures agree to their
/// rounding, 0.005 Nm, and as much again for the shape of the filter (measured: 0.009 Nm at worst; at 10 Hz 0.034, at
/// 12 Hz 0.030 Nm).
const MATCHING_BAND_HZ: f64 = 11.0;
const MATCHING_TOLERANCE_NM: f64 = 0.01;

/// The same for `estimate`, which averages like a diagnosis, to 2.5 samples per period of the band, and so passes less of it
/// (measured: 0.016 Nm at worst; at 12 Hz 0.018, at 13 Hz 0.025 Nm).
const MATCHING_BAND_AVERAGED_HZ: f64 = 12.5;
const MATCHING_TOLERANCE_AVERAGED_NM: f64 = 0.02;

/// The fit must match the published friction on most joints, on blocks it has not seen, and nowhere be worse than this
/// ratio of RMS (measured: as good on 5 of 7, worst 1.09). The published law was fitted to this very robot.
const MOST_JOINTS: usize = 4;
const WORST_RATIO: f64 = 1.15;

fn data() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let directory = std::env::var_os("TRIBO_DATA").map_or(beside, PathBuf::from).join("panda_gaz2019");
    directory.is_dir().then(|| directory.canonicalize().unwrap())
}

#[test]
fn residual_torques_of_the_real_panda() {
    let Some(data) = data() else {
        skipped("no panda_gaz2019 under $TRIBO_DATA or ../shared/data; the figures of the real Panda are UNTESTED");
        return;
    };
    let at = scratch();

    // Four text files, irregular stamps, repeated rows → one canonical log.
    let converted = run(at.path(), &format!("convert {} panda.csv.gz --json", data.display())).ok().json();
    assert_eq!((&converted["joints"], &converted["rows"]), (&7.into(), &19_413.into()));
    assert_eq!(converted["dropped_repeats"], 1131, "of 20544 rows, 6 % repeat the row before");
    assert!((converted["duration_s"].as_f64().unwrap() - 21.0).abs() < 0.01);

    let estimate = |log: &str| run(at.path(), &format!("estimate {log} --torque-side link --json")).ok().json();
    let from_csv = estimate("panda.csv.gz");
    let from_text = estimate(&data.display().to_string());
    assert_eq!(from_csv["torque_residual"], from_text["torque_residual"], "the conversion loses nothing");
    assert_eq!(from_csv["estimators"], from_text["estimators"]);

    let torque = &from_csv["torque_residual"];
    assert_eq!((&torque["band_hz"], &torque["block_s"], &torque["folds"]), (&10.0.into(), &2.0.into(), &5.into()));
    let joints = torque["joints"].as_array().unwrap();
    let number = |joint: &Value, key: &str| joint[key].as_f64().unwrap();
    println!("10 Hz\njoint  sd rigid  sd Gaz  rms Gaz  fit train  fit test  Fc");
    let mut as_good = 0;
    for (j, joint) in joints.iter().enumerate() {
        let (rigid, gaz) = (number(joint, "sd_rigid_nm"), number(joint, "sd_with_model_nm"));
        let (rms_gaz, test) = (number(joint, "rms_with_model_nm"), number(joint, "rms_fit_test_nm"));
        let train = number(joint, "rms_fit_train_nm");
        println!("{j}      {rigid:.3}  {gaz:.3}  {rms_gaz:.3}  {train:.3}  {test:.3}  {}", joint["fit"]["coulomb_nm"]);
        assert!(test < number(joint, "rms_rigid_nm"), "joint {j}: the fit explains nothing on unseen blocks");
        assert!(test < WORST_RATIO * rms_gaz, "joint {j}: fit {test}, published {rms_gaz}");
        as_good += usize::from(test <= rms_gaz);
    }
    println!("fit on unseen blocks as good as the published friction: {as_good} of 7 joints");
    assert!(as_good >= MOST_JOINTS, "{as_good} of 7");

    let call = format!(
        "estimate panda.csv.gz --torque-side link --residual torque --band-hz {MATCHING_BAND_AVERAGED_HZ} --json"
    );
    let matching = run(at.path(), &call).ok().json();
    let averaged: Vec<[f64; 2]> = matching["torque_residual"]["joints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|joint| [number(joint, "sd_rigid_nm"), number(joint, "sd_with_model_nm")])
        .collect();
    agrees(&averaged, MATCHING_BAND_AVERAGED_HZ, MATCHING_TOLERANCE_AVERAGED_NM);

    // The residual itself, at the rate of the log.
    let (log, _) = read_log(at.path().join("panda.csv.gz")).unwrap();
    let settings = ResidualSettings { band_hz: MATCHING_BAND_HZ, ..ResidualSettings::default() };
    let residual = TorqueResidual::of_log(&log, &presets::panda().link_side(), &settings).unwrap();
    let friction = FrictionModel { joints: panda_gaz_joints().map(Into::into) };
    let report = FrictionReport::of(&residual, Some(&friction), &FrictionSettings::default());
    let whole: Vec<[f64; 2]> =
        report.joints.iter().map(|joint| [joint.sd_rigid_nm, joint.sd_with_model_nm.unwrap()]).collect();
    agrees(&whole, MATCHING_BAND_HZ, MATCHING_TOLERANCE_NM);
}

/// Standard deviations without and with the published friction, joint by joint, are those of the prototype (Nm).
fn agrees(sd_nm: &[[f64; 2]], band_hz: f64, tolerance_nm: f64) {
    assert_eq!(sd_nm.len(), SD_RIGID_NM.len());
    for (j, [rigid, gaz]) in sd_nm.iter().enumerate() {
        println!("{band_hz} Hz, joint {j}: sd rigid {rigid:.3}, sd Gaz {gaz:.3}");
        for (measured, reference) in [(rigid, SD_RIGID_NM[j]), (gaz, SD_GAZ_NM[j])] {
            assert!((measured - reference).abs() <= tolerance_nm, "{band_hz} Hz, joint {j}: {measured}, {reference}");
        }
    }
}
