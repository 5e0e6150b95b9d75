//! The Panda against Pinocchio: 64 states of `tests/reference/panda_dynamics.json` (source named in the file).

use nalgebra::{Matrix3, SMatrix, SVector, Vector6};
use serde::Deserialize;
use tribo_robot::{Kinematics, bias_torque, forward_dynamics, gravity_torque, mass_matrix, presets, rnea};

/// Two double-precision algorithms of a few hundred operations each agree to about 1e-13; 1e-10 is the contract.
const RELATIVE_TOLERANCE: f64 = 1e-10;

#[derive(Deserialize)]
struct Reference {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    q: [f64; 7],
    qd: [f64; 7],
    qdd: [f64; 7],
    tau: [f64; 7],
    mass_matrix: [[f64; 7]; 7],
    nle: [f64; 7],
    gravity: [f64; 7],
    flange_position: [f64; 3],
    flange_rotation: [[f64; 3]; 3],
    jacobian_linear_then_angular: [[f64; 7]; 6],
    jdot_qd_linear_then_angular: [f64; 6],
}

fn assert_close<const R: usize, const C: usize>(
    what: &str,
    case: usize,
    ours: &SMatrix<f64, R, C>,
    theirs: &SMatrix<f64, R, C>,
) {
    let error = (ours - theirs).amax() / theirs.amax().max(1.0);
    assert!(error < RELATIVE_TOLERANCE, "{what}, case {case}: relative error {error:e}");
}

/// The reference file has linear rows first; ours are angular first.
fn angular_first<const C: usize>(linear_first: SMatrix<f64, 6, C>) -> SMatrix<f64, 6, C> {
    let mut m = SMatrix::<f64, 6, C>::zeros();
    m.fixed_rows_mut::<3>(0).copy_from(&linear_first.fixed_rows::<3>(3));
    m.fixed_rows_mut::<3>(3).copy_from(&linear_first.fixed_rows::<3>(0));
    m
}

#[test]
fn panda_agrees_with_pinocchio_at_64_states() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/reference/panda_dynamics.json");
    let reference: Reference = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert_eq!(reference.cases.len(), 64);
    let arm = presets::panda().link_side();
    for (k, case) in reference.cases.iter().enumerate() {
        let (q, qd, qdd) = (SVector::from(case.q), SVector::from(case.qd), SVector::from(case.qdd));
        let tau = SVector::from(case.tau);
        let kinematics = Kinematics::at(&arm, &q);
        assert_close("flange position", k, &kinematics.flange_origin, &SVector::from(case.flange_position));
        let rotation = Matrix3::from_fn(|r, c| case.flange_rotation[r][c]);
        assert_close("flange rotation", k, &kinematics.flange_rotation, &rotation);
        let jacobian = angular_first(SMatrix::from_fn(|r, c| case.jacobian_linear_then_angular[r][c]));
        assert_close("Jacobian", k, &kinematics.jacobian(), &jacobian);
        let drift = angular_first(Vector6::from(case.jdot_qd_linear_then_angular));
        assert_close("Jdot qd", k, &kinematics.jdot_qd(&qd), &drift);
        let mass = SMatrix::from_fn(|r, c| case.mass_matrix[r][c]);
        assert_close("mass matrix", k, &mass_matrix(&arm, &q), &mass);
        assert_close("bias", k, &bias_torque(&arm, &q, &qd), &SVector::from(case.nle));
        assert_close("gravity", k, &gravity_torque(&arm, &q), &SVector::from(case.gravity));
        assert_close("gravity from kinematics", k, &kinematics.gravity_torque(&arm), &SVector::from(case.gravity));
        assert_close("RNEA", k, &rnea(&arm, &q, &qd, &qdd), &tau);
        assert_close("ABA", k, &forward_dynamics(&arm, &q, &qd, &tau), &qdd);
    }
}
