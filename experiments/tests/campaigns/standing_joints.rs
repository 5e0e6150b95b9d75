//! Arms with more dry friction than their motion overcomes.

use std::path::Path;

use tribo_experiments::scenario::TruthName;
use tribo_experiments::{Campaign, InMemory, Phases, TuneConfig, run_in_memory};
use tribo_friction::JointFriction;

/// A Panda whose wrist has so much dry friction (Nm) in its last two joints.
fn truth(at: &Path, wrist_nm: [f64; 2]) -> TruthName {
    let friction =
        [(0.6, 1.0), (0.9, 1.4), (0.55, 0.8), (0.8, 1.1), (0.4, 0.5), (wrist_nm[0], 1.0), (wrist_nm[1], 1.0)];
    let joints = friction.map(|(fc, fv)| format!("  - {{coulomb_nm: {fc}, viscous_nm_s_per_rad: {fv}}}\n")).concat();
    let model = format!("schema: tribo.model/1\nrobot: panda\nfriction:\n  law: coulomb_viscous\n  joints:\n{joints}");
    let path = at.join("stiff.yaml");
    std::fs::write(&path, model).unwrap();
    TruthName::File(path)
}

/// Coulomb and viscous friction of a joint in the best trial of a campaign.
fn best(campaign: &InMemory, joint: usize) -> [f64; 2] {
    let theta = &campaign.trials[campaign.conclusion.best.unwrap().trial].theta;
    match campaign.space.friction::<7>(theta).joints[joint] {
        JointFriction::CoulombViscous(law) => [law.coulomb_nm, law.viscous_nm_s_per_rad],
        other => panic!("{other:?}"),
    }
}

#[test]
fn joints_that_stand_are_told() {
    let at = tempfile::tempdir().unwrap();
    let config = TuneConfig { truth: truth(at.path(), [0.4, 8.0]), trials: 1, ..TuneConfig::default() };
    let campaign = at.path().join("c");
    let clock = || "2026-01-01T00:00:00.000000+00:00".to_owned();
    let result = Campaign::create(&campaign, config.validate::<7>().unwrap(), clock).unwrap().run(&mut ()).unwrap();
    let standing = &result.conclusion.standing;
    assert_eq!(standing.iter().map(|it| it.joint).collect::<Vec<_>>(), [6], "{standing:?}");
    assert!((1.0..8.0).contains(&standing[0].held_nm), "{standing:?}");
    assert!(result.trials.iter().all(|trial| trial.aborted.is_none()), "{:?}", result.trials);
    let remarks = result.conclusion.remarks();
    assert!(remarks[0].starts_with("joint 6 stood still in the last logs"), "{remarks:?}");

    // Who watches the campaign is told too.
    let snapshot = tribo_experiments::watch::CampaignWatch::open(&campaign).unwrap().poll().unwrap().unwrap();
    assert!(snapshot.remarks().contains(&remarks[0]), "{:?}", snapshot.remarks());
}

/// A joint that sticks and slips shows its averaged velocity beside its rests too small, which is no viscous friction.
#[test]
fn a_joint_that_sticks_and_slips_is_not_compensated_too_much() {
    let at = tempfile::tempdir().unwrap();
    for seed in 1..5 {
        let truth = truth(at.path(), [1.2, 0.9]);
        let config = TuneConfig { seed, truth, phases: Phases::Random, ..TuneConfig::default() };
        let campaign = run_in_memory(&config.validate::<7>().unwrap()).unwrap();
        assert!(campaign.trials.iter().all(|trial| trial.aborted.is_none()), "seed {seed}: {:?}", campaign.trials);
        assert_eq!(campaign.conclusion.standing, [], "seed {seed}");
        for (joint, coulomb_nm) in [(5, 1.2), (6, 0.9)] {
            let found = best(&campaign, joint);
            assert!((found[0] / coulomb_nm - 1.0).abs() < 0.05, "seed {seed}, joint {joint}: {found:?}");
            assert!(found[1] < 1.15, "seed {seed}, joint {joint}: {found:?}, truth 1 Nm s/rad");
        }
    }
}
