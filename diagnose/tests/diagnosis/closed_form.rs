//! Logs whose truth is known in closed form: sinusoids in every joint, rigid torque by RNEA, friction by its law.

use nalgebra::SVector;
use tribo_friction::{FrictionModel, law::CoulombViscous};
use tribo_logs::{LogColumns, RobotLog};
use tribo_regression::{
    BlockSettings, BlocksError, FrictionReport, FrictionSettings, HeldOutError, JointFitError, ResidualError,
    ResidualSettings, TorqueResidual,
};
use tribo_robot::{Arm, JointNames, presets, rnea};

type Vector = SVector<f64, 7>;

const COULOMB_NM: [f64; 7] = [0.60, 0.90, 0.55, 0.80, 0.40, 0.30, 0.35];
const VISCOUS_NM_S_PER_RAD: [f64; 7] = [1.0, 1.4, 0.8, 1.1, 0.5, 0.4, 0.3];
const OFFSET_NM: [f64; 7] = [0.1, -0.4, 0.2, 0.0, -0.1, 0.05, 0.3];
const SMOOTHING_RAD_S: f64 = 0.005;

/// q, qd, qdd at t: two sinusoids per joint below 0.7 Hz about the ready pose.
fn motion(t_s: f64) -> (Vector, Vector, Vector) {
    let mut state = (presets::panda_ready_pose(), Vector::zeros(), Vector::zeros());
    for j in 0..7 {
        for (amplitude, omega, phase) in
            [(0.30, 1.1 + 0.21 * j as f64, j as f64), (0.07, 3.3 + 0.13 * j as f64, 2.0 * j as f64)]
        {
            let (s, c) = (omega * t_s + phase).sin_cos();
            state.0[j] += amplitude * s;
            state.1[j] += amplitude * omega * c;
            state.2[j] -= amplitude * omega * omega * s;
        }
    }
    state
}

fn friction() -> FrictionModel<7> {
    let law = |j: usize| CoulombViscous { coulomb_nm: COULOMB_NM[j], viscous_nm_s_per_rad: VISCOUS_NM_S_PER_RAD[j] };
    FrictionModel { joints: std::array::from_fn(|j| law(j).into()) }
}

/// The log at these stamps; `standing` joints are held at the ready pose.
fn log_at(time_s: Vec<f64>, standing: &[usize]) -> RobotLog {
    let arm = presets::panda();
    let mut columns = LogColumns { q_rad: vec![vec![]; 7], dq_rad_s: vec![vec![]; 7], ..LogColumns::default() };
    columns.tau_j_nm = vec![vec![]; 7];
    for &t_s in &time_s {
        let (mut q, mut qd, mut qdd) = motion(t_s);
        for &j in standing {
            (q[j], qd[j], qdd[j]) = (presets::panda_ready_pose()[j], 0.0, 0.0);
        }
        let tau = rnea(&arm, &q, &qd, &qdd) + friction().torque(&qd, SMOOTHING_RAD_S) + Vector::from(OFFSET_NM);
        for j in 0..7 {
            columns.q_rad[j].push(q[j]);
            columns.dq_rad_s[j].push(qd[j]);
            columns.tau_j_nm[j].push(tau[j]);
        }
    }
    LogColumns { time_s, ..columns }.validate().unwrap()
}

fn regular(rows: usize) -> Vec<f64> {
    (0..rows).map(|k| k as f64 * 1e-3).collect()
}

/// Stamps that jitter by up to 40 % of a period, with every 17th row missing.
fn irregular(rows: usize) -> Vec<f64> {
    let jitter = |k: usize| 0.4e-3 * ((k * k * 7919 % 1009) as f64 / 1009.0 - 0.5) * 2.0;
    (0..rows).filter(|k| k % 17 != 3).map(|k| k as f64 * 1e-3 + jitter(k)).collect()
}

fn residual_of(log: &RobotLog) -> TorqueResidual<7> {
    TorqueResidual::of_log(log, &presets::panda(), &ResidualSettings::default()).unwrap()
}

fn assert_recovered(report: &FrictionReport, joints: impl IntoIterator<Item = usize>, tolerance_nm: f64) {
    for j in joints {
        let (fit, held_out) = (report.joints[j].fit.unwrap(), report.joints[j].held_out.unwrap());
        assert!((fit.coulomb_nm - COULOMB_NM[j]).abs() < tolerance_nm, "joint {j}: {fit:?}");
        assert!((fit.viscous_nm_s_per_rad - VISCOUS_NM_S_PER_RAD[j]).abs() < tolerance_nm, "joint {j}: {fit:?}");
        assert!((fit.offset_nm - OFFSET_NM[j]).abs() < tolerance_nm, "joint {j}: {fit:?}");
        assert!(held_out.rms_fit_test_nm < tolerance_nm, "joint {j}: {held_out:?}");
        assert!(held_out.sd.iter().all(|&sd| sd < tolerance_nm), "joint {j}: {held_out:?}");
    }
}

