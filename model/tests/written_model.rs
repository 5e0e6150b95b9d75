//! What a diagnosis reports is what its written model leaves when the file is read back.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

use nalgebra::SVector;
use tribo_diagnose::{DiagnoseSettings, Diagnosis, JointMisfit, Unseen, diagnose, diagnose_with_reference};
use tribo_logs::RobotLog;
use tribo_model::{Model, ModelFile, YamlDocument, to_yaml};
use tribo_regression::{FrictionReport, FrictionSettings, ModelResidual};
use tribo_robot::presets;
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{Effect, Recorder, Recording, SoftFriction, Truth, record};

/// The Panda as its nominal model has it.
fn nominal_file() -> ModelFile {
    let friction = "friction:\n  law: coulomb_viscous\n  joints:\n".to_owned()
        + &"  - {coulomb_nm: 0.5, viscous_nm_s_per_rad: 0.8}\n".repeat(7);
    let text = format!("schema: tribo.model/1\nrobot: panda\n{friction}");
    YamlDocument::embedded("nominal.yaml", &text).parse().unwrap()
}

/// A log of 24 s of a truth that differs from the nominal model by effects.
fn log(effects: Vec<Effect>, seed: u64) -> RobotLog {
    let model: Model<7> = nominal_file().validate().unwrap();
    let truth = Truth { effects, ..model.to_truth() };
    let motion =
        Excitation::Multisine.draw(&Envelope::around(&presets::panda(), presets::panda_ready_pose()), 24.0, seed);
    record(&truth, 0.005, motion.as_ref(), &Recording { rate_hz: 250.0, ..Recording::default() }, seed).unwrap()
}

/// Friction, offsets, links and torque scales that are wrong in every joint; 0.6 kg at the flange if loaded.
fn wrong_everywhere(loaded: bool) -> Vec<Effect> {
    let mut effects: Vec<Effect> = (0..7)
        .flat_map(|joint| {
            let sign = if joint % 2 == 0 { 1.0 } else { -1.0 };
            [
                Effect::Coulomb { joint, delta_coulomb_nm: 0.2 * sign },
                Effect::TorqueOffset { joint, offset_nm: 0.1 + 0.02 * joint as f64 },
                Effect::FrictionCurve { joint, amplitude_nm: 0.25, width_rad_s: 0.2 },
            ]
        })
        .collect();
    let links = presets::panda().links;
    effects.extend((1..7).map(|link| Effect::LinkInertial {
        link,
        delta_mass_kg: 0.03 * links[link].mass_kg,
        delta_first_moment_kg_m: [0.0; 3],
        delta_inertia_kg_m2: [0.0; 6],
    }));
    if loaded {
        effects.push(Effect::Payload {
            mass_kg: 0.6,
            com_m: [0.0, 0.01, 0.05],
            inertia_kg_m2: [1e-3, 0.0, 0.0, 1e-3, 0.0, 1e-3],
        });
    }
    effects
}

/// The model file that a diagnosis leaves, through its text.
fn read_back(diagnosis: &Diagnosis) -> Model<7> {
    let text = to_yaml(&nominal_file().diagnosed(diagnosis)).unwrap();
    let file: ModelFile = YamlDocument::embedded("extended.yaml", &text).parse().unwrap();
    file.validate().unwrap()
}

/// Residual by the report = residual by the file = residual that `tribo estimate` shows, to 1e-9 Nm.
fn one_residual(log: &RobotLog, diagnosis: &Diagnosis) {
    let model = read_back(diagnosis);
    let logs = std::slice::from_ref(log);
    let left = ModelResidual::of(logs, &model.to_nominal(), Some(diagnosis.band_hz)).unwrap().rms_nm();
    let settings = FrictionSettings { smoothing_rad_s: model.smoothing_rad_s, ..FrictionSettings::default() };
    let estimate =
        FrictionReport::of_model(log, &model.to_nominal(), Some(&model.friction), diagnosis.band_hz, &settings)
            .unwrap();
    for (j, joint) in diagnosis.joints.iter().enumerate() {
        let shown = estimate.joints[j].rms_with_model_nm.unwrap();
        assert!((joint.rms_after_nm - left[j]).abs() < 1e-9, "joint {j}: {} {}", joint.rms_after_nm, left[j]);
        assert!((joint.rms_after_nm - shown).abs() < 1e-9, "joint {j}: {} {shown}", joint.rms_after_nm);
    }
}

