//! What is proposed where a log leaves a question open, and whether it answers it.

use nalgebra::SVector;
use tribo_diagnose::{DiagnoseSettings, Verdict, diagnose};
use tribo_logs::{LogColumns, RobotLog};
use tribo_regression::{CauseLabel, Location, Nominal};
use tribo_robot::presets;
use tribo_sim::excitation::{JointTrajectory, ViaPoints};
use tribo_sim::{Effect, Recording, Truth, record};

const SMOOTHING_RAD_S: f64 = 0.01;

/// The whole way: an ambiguous log, its proposal, the log of the proposal, one name.
#[test]
fn the_proposed_motion_settles_it() {
    let settings = DiagnoseSettings::default();
    let bare = Truth::<7>::panda_coulomb_viscous();
    let nominal = Nominal {
        smoothing_rad_s: SMOOTHING_RAD_S,
        ..Nominal::new(bare.arm.clone(), bare.friction, Recording::default().torque_side)
    };
    let log = |motion: &dyn JointTrajectory<7>, effects: &[Effect]| {
        let truth = Truth { effects: effects.to_vec(), ..bare.clone() };
        record(&truth, SMOOTHING_RAD_S, motion, &Recording::default(), 1).unwrap()
    };
    let diagnosed = |log: RobotLog| diagnose(&[log], &nominal, &[], &settings, &|_, _| true).unwrap();
    let effect = Effect::Coulomb { joint: 2, delta_coulomb_nm: 0.15 };
    // Log only while the arm cruises: its constant friction is an offset.
    let start = presets::panda_ready_pose();
    let one_way =
        ViaPoints { time_s: vec![0.0, 12.0], q_rad: vec![start, start + SVector::repeat(0.6)], resting: true };
    let whole = log(&one_way.path(), std::slice::from_ref(&effect));
    let kept: Vec<usize> = (0..whole.rows()).filter(|k| (4.0..8.0).contains(&whole.time_s[*k])).collect();
    let pick = |x: &Vec<f64>| kept.iter().map(|k| x[*k]).collect::<Vec<f64>>();
    let part = LogColumns {
        time_s: pick(&whole.time_s),
        q_rad: whole.q_rad.iter().map(pick).collect(),
        dq_rad_s: whole.dq_rad_s.iter().map(pick).collect(),
        tau_j_nm: whole.tau_j_nm.iter().map(pick).collect(),
        ..LogColumns::default()
    };
    let before = diagnosed(part.validate().unwrap());
    assert_eq!(before.verdict, Verdict::Ambiguous);
    let next = before.next_experiment.unwrap();
    assert!(next.expected_evidence > 100.0 && next.evidence_of_this_log < 1.0, "{next:?}");
    let time_s = next.via_points.iter().map(|(time_s, _)| *time_s).collect();
    let q_rad = next.via_points.iter().map(|(_, q)| SVector::from_column_slice(q)).collect();
    let proposed = ViaPoints { time_s, q_rad, resting: true }.path();
    let after = diagnosed(log(&proposed, std::slice::from_ref(&effect)));
    assert_eq!(after.verdict, Verdict::Named);
    assert_eq!(after.findings.len(), 1);
    assert_eq!((after.findings[0].label, after.findings[0].location), (CauseLabel::Coulomb, Location::Joint(2)));
}
