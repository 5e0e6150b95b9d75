//! Arms with more dry friction than their motion overcomes.

use std::path::Path;

use tribo_campaign::{Campaign, InMemory, Phases, TuneConfig, references, run_in_memory};
use tribo_control::GuardSettings;
use tribo_friction::JointFriction;
use tribo_robot::presets;
use tribo_trial::scenario::TruthName;

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
    let remarks = result.conclusion.remarks(&presets::panda().joint_names);
    assert!(remarks[0].starts_with("panda_joint7 (6) stood still in the last logs"), "{remarks:?}");

    // Who watches the campaign is told too.
    let snapshot = tribo_watch::CampaignWatch::open(&campaign).unwrap().poll().unwrap().unwrap();
    assert!(snapshot.remarks().contains(&remarks[0]), "{:?}", snapshot.remarks());
}

/// A joint that stands for a quarter of the trial without compensation (below 2 mrad/s): its friction is not taken for that of its neighbours, and
/// from the third trial on the parameters are as good as the true ones.
#[test]
fn a_joint_that_often_stands_in_the_first_trial_is_tuned_by_the_third() {
    let at = tempfile::tempdir().unwrap();
    for (wrist_nm, seed) in [[2.2, 0.4], [0.4, 2.5]].into_iter().flat_map(|wrist| (1..5).map(move |seed| (wrist, seed)))
    {
        let truth = truth(at.path(), wrist_nm);
        let config = TuneConfig { seed, truth, phases: Phases::Random, trials: 3, ..TuneConfig::default() };
        let tune = config.validate::<7>().unwrap();
        let campaign = run_in_memory(&tune).unwrap();
        let oracle = references(&tune).unwrap().oracle;
        let costs: Vec<f64> = campaign.trials.iter().map(|trial| trial.cost.total()).collect();
        assert!(costs[0] > 5.0 * oracle && costs[2] < 1.1 * oracle, "{wrist_nm:?}, seed {seed}: {costs:?}, {oracle}");
        let true_nm = [0.6, 0.9, 0.55, 0.8, 0.4, wrist_nm[0], wrist_nm[1]];
        for (joint, coulomb_nm) in true_nm.into_iter().enumerate() {
            let found = best(&campaign, joint);
            assert!((found[0] / coulomb_nm - 1.0).abs() < 0.1, "{wrist_nm:?}, seed {seed}, joint {joint}: {found:?}");
        }
    }
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

/// A Panda whose last joint has more dry friction than the box of its campaign: the rest stays, and nothing of it goes to the neighbours.
#[test]
fn friction_beyond_the_box_is_not_given_to_other_joints() {
    let at = tempfile::tempdir().unwrap();
    let config = TuneConfig { truth: truth(at.path(), [4.0, 0.4]), ..TuneConfig::default() };
    let campaign = run_in_memory(&config.validate::<7>().unwrap()).unwrap();
    let beyond = &campaign.conclusion.beyond_box;
    assert_eq!(beyond.iter().map(|it| it.joint).collect::<Vec<_>>(), [5], "{beyond:?}");
    assert!((beyond[0].found / 4.0 - 1.0).abs() < 0.02 && beyond[0].bound == 3.0, "{beyond:?}");
    for (joint, coulomb_nm) in [(0, 0.6), (1, 0.9), (2, 0.55), (3, 0.8), (4, 0.4), (6, 0.4)] {
        let found = best(&campaign, joint);
        assert!((found[0] / coulomb_nm - 1.0).abs() < 0.1 && found[1] < 1.5, "joint {joint}: {found:?}");
    }
}

/// Where every compensator is stopped, the campaign gives up after five, and the trial without compensation counts.
#[test]
fn a_campaign_of_which_every_compensator_is_stopped_ends() {
    let at = tempfile::tempdir().unwrap();
    let guard = Some(GuardSettings { drift_rad: 1e-4, ..GuardSettings::default() });
    let config = TuneConfig { truth: truth(at.path(), [0.4, 0.4]), trials: 20, guard, ..TuneConfig::default() };
    let campaign = run_in_memory(&config.validate::<7>().unwrap()).unwrap();
    assert_eq!(campaign.trials.len(), 6);
    assert!(campaign.trials[0].aborted.is_none() && campaign.trials[1..].iter().all(|trial| trial.failed()));
    let stop = campaign.early_stop.unwrap();
    assert_eq!(stop.stopped_in_a_row, 5);
    assert_eq!(stop.to_string(), "the last 5 of 6 trials were stopped for what their compensators did");
    assert_eq!(campaign.conclusion.best.unwrap().trial, 0);
}

/// A motion that fails although the true friction is compensated fails for something else, which is told.
#[test]
fn a_motion_that_fails_with_the_true_friction_too_is_told() {
    let at = tempfile::tempdir().unwrap();
    let guard = Some(GuardSettings { drift_rad: 1e-4, ..GuardSettings::default() });
    let config = TuneConfig { truth: truth(at.path(), [0.4, 0.4]), trials: 1, guard, ..TuneConfig::default() };
    let campaign = at.path().join("c");
    let clock = || "2026-01-01T00:00:00.000000+00:00".to_owned();
    let result = Campaign::create(&campaign, config.validate::<7>().unwrap(), clock).unwrap().run(&mut ()).unwrap();
    assert!(result.references.oracle_failed.is_some(), "{:?}", result.references);
    let snapshot = tribo_watch::CampaignWatch::open(&campaign).unwrap().poll().unwrap().unwrap();
    assert!(snapshot.remarks().contains(&result.references.remark().unwrap()), "{:?}", snapshot.remarks());
}