#[test]
fn causes_found_one_by_one_are_reported_as_written() {
    let hidden = vec![
        Effect::Payload { mass_kg: 0.4, com_m: [0.0, 0.0, 0.05], inertia_kg_m2: [0.0; 6] },
        Effect::Viscous { joint: 2, delta_viscous_nm_s_per_rad: 0.5 },
    ];
    let log = log(hidden, 3);
    let nominal = nominal_file().validate::<7>().unwrap().to_nominal();
    let diagnosis =
        diagnose(std::slice::from_ref(&log), &nominal, &[], &DiagnoseSettings::default(), &|_, _| true).unwrap();
    let labels: Vec<&str> = diagnosis.findings.iter().map(|finding| finding.label.name()).collect();
    assert_eq!(labels, ["payload", "viscous"], "two causes are no wrong model");
    let unseen: &Unseen = diagnosis.unseen.as_ref().expect("the log is long enough to hold thirds of it out");
    assert!(!unseen.baseline_is_better(), "{unseen:?}");
    one_residual(&log, &diagnosis);
}

#[test]
fn a_model_that_is_wrong_everywhere_is_reported_as_written() {
    let log = log(wrong_everywhere(false), 4);
    let nominal = nominal_file().validate::<7>().unwrap().to_nominal();
    let diagnosis =
        diagnose(std::slice::from_ref(&log), &nominal, &[], &DiagnoseSettings::default(), &|_, _| true).unwrap();
    let unseen: &Unseen = diagnosis.unseen.as_ref().expect("every joint differs");
    assert!(unseen.ratio() < 1.0, "{unseen:?}");
    one_residual(&log, &diagnosis);
    // Every link is a body, and what is found is friction and offsets of all joints.
    let arm = read_back(&diagnosis).to_truth().true_arm();
    assert!(arm.links.iter().all(|link| link.mass_kg > 0.0));
    let offsets = diagnosis.findings.iter().find(|finding| finding.label.name() == "torque_offset").expect("offsets");
    assert!(offsets.joints.len() >= 5, "{:?}", offsets.joints);
    assert!(diagnosis.findings.len() <= 8);
    for parameter in diagnosis.findings.iter().flat_map(|finding| &finding.parameters) {
        for (value, [low, high]) in parameter.value.iter().zip(&parameter.ci95) {
            assert!(low <= value && value <= high, "{parameter:?}");
        }
    }
}

/// A torque that repeats with the joint's angle is named beside everything else that is wrong, at its joint.
#[test]
fn a_ripple_in_a_model_that_is_wrong_everywhere_is_found() {
    let ripple = Effect::TorqueRipple { joint: 5, cycles_per_rev: 6.0, amplitude_nm: 0.15, phase_rad: 0.6 };
    let hidden = wrong_everywhere(false).into_iter().chain([ripple]).collect();
    let log = log(hidden, 4);
    let nominal = nominal_file().validate::<7>().unwrap().to_nominal();
    let diagnosis =
        diagnose(std::slice::from_ref(&log), &nominal, &[], &DiagnoseSettings::default(), &|_, _| true).unwrap();
    one_residual(&log, &diagnosis);
    let found = diagnosis.findings.iter().find(|finding| finding.label.name() == "torque_ripple").expect("a ripple");
    assert_eq!(found.joints, [5], "{found:?}");
    let value = |name: &str| found.parameters.iter().find(|parameter| parameter.name == name).unwrap().value[0];
    // Within a part of a turn neighbouring waves share it.
    assert!((value("cycles_per_rev") - 6.0).abs() <= 1.0, "{found:?}");
    assert!((value("amplitude_nm") / 0.15 - 1.0).abs() < 0.2, "{found:?}");
    assert!((found.explained_rms_nm / (0.15 / 2f64.sqrt()) - 1.0).abs() < 0.2, "{found:?}");
}

