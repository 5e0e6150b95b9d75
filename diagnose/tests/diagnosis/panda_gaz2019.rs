//! The public excitation log of a real Panda (gaz2019), read where it is and never copied.
//!
//! Reference: sd of the residual per joint from an independent prototype, with
//! filters of its own: [.38 .45 .41 .61 .33 .18 .28] Nm without friction, [.27 .46 .31 .32 .15 .09 .07] Nm with the
//! published friction.

use std::io::Write;
use std::path::PathBuf;

use tribo_friction::{FrictionModel, law::GazSigmoid};
use tribo_logs::read_log;
use tribo_regression::{FrictionReport, FrictionSettings, ResidualSettings, TorqueResidual};
use tribo_robot::presets;

const SD_RIGID_NM: [f64; 7] = [0.38, 0.45, 0.41, 0.61, 0.33, 0.18, 0.28];
const SD_GAZ_NM: [f64; 7] = [0.27, 0.46, 0.31, 0.32, 0.15, 0.09, 0.07];
/// The prototype's filter is not recorded. Joints 1 to 3 carry acceleration noise that grows by 0.02 Nm per Hz of band
/// around 10 Hz (the reference lies between our figures for 10 and 12 Hz), so 0.035 Nm is a difference of 2 Hz in roll-off.
const TOLERANCE_NM: f64 = 0.035;

/// Published friction of this unit (gaz2019).
fn gaz_friction() -> FrictionModel<7> {
    let phi1_nm = [0.54615, 0.87224, 0.64068, 1.2794, 0.83904, 0.30301, 0.56489];
    let phi2_s_per_rad = [5.1181, 9.0657, 10.136, 5.5903, 8.3469, 17.133, 10.336];
    let phi3_rad_s = [0.039533, 0.025882, -0.04607, 0.036194, 0.026226, -0.021047, 0.0035526];
    let law =
        |j: usize| GazSigmoid { phi1_nm: phi1_nm[j], phi2_s_per_rad: phi2_s_per_rad[j], phi3_rad_s: phi3_rad_s[j] };
    FrictionModel { joints: std::array::from_fn(|j| law(j).into()) }
}

/// The data set under `TRIBO_DATA`, by default beside the workspace.
fn data() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let root = std::env::var_os("TRIBO_DATA").map_or(beside, PathBuf::from);
    let directory = root.join("panda_gaz2019");
    directory.is_dir().then_some(directory)
}

#[test]
fn residual_of_the_real_panda_is_the_known_one() {
    let Some(directory) = data() else {
        // Past the capture of the test harness, which swallows eprintln! of tests that pass.
        let untested =
            "SKIPPED: no panda_gaz2019 under $TRIBO_DATA or ../shared/data; the real-log figures are UNTESTED";
        writeln!(std::io::stderr(), "{untested}").unwrap();
        return;
    };
    let (log, summary) = read_log(&directory).unwrap();
    assert_eq!(summary.rows_read(), 20_544);
    let arm = presets::panda().link_side();
    let residual = TorqueResidual::of_log(&log, &arm, &ResidualSettings::default()).unwrap();
    let report = FrictionReport::of(&residual, Some(&gaz_friction()), &FrictionSettings::default());
    println!("{} samples; {}\n{}", report.samples, report.chain, report.blocks.as_ref().unwrap());
    println!("joint  rms/sd rigid   rms/sd Gaz    Fc ± sd        Fv ± sd        offset ± sd     rms train/test");
    for joint in &report.joints {
        let (fit, held_out) = (joint.fit.unwrap(), joint.held_out.unwrap());
        println!(
            "{}      {:.3}  {:.3}   {:.3}  {:.3}  {:.3} ± {:.3}  {:+.3} ± {:.3}  {:+.3} ± {:.3}   {:.3}  {:.3}",
            joint.joint,
            joint.rms_rigid_nm,
            joint.sd_rigid_nm,
            joint.rms_with_model_nm.unwrap(),
            joint.sd_with_model_nm.unwrap(),
            fit.coulomb_nm,
            held_out.sd[0],
            fit.viscous_nm_s_per_rad,
            held_out.sd[1],
            fit.offset_nm,
            held_out.sd[2],
            held_out.rms_fit_train_nm,
            held_out.rms_fit_test_nm,
        );
    }
    for (j, joint) in report.joints.iter().enumerate() {
        assert!((joint.sd_rigid_nm - SD_RIGID_NM[j]).abs() < TOLERANCE_NM, "joint {j}: {}", joint.sd_rigid_nm);
        let with_gaz = joint.sd_with_model_nm.unwrap();
        assert!((with_gaz - SD_GAZ_NM[j]).abs() < TOLERANCE_NM, "joint {j} with friction: {with_gaz}");
        // Friction is there, dissipates, and a law fitted elsewhere on the log explains it better than nothing.
        let (fit, held_out) = (joint.fit.unwrap(), joint.held_out.unwrap());
        assert!(fit.coulomb_nm > 3.0 * held_out.sd[0], "joint {j}: {fit:?} {held_out:?}");
        assert!(held_out.rms_fit_test_nm < joint.rms_rigid_nm, "joint {j}: {held_out:?}");
    }
}