/// What remains is the sharp reversal, of which measured torque sees the smoother and the column does not: 0.1 mNm.
const TOLERANCE_NM: f64 = 3e-4;

#[test]
fn friction_is_recovered_and_the_residual_vanishes() {
    let residual = residual_of(&log_at(regular(21_000), &[]));
    let report = FrictionReport::of(&residual, Some(&friction()), &FrictionSettings::default());
    assert_recovered(&report, 0..7, TOLERANCE_NM);
    for joint in &report.joints {
        // The given model lacks the offset and nothing else.
        let (rms, sd) = (joint.rms_with_model_nm.unwrap(), joint.sd_with_model_nm.unwrap());
        assert!((rms - OFFSET_NM[joint.joint].abs()).abs() < TOLERANCE_NM && sd < TOLERANCE_NM, "{joint:?}");
        assert!(joint.sd_rigid_nm > 0.3, "{joint:?}");
    }
}

/// Power check: friction of the wrong sign doubles the residual instead of removing it.
#[test]
fn a_flipped_sign_would_show() {
    let residual = residual_of(&log_at(regular(12_000), &[]));
    let flipped = friction().scaled(-1.0);
    let report = FrictionReport::of(&residual, Some(&flipped), &FrictionSettings::default());
    for joint in &report.joints {
        assert!((joint.sd_with_model_nm.unwrap() / joint.sd_rigid_nm - 2.0).abs() < 0.01, "{joint:?}");
    }
}

/// Zero phase of the whole chain: filtered motion and torque equal the closed form at the reported times, once the ends
/// (where the band filter guesses, alike on both sides) are forgotten.
#[test]
fn velocity_and_model_stay_where_they_were_in_time() {
    let residual = residual_of(&log_at(regular(6_000), &[]));
    let memory = (residual.chain.memory_s() * residual.chain.rate_hz) as usize;
    for k in memory..residual.samples() - memory {
        let t_s = residual.time_s[k];
        let (q, qd, qdd) = motion(t_s);
        let tau = rnea(&presets::panda(), &q, &qd, &qdd);
        for j in 0..7 {
            // A delay of one sample would be 1 ms times 1 rad/s² = 1e-3 rad/s; measured are 6e-7 rad/s and 5e-6 Nm.
            assert!((residual.qd_rad_s[j][k] - qd[j]).abs() < 1e-5, "joint {j} at {t_s} s");
            assert!((residual.model_nm[j][k] - tau[j]).abs() < 1e-4, "joint {j} at {t_s} s");
        }
    }
}

#[test]
fn irregular_stamps_say_what_regular_ones_say() {
    let [even, uneven] = [regular(21_000), irregular(21_000)].map(|time_s| {
        let residual = residual_of(&log_at(time_s, &[]));
        assert_eq!(residual.bursts.len(), 1);
        FrictionReport::of(&residual, None, &FrictionSettings::default())
    });
    assert_recovered(&uneven, 0..7, TOLERANCE_NM);
    for (a, b) in even.joints.iter().zip(&uneven.joints) {
        assert!((a.rms_rigid_nm / b.rms_rigid_nm - 1.0).abs() < 2e-3, "{a:?} {b:?}");
    }
}

#[test]
fn gaps_split_bursts_and_nothing_is_computed_across_them() {
    let inside = |t: &f64| !(5.0..5.4).contains(t) && !(12.0..12.03).contains(t) && !(15.0..15.15).contains(t);
    let mut time_s: Vec<f64> = regular(21_000).into_iter().filter(inside).collect();
    time_s.retain(|t| !(15.3..15.5).contains(t)); // leaves 0.15 s between two gaps: too short
    let residual = residual_of(&log_at(time_s, &[]));
    assert_eq!((residual.bursts.len(), residual.skipped_bursts), (4, 1));
    let ends = |k: usize| {
        let burst = &residual.bursts[k];
        (residual.time_s[burst.start], residual.time_s[burst.end - 1])
    };
    assert!((ends(0).1 - 4.849).abs() < 2e-3 && (ends(1).0 - 5.55).abs() < 2e-3, "{:?} {:?}", ends(0), ends(1));
    let report = FrictionReport::of(&residual, None, &FrictionSettings::default());
    assert_recovered(&report, 0..7, TOLERANCE_NM);
}