/// Friction of a physics engine in every joint is known for what it is, and neither for torques that come late nor for rotors.
#[test]
fn the_soft_friction_of_a_physics_engine_leads_the_velocity() {
    let model: Model<7> = nominal_file().validate().unwrap();
    let engine = |effects: Vec<Effect>| {
        // The engine's friction in the place of the model's dry one.
        let dry = (0..7).map(|joint| Effect::Coulomb { joint, delta_coulomb_nm: -0.5 });
        let truth = Truth { effects: dry.chain(effects).collect(), ..model.to_truth() };
        let loss_nm = SVector::from_fn(|j, _| if j % 2 == 0 { 0.7 } else { 0.45 });
        let soft = SoftFriction::of(&truth.arm, &presets::panda_ready_pose(), loss_nm).unwrap();
        let torque = |_: f64, _: &SVector<f64, 7>, qd: &SVector<f64, 7>, qdd: &SVector<f64, 7>| soft.torque(qd, qdd);
        let recording = Recording { rate_hz: 250.0, ..Recording::default() };
        let recorder = Recorder { truth: &truth, smoothing_rad_s: 0.005, recording, extra: Some(&torque) };
        let around = Envelope::around(&presets::panda(), presets::panda_ready_pose());
        recorder.record(Excitation::Multisine.draw(&around, 24.0, 8).as_ref(), 8).unwrap()
    };
    let links = presets::panda().links;
    let heavier = |link: usize| Effect::LinkInertial {
        link,
        delta_mass_kg: 0.04 * links[link].mass_kg,
        delta_first_moment_kg_m: [0.0; 3],
        delta_inertia_kg_m2: [0.0; 6],
    };
    let offset = |joint| Effect::TorqueOffset { joint, offset_nm: 0.2 };
    let log = engine((0..7).map(offset).chain((1..7).map(heavier)).collect());
    let settings = DiagnoseSettings::default();
    let diagnosis = diagnose(std::slice::from_ref(&log), &model.to_nominal(), &[], &settings, &|_, _| true).unwrap();
    one_residual(&log, &diagnosis);
    let written = diagnosis.effects();
    let leads = |joint| {
        let of_joint = written.iter().filter_map(|effect| match effect {
            Effect::FrictionLead { joint: at, amplitude_nm, .. } if *at == joint => Some(*amplitude_nm),
            _ => None,
        });
        of_joint.sum::<f64>()
    };
    for joint in 0..7 {
        let loss_nm = if joint % 2 == 0 { 0.7 } else { 0.45 };
        assert!((leads(joint) / loss_nm - 1.0).abs() < 0.4, "joint {joint}: {} of {loss_nm}", leads(joint));
    }
    let named: Vec<&str> = diagnosis.findings.iter().map(|finding| finding.label.name()).collect();
    assert!(!named.contains(&"time_delay") && !named.contains(&"rotor_inertia"), "{named:?}");
    assert!(diagnosis.notes.iter().any(|note| note.contains("physics engine")), "{:?}", diagnosis.notes);
}

