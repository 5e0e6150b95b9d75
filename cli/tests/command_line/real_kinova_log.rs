//! Story: somebody brings the log of a real Kinova Gen3, with torque from the motor current and from the sensors in the
//! gears, and asks what the gears take.
//!
//! Reference: an independent prototype on the same file, RMS of the difference in a 15 Hz band before and after
//! Coulomb + viscous + offset. How it treated standstill and the ends is not recorded: hard and smooth signs, and 0.1 s more or
//! less at the ends, move the figures after the fit by up to 0.06 Nm (joint 0) and 0.02 Nm (the others).
//! Runs where `$TRIBO_DATA/kinova_gen3` (default: ../shared/data beside the workspace) exists and says so where not.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helpers too")]

use std::path::PathBuf;

use crate::common::{run, scratch, skipped};

const BEFORE_NM: [f64; 7] = [3.91, 5.23, 3.67, 3.67, 2.71, 1.28, 1.47];
const AFTER_NM: [f64; 7] = [0.44, 0.47, 0.59, 0.46, 0.19, 0.19, 0.27];

/// Half a unit of the last digit of the reference, and as much for the ends.
const BEFORE_TOLERANCE_NM: f64 = 0.01;
const AFTER_TOLERANCE_NM: [f64; 7] = [0.06, 0.02, 0.02, 0.02, 0.02, 0.02, 0.02];

fn data() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let file =
        std::env::var_os("TRIBO_DATA").map_or(beside, PathBuf::from).join("kinova_gen3/opti_traj_testing1.csv.gz");
    file.is_file().then(|| file.canonicalize().unwrap())
}

#[test]
fn friction_of_the_gears_of_the_real_kinova() {
    let Some(log) = data() else {
        skipped("no kinova_gen3 under $TRIBO_DATA or ../shared/data; the figures of the real Kinova are UNTESTED");
        return;
    };
    let at = scratch();
    let found = run(at.path(), &format!("estimate {} --json", log.display())).ok().json();
    let gears = &found["transmission"];
    assert_eq!((&gears["band_hz"], &found["torque_residual"]), (&15.0.into(), &serde_json::Value::Null));
    for (j, joint) in gears["joints"].as_array().unwrap().iter().enumerate() {
        let number = |key: &str| joint[key].as_f64().unwrap();
        let (before, after) = (number("rms_before_nm"), number("rms_after_nm"));
        println!("joint {j}: {before:.3} → {after:.3} Nm (reference {} → {})", BEFORE_NM[j], AFTER_NM[j]);
        assert!((before - BEFORE_NM[j]).abs() <= BEFORE_TOLERANCE_NM, "joint {j} before: {before}");
        assert!((after - AFTER_NM[j]).abs() <= AFTER_TOLERANCE_NM[j], "joint {j} after: {after}");
        // Joints 1 and 4 turn one way in this motion.
        assert_eq!(joint["one_way"], [1, 4].contains(&j), "joint {j}");
        let coulomb_nm = joint["fit"]["coulomb_nm"].as_f64().unwrap();
        assert!(joint["one_way"] == true || coulomb_nm > 1.0, "joint {j}: these gears rub");
    }

    // The same through our own file, and the table for people.
    run(at.path(), &format!("convert {} gen3.parquet", log.display())).ok();
    let again = run(at.path(), "estimate gen3.parquet --json").ok().json();
    assert_eq!(again["transmission"], *gears);
    let table = run(at.path(), "estimate gen3.parquet").ok().stdout;
    assert!(table.contains("Friction of the gears") && table.contains("No --model"), "{table}");
}
