//! KUKA LBR iiwa 14 R820, seven joints.

use nalgebra::{Matrix3, SVector, Vector3};

use super::{Link, Preset, links};
use crate::{Arm, JointNames, JointPlacement, Limits, Mechanism};

/// Rows of the rotation of each joint frame at q = 0, and its origin (m), in the link before. Source: drake_models
/// `iiwa14_no_collision.urdf` (after iiwa_stack); its roll, pitch and yaw are quarter turns, written out here.
const PLACEMENTS: [([f64; 9], [f64; 3]); 7] = [
    ([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.1575]),
    (ROLL_AND_HALF_YAW, [0.0, 0.0, 0.2025]),
    (ROLL_AND_HALF_YAW, [0.0, 0.2045, 0.0]),
    (ROLL, [0.0, 0.0, 0.2155]),
    (ROLL_AND_HALF_YAW, [0.0, 0.1845, 0.0]),
    (ROLL, [0.0, 0.0, 0.2155]),
    (ROLL_AND_HALF_YAW, [0.0, 0.081, 0.0]),
];

/// A quarter turn about x.
const ROLL: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0];
/// A quarter turn about x, then half a turn about z: roll π/2 and yaw π, or roll −π/2 and pitch π.
const ROLL_AND_HALF_YAW: [f64; 9] = [-1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0];

/// Links. Source: the same file (masses and diagonal inertias rounded by their authors).
const LINKS: [Link; 7] = [
    (5.76, [0.0, -0.03, 0.12], [0.033, 0.0, 0.0, 0.0333, 0.0, 0.0123]),
    (6.35, [0.0003, 0.059, 0.042], [0.0305, 0.0, 0.0, 0.0304, 0.0, 0.011]),
    (3.5, [0.0, 0.03, 0.13], [0.025, 0.0, 0.0, 0.0238, 0.0, 0.0076]),
    (3.5, [0.0, 0.067, 0.034], [0.017, 0.0, 0.0, 0.0164, 0.0, 0.006]),
    (3.5, [0.0001, 0.021, 0.076], [0.01, 0.0, 0.0, 0.0087, 0.0, 0.00449]),
    (1.8, [0.0, 0.0006, 0.0004], [0.0049, 0.0, 0.0, 0.0047, 0.0, 0.0036]),
    (1.2, [0.0, 0.0, 0.02], [0.001, 0.0, 0.0, 0.001, 0.0, 0.001]),
];

/// The iiwa 14 without payload; flange: `iiwa_link_ee_kuka`, 0.045 m beyond joint 7.
///
/// Limits of position, speed and torque from the same file. The vendor publishes neither torque rate nor rotor inertia.
/// Assumptions: 1000 Nm/s, as the Panda's; rotor inertia as the vendor of the FR3 gives it for gears of this kind.
pub fn iiwa14() -> Arm<7> {
    let degrees = |values: [f64; 7]| SVector::from(values.map(f64::to_radians));
    let q_max_rad = degrees([170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 175.0]);
    Arm {
        name: "iiwa14".to_owned(),
        joint_names: JointNames::numbered("iiwa_joint_", 7),
        mechanism: Mechanism {
            placements: PLACEMENTS.map(|(rows, origin)| JointPlacement {
                rotation: Matrix3::from_row_slice(&rows),
                translation: Vector3::from(origin),
            }),
            links: links(&LINKS),
            link_from_flange_rotation: Matrix3::identity(),
            link_from_flange_translation: Vector3::new(0.0, 0.0, 0.045),
        }
        .into(),
        rotor_inertia_kg_m2: SVector::from(super::panda::ROTOR_INERTIA),
        limits: Limits {
            q_min_rad: -q_max_rad,
            q_max_rad,
            qd_max_rad_s: degrees([85.0, 85.0, 100.0, 75.0, 130.0, 135.0, 135.0]),
            tau_max_nm: SVector::from([320.0, 320.0, 176.0, 176.0, 110.0, 40.0, 40.0]),
            tau_rate_max_nm_s: SVector::repeat(1000.0),
        },
        gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
    }
}

/// The iiwa 14 with its poses: elbow bent and tool down, and two others of the workspace.
///
/// Joint stiffness is an assumption, as the vendor publishes none: the order of magnitude of strain-wave gears of this size.
pub(super) fn preset() -> Preset<7> {
    Preset {
        arm: iiwa14(),
        poses_rad: [
            SVector::from([0.0, 0.5, 0.0, -1.6, 0.0, 1.04, 0.0]),
            SVector::from([0.4, 0.7, 0.2, -1.4, 0.3, 1.2, 0.5]),
            SVector::from([-0.5, 0.4, -0.3, -1.8, -0.2, 1.1, 1.0]),
        ],
        joint_stiffness_nm_per_rad: [2e4, 2e4, 1.4e4, 1.4e4, 1.2e4, 9e3, 9e3],
    }
}
