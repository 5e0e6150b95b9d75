//! Presets and URDFs against Pinocchio: the states of `tests/reference/*_dynamics.json` (source named in each file).

use nalgebra::{Matrix3, SMatrix, SVector, Vector6};
use serde::Deserialize;
use tribo_robot::presets::AnyPreset;
use tribo_robot::urdf::{self, to_urdf};
use tribo_robot::{Arm, Kinematics, bias_torque, forward_dynamics, gravity_torque, mass_matrix, presets, rnea};

/// Two double-precision algorithms of a few hundred operations each agree to about 1e-13; 1e-10 is the contract.
const RELATIVE_TOLERANCE: f64 = 1e-10;

#[derive(Deserialize)]
struct Reference {
    urdf: Option<String>,
    total_mass_kg: Option<f64>,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    tau: Vec<f64>,
    mass_matrix: Vec<Vec<f64>>,
    nle: Vec<f64>,
    gravity: Vec<f64>,
    flange_position: [f64; 3],
    flange_rotation: [[f64; 3]; 3],
    jacobian_linear_then_angular: [Vec<f64>; 6],
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

fn reference(name: &str) -> Reference {
    let path = format!("{}/reference/{name}_dynamics.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("the reference")).expect("its form")
}

/// Every algorithm on the link side of `arm` against every case.
fn agree<const N: usize>(arm: Arm<N>, reference: &Reference, cases: usize) {
    assert_eq!(reference.cases.len(), cases);
    let arm = arm.link_side();
    for (k, case) in reference.cases.iter().enumerate() {
        let [q, qd, qdd, tau] =
            [&case.q, &case.qd, &case.qdd, &case.tau].map(|row| SVector::<f64, N>::from_column_slice(row));
        let kinematics = Kinematics::at(&arm, &q);
        assert_close("flange position", k, &kinematics.flange_origin, &SVector::from(case.flange_position));
        let rotation = Matrix3::from_fn(|r, c| case.flange_rotation[r][c]);
        assert_close("flange rotation", k, &kinematics.flange_rotation, &rotation);
        let jacobian = angular_first(SMatrix::<f64, 6, N>::from_fn(|r, c| case.jacobian_linear_then_angular[r][c]));
        assert_close("Jacobian", k, &kinematics.jacobian(), &jacobian);
        let drift = angular_first(Vector6::from(case.jdot_qd_linear_then_angular));
        assert_close("Jdot qd", k, &kinematics.jdot_qd(&qd), &drift);
        let mass = SMatrix::<f64, N, N>::from_fn(|r, c| case.mass_matrix[r][c]);
        assert_close("mass matrix", k, &mass_matrix(&arm, &q), &mass);
        let (nle, gravity) = (SVector::from_column_slice(&case.nle), SVector::from_column_slice(&case.gravity));
        assert_close("bias", k, &bias_torque(&arm, &q, &qd), &nle);
        assert_close("gravity", k, &gravity_torque(&arm, &q), &gravity);
        assert_close("gravity from kinematics", k, &kinematics.gravity_torque(&arm), &gravity);
        assert_close("RNEA", k, &rnea(&arm, &q, &qd, &qdd), &tau);
        assert_close("ABA", k, &forward_dynamics(&arm, &q, &qd, &tau), &qdd);
    }
    if let Some(total) = reference.total_mass_kg {
        let ours: f64 = arm.links.iter().map(|link| link.mass_kg).sum();
        assert!((ours - total).abs() < 1e-12 * total, "{}: {ours} kg, not {total} kg", arm.name);
    }
}

#[test]
fn panda_agrees_with_pinocchio_at_64_states() {
    agree(presets::panda(), &reference("panda"), 64);
}

/// The references are computed from the vendors' own form of the numbers (roll, pitch and yaw; standard DH with links in their
/// far frames), the presets from ours: a number carried over wrongly shows.
#[test]
fn every_other_preset_agrees_with_the_numbers_of_its_vendor() {
    for name in presets::NAMES.into_iter().filter(|name| *name != "panda") {
        match presets::find(name).unwrap() {
            AnyPreset::Six(preset) => agree(preset.arm, &reference(name), 16),
            AnyPreset::Seven(preset) => agree(preset.arm, &reference(name), 16),
        }
    }
}

/// Fixed joints in the middle and at the end, a camera beside the chain, a link without mass, axes that are not z.
#[test]
fn a_urdf_with_odd_axes_and_welded_links_agrees_with_pinocchio() {
    let reference = reference("odd_urdf");
    let chain = urdf::parse(reference.urdf.as_deref().unwrap(), None, None).unwrap();
    let urdf = chain.arm::<7>().unwrap();
    assert_eq!(urdf.joint_names[3], "turn_3");
    assert_eq!((urdf.coulomb_nm[2], urdf.viscous_nm_s_per_rad[2]), (0.7, 0.4));
    let limits = &urdf.arm.limits;
    assert_eq!((limits.q_min_rad[3], limits.q_max_rad[3]), (-2.3, 2.3));
    assert_eq!((limits.qd_max_rad_s[3], limits.tau_max_nm[3]), (5.0, 47.0));
    // The reference is in the axes of the URDF's world link, which is our base.
    agree(urdf.arm, &reference, 16);
}

/// An arm that goes out as URDF comes back as the same arm.
#[test]
fn presets_survive_the_way_through_urdf() {
    fn through<const N: usize>(arm: &Arm<N>, reference: &Reference) {
        let back = urdf::parse(&to_urdf(arm), None, None).unwrap().arm::<N>().unwrap().arm;
        assert_eq!((&back.name, back.limits.q_min_rad), (&arm.name, arm.limits.q_min_rad));
        agree(back, reference, reference.cases.len());
    }
    for name in presets::NAMES {
        match presets::find(name).unwrap() {
            AnyPreset::Six(preset) => through(&preset.arm, &reference(name)),
            AnyPreset::Seven(preset) => through(&preset.arm, &reference(name)),
        }
    }
}