#[test]
fn a_standing_joint_says_so_and_the_others_go_on() {
    let log = log_at(regular(21_000), &[2]);
    let report = FrictionReport::of(&residual_of(&log), None, &FrictionSettings::default());
    assert!(matches!(report.joints[2].fit, Err(JointFitError::OneWay { .. })), "{:?}", report.joints[2]);
    assert!(matches!(report.joints[2].held_out, Err(HeldOutError::Fold { fold: 0, .. })));
    assert_recovered(&report, [0, 1, 3, 4, 5, 6], TOLERANCE_NM);
}

#[test]
fn averaging_keeps_the_answer_and_lowers_the_rate() {
    let log = log_at(regular(21_000), &[]);
    let settings = ResidualSettings { average_samples: 40, ..ResidualSettings::default() };
    let residual = TorqueResidual::of_log(&log, &presets::panda(), &settings).unwrap();
    assert_eq!(residual.samples(), 20_700 / 40);
    assert!((residual.chain.output_rate_hz() - 25.0).abs() < 1e-9);
    assert!((residual.time_s[1] - residual.time_s[0] - 0.04).abs() < 1e-9);
    let column = residual.column(|at| at.qd[3]);
    assert_eq!(column, residual.qd_rad_s[3]);
    assert_recovered(&FrictionReport::of(&residual, None, &FrictionSettings::default()), 0..7, TOLERANCE_NM);
}

#[test]
fn each_way_to_fail_is_named_with_its_numbers() {
    let (panda, settings) = (presets::panda(), ResidualSettings::default());
    let short = TorqueResidual::of_log(&log_at(regular(350), &[]), &panda, &settings).unwrap_err();
    assert_eq!(short.to_string(), "the longest of 1 bursts lasts 0.349 s, a band of 10.0 Hz needs 0.400 s");

    let log = log_at(regular(3_000), &[]);
    let arm = Arm::<6> {
        name: "six".to_owned(),
        joint_names: JointNames::default(),
        mechanism: tribo_robot::Mechanism {
            placements: std::array::from_fn(|j| panda.placements[j]),
            links: std::array::from_fn(|j| panda.links[j]),
            link_from_flange_rotation: panda.link_from_flange_rotation,
            link_from_flange_translation: panda.link_from_flange_translation,
        }
        .into(),
        rotor_inertia_kg_m2: SVector::zeros(),
        limits: tribo_robot::Limits {
            q_min_rad: SVector::repeat(-3.0),
            q_max_rad: SVector::repeat(3.0),
            qd_max_rad_s: SVector::repeat(2.0),
            tau_max_nm: SVector::repeat(87.0),
            tau_rate_max_nm_s: SVector::repeat(1000.0),
        },
        gravity_m_s2: panda.gravity_m_s2,
    };
    let count = TorqueResidual::of_log(&log, &arm, &settings).unwrap_err();
    assert!(matches!(count, ResidualError::JointCount { log: 7, arm: 6 }), "{count}");

    let broken = presets::panda().altered(|mechanism| mechanism.links[3].mass_kg = f64::NAN);
    let nan = TorqueResidual::of_log(&log, &broken, &settings).unwrap_err();
    assert!(matches!(nan, ResidualError::ModelNotFinite { joint: 0, .. }), "{nan}");

    for band_hz in [0.0, -1.0, f64::NAN, 400.0] {
        let band = ResidualSettings { band_hz, ..settings };
        assert!(matches!(TorqueResidual::of_log(&log, &panda, &band), Err(ResidualError::Band { .. })), "{band_hz}");
    }
    let gap = ResidualSettings { longest_gap_s: Some(f64::NAN), ..settings };
    assert!(matches!(TorqueResidual::of_log(&log, &panda, &gap), Err(ResidualError::LongestGap { .. })));
    let none = ResidualSettings { average_samples: 0, ..settings };
    assert!(matches!(TorqueResidual::of_log(&log, &panda, &none), Err(ResidualError::NothingAveraged)));
}

/// A log too short for blocks still has a residual and a fit.
#[test]
fn too_few_blocks_cost_the_held_out_figure_only() {
    let residual = residual_of(&log_at(regular(6_000), &[]));
    let report = FrictionReport::of(&residual, None, &FrictionSettings::default());
    let few = BlocksError::TooFewBlocks { got: 3, folds: 5, length_s: BlockSettings::default().length_s };
    assert_eq!(report.blocks, Err(few));
    assert!(report.joints.iter().all(|joint| joint.fit.is_ok() && joint.held_out == Err(few.into())));
}
