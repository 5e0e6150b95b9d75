//! Plain fits stand beside every answer, whatever the verdict, on the parts that the answer was held out from.

use tribo_diagnose::{DiagnoseSettings, Diagnosis, Verdict, diagnose};
use tribo_logs::RobotLog;
use tribo_regression::Nominal;
use tribo_robot::presets;
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{Effect, Recording, Truth, record};

/// A recording of a Panda with this hidden in it, diagnosed.
fn diagnosed(hidden: Vec<Effect>, duration_s: f64) -> Diagnosis {
    let plain = Truth::<7>::panda_coulomb_viscous();
    let around = Envelope::around(&plain.arm, presets::panda_ready_pose());
    let motion = Excitation::Multisine.draw(&around, duration_s, 5);
    let recording = Recording::default();
    let log: RobotLog =
        record(&Truth { effects: hidden, ..plain.clone() }, 0.01, motion.as_ref(), &recording, 1).unwrap();
    let Truth { arm, friction, .. } = plain;
    let torque_side = recording.torque_side;
    let nominal = Nominal { smoothing_rad_s: 0.01, ..Nominal::new(arm, friction, torque_side) };
    diagnose(&[log], &nominal, &[], &DiagnoseSettings::default(), &|_, _| true).unwrap()
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// Where nothing is missing the extended model is the one given, and no fit to two thirds predicts the last one better than it.
#[test]
fn beside_an_answer_that_finds_nothing() {
    let found = diagnosed(Vec::new(), 30.0);
    assert_eq!(found.verdict, Verdict::NothingMissing);
    let unseen = found.unseen.unwrap();
    assert_eq!(unseen.split, "each third of the log in turn");
    for j in 0..7 {
        let (given, extended) = (unseen.nominal_nm[j], unseen.extended_nm[j]);
        assert!((extended / given - 1.0).abs() < 1e-9, "joint {j}: {extended} {given}");
        // The noise is all that is left: as much as there is on the whole log.
        assert!((given / found.joints[j].rms_nm - 1.0).abs() < 0.1, "joint {j}: {given} {}", found.joints[j].rms_nm);
    }
    for fit in [&unseen.plain_nm, &unseen.full_nm] {
        assert_eq!(fit.len(), 7);
        assert!(mean(fit) > 0.99 * mean(&unseen.nominal_nm), "{fit:?} {:?}", unseen.nominal_nm);
    }
}

/// A payload is no dry friction, viscous friction or offset: fitted to the rest it predicts each third, they do not. The full refit does,
/// nearly.
#[test]
fn beside_an_answer_that_finds_a_payload() {
    let payload = Effect::Payload { mass_kg: 0.5, com_m: [0.0, 0.0, 0.05], inertia_kg_m2: [0.0; 6] };
    let found = diagnosed(vec![payload], 30.0);
    let unseen = found.unseen.unwrap();
    assert!(mean(&unseen.nominal_nm) > 5.0 * mean(&unseen.extended_nm), "{unseen:?}");
    assert!(mean(&unseen.plain_nm) > 1.5 * mean(&unseen.extended_nm), "{unseen:?}");
    assert!(mean(&unseen.full_nm) < 0.5 * mean(&unseen.plain_nm), "{unseen:?}");
    assert!(mean(&unseen.full_nm) > 0.99 * mean(&unseen.extended_nm), "{unseen:?}");
}

/// Too short to hold a part of it out: the answer says so.
#[test]
fn a_log_that_is_too_short_says_so() {
    let found = diagnosed(Vec::new(), 2.2);
    assert!(found.unseen.is_none(), "{} samples", found.samples);
    assert!(found.notes.iter().any(|note| note.contains("too short to hold a third of it out")), "{:?}", found.notes);
}
