//! The examples of the library crates run, and print what their readers are told to expect.
//!
//! They are the binaries that a build of the whole workspace leaves; where somebody builds this crate alone they are not there, and
//! the test says so. What is expected is closed form, or the figure of another test.

use std::path::PathBuf;
use std::process::Command;

/// Example, and parts of what it prints.
const EXAMPLES: &[(&str, &[&str])] = &[
    // Friction 0.8 Nm, 1.5 Nm s/rad and 0.1 Nm are what the example hides in its log.
    ("fit_and_compensate", &["Coulomb  0.800 Nm", "viscous  1.499 Nm s/rad", "offset   0.100 Nm"]),
    // Pinocchio's pose of the Panda at its ready pose, and a URDF that is read back.
    ("arm_dynamics", &["flange            0.307 0.000 0.590 m", "UR10e from a URDF, 6 joints"]),
    ("any_function", &["lowest 0.3"]),
    ("read_any_log", &["1 joints, 1000 rows", "2.0 s at 500 Hz in 1 bursts", "the same as Parquet: true"]),
    ("draw_a_figure", &["largest torque 0.89 Nm"]),
    // A controller that cancels all friction reaches its reference.
    ("cartesian_impedance", &["100 % compensated: 0.00 mm off"]),
    // The push that the example makes.
    ("wrench_in_your_loop", &["0.55       10.00        10.0", "0.95        0.00        ", "delay 20 ms"]),
    // An interval that knows of friction holds the truth, one that does not fails.
    ("own_estimator", &["at rest     -10.78", "]   no", "]   yes"]),
    // Stick: friction equals the drive, to the digit, and the joint ends at rest.
    ("serve_and_drive", &["connected: V5", "joint 0 at 0."]),
    // The force that the example presses with, at its first sample and long after.
    ("wrench_of_messages", &["1.0 s   fz   0.01 N   76 bytes", "2.0 s   fz  10.00 N", "panda_joint1 panda_joint2"]),
    ("arm_with_friction", &["0.40          0.40        0.0000", "at rest: true"]),
    ("ten_seconds_of_ticks", &["no compensation         4.", "all of the friction     0.2"]),
    ("whole_or_not_there", &["read back: 3 rows", "torn: ", "damaged or cut off"]),
    // The friction that the log was recorded with.
    ("residual_of_a_log", &["0.900 Nm", "0.550 Nm", "0.400 Nm"]),
    // A gain of 1.04 is hidden in joint 3.
    ("what_an_arm_lacks", &["CoulombViscous: ", "Gain: ", "gain of joint 3: +0.04"]),
    // 0.5 kg and 0.4 Nm are hidden in the log.
    (
        "diagnose_a_log",
        &["payload at arm", "mass_kg = [0.4998]", "coulomb at panda_joint3 (2)", "delta_coulomb_nm = [0.400"],
    ),
    ("model_file", &["time_delay is not cancelled", "refused: model.yaml:3: field `payload.mass_kg` is -0.5"]),
    ("export_everywhere", &["rust: ", "loses Stribeck curve", "my_arm_compensate("]),
    // Without compensation J is that of `closed_loop_cost.rs`.
    ("cost_of_friction", &["none           J =  24.2", "the true one   J =   3.0", "complete"]),
    ("own_strategy", &["along a line, trial 0: J = 24.30", "grey_box, trial 1: J = 2.9"]),
    ("report_of_a_campaign", &["from 24.3 without compensation", "trial 2: complete", "bytes of HTML"]),
    ("is_it_fast_enough", &["30000 ticks in "]),
    ("picture_of_the_window", &["1000 x 700 pixels, more than twenty colours: true"]),
];

/// Examples of this profile: beside `deps`, where this program lies.
fn folder() -> PathBuf {
    let this = std::env::current_exe().expect("a running program has a path");
    this.parent().and_then(|deps| deps.parent()).expect("deps lies in the folder of the profile").join("examples")
}

#[test]
fn examples_print_what_they_promise() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let mut wrong = Vec::new();
    for (example, parts) in EXAMPLES {
        let binary = folder().join(format!("{example}{}", std::env::consts::EXE_SUFFIX));
        if !binary.is_file() {
            println!("SKIPPED {example}: not built; `cargo test --release --workspace` builds it");
            continue;
        }
        let output = Command::new(&binary).current_dir(scratch.path()).output().expect("an example can be started");
        let printed = String::from_utf8_lossy(&output.stdout);
        if !output.status.success() {
            wrong.push(format!("{example}: {}", String::from_utf8_lossy(&output.stderr)));
        }
        for part in parts.iter().filter(|part| !printed.contains(**part)) {
            wrong.push(format!("{example} does not print {part:?} but\n{printed}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