/// Where dry friction turns round faster than the model's sign, the log says how fast, the file holds it, and nothing else is named for it;
/// where it turns round as the model says, the model keeps its width.
#[test]
fn a_sharper_sign_is_found_and_written() {
    const TRUE_RAD_S: f64 = 1e-3;
    let model: Model<7> = nominal_file().validate().unwrap();
    let around = Envelope::around(&presets::panda(), presets::panda_ready_pose());
    let logged = |effects: Vec<Effect>, smoothing_rad_s: f64, seed: u64| {
        let truth = Truth { effects, ..model.to_truth() };
        let recording = Recording { rate_hz: 1000.0, encoder_sd_rad: 3e-6, ..Recording::default() };
        let motion = Excitation::Multisine.draw(&around, 24.0, seed);
        record(&truth, smoothing_rad_s, motion.as_ref(), &recording, seed).unwrap()
    };
    let settings = DiagnoseSettings::default();
    let asked = |log: &RobotLog, unseen: &[(String, RobotLog)]| {
        diagnose(std::slice::from_ref(log), &model.to_nominal(), unseen, &settings, &|_, _| true).unwrap()
    };
    let names = |of: &Diagnosis| of.findings.iter().map(|finding| finding.label.name()).collect::<Vec<_>>();
    let unseen = [("unseen".to_owned(), logged(Vec::new(), TRUE_RAD_S, 22))];
    let right = asked(&logged(Vec::new(), TRUE_RAD_S, 21), &unseen);
    assert_eq!(names(&right), [] as [&str; 0], "friction is right but for its sign");
    let width = right.smoothing_rad_s.expect("a width");
    assert!((0.5 * TRUE_RAD_S..2.0 * TRUE_RAD_S).contains(&width), "{width}");
    assert!(right.notes.iter().any(|note| note.contains("smoothing_rad_s")), "{:?}", right.notes);
    one_residual(&logged(Vec::new(), TRUE_RAD_S, 21), &right);
    // What the model of the user leaves is what its own file leaves.
    let logs = [logged(Vec::new(), TRUE_RAD_S, 21)];
    let own = ModelResidual::of(&logs, &model.to_nominal(), Some(right.band_hz)).unwrap().rms_nm();
    for (joint, own) in right.joints.iter().zip(own) {
        assert!((joint.rms_nm - own).abs() < 1e-9, "{} {own}", joint.rms_nm);
    }
    let sum = |of: fn(&JointMisfit) -> f64| right.joints.iter().map(of).sum::<f64>();
    assert!(sum(|joint| joint.rms_after_nm) < sum(|joint| joint.rms_nm), "sharper is nearer");
    let [checked] = &right.validation[..] else { panic!("one log") };
    assert!(checked.gain_ci95[0] > 0.0, "{checked:?}");

    let hidden = Effect::Coulomb { joint: 3, delta_coulomb_nm: 0.3 };
    let beside = logged(vec![hidden], TRUE_RAD_S, 23);
    let found = asked(&beside, &[]);
    let [finding] = &found.findings[..] else { panic!("{:?} {:?}", found.smoothing_rad_s, names(&found)) };
    assert_eq!((finding.label.name(), &finding.joints[..]), ("coulomb", &[3][..]));
    assert!((finding.parameters[0].value[0] / 0.3 - 1.0).abs() < 0.05, "{finding:?}");
    one_residual(&beside, &found);

    let kept = asked(&logged(Vec::new(), model.smoothing_rad_s, 24), &[]);
    assert_eq!((kept.smoothing_rad_s, kept.findings.len()), (None, 0));
}

/// A model without friction has a width all the same, and joints that stick: the file that a diagnosis leaves says both beside frictions of 0.
#[test]
fn a_file_without_friction_takes_width_and_sticking() {
    let log = log(Vec::new(), 3);
    let nominal = nominal_file().validate::<7>().unwrap().to_nominal();
    let diagnosis =
        diagnose(std::slice::from_ref(&log), &nominal, &[], &DiagnoseSettings::default(), &|_, _| true).unwrap();
    let sharper = Diagnosis { smoothing_rad_s: Some(6e-4), sticks: true, ..diagnosis };
    let bare = ModelFile { friction: None, ..nominal_file() };
    let model: Model<7> = bare.diagnosed(&sharper).validate().unwrap();
    assert_eq!(model.smoothing_rad_s, 6e-4);
    assert!(model.sticks && model.to_nominal().sticks);
    assert!((0..7).all(|j| model.friction.joints[j].torque(0.3, 6e-4) == 0.0));
}

/// The payload is told from links and scales by a log of the bare flange: within 10 %.
#[test]
fn an_unloaded_reference_settles_the_payload() {
    let (loaded, bare) = (log(wrong_everywhere(true), 5), log(wrong_everywhere(false), 6));
    let nominal = nominal_file().validate::<7>().unwrap().to_nominal();
    let settings = DiagnoseSettings::default();
    let diagnosis = diagnose_with_reference(&[loaded], &[bare], &nominal, &[], &settings, &|_, _| true).unwrap();
    let payload = diagnosis.findings.iter().find(|finding| finding.label.name() == "payload").expect("a payload");
    let mass = payload.parameters.iter().find(|parameter| parameter.name == "mass_kg").unwrap();
    assert!((mass.value[0] / 0.6 - 1.0).abs() < 0.1, "{mass:?}");
    assert!(mass.ci95[0][0] < 0.6 && 0.6 < mass.ci95[0][1], "{mass:?}");
}
