//! Franka Emika Panda (FER), seven joints.

use nalgebra::{Matrix3, SVector, Vector3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use super::{Preset, links};
use crate::{Arm, JointNames, JointPlacement, Limits, Mechanism, ModifiedDh};

/// Modified DH rows (a (m), d (m), alpha (rad)). Source: vendor kinematics (franka_description), the same for Panda and FR3.
const DH: [(f64, f64, f64); 7] = [
    (0.0, 0.333, 0.0),
    (0.0, 0.0, -FRAC_PI_2),
    (0.0, 0.316, FRAC_PI_2),
    (0.0825, 0.0, FRAC_PI_2),
    (-0.0825, 0.384, -FRAC_PI_2),
    (0.0, 0.0, FRAC_PI_2),
    (0.088, 0.0, FRAC_PI_2),
];

/// Distance of the flange from joint 7 along its axis (m).
const FLANGE_D_M: f64 = 0.107;

/// (mass, CoM, inertia about the CoM as xx xy xz yy yz zz). Source: gaz2019, feasible parameter set.
const LINKS: [super::Link; 7] = [
    (4.970684, [0.003875, 0.002081, -0.1750], [0.70337, -0.000139, 0.006772, 0.70661, 0.019169, 0.009117]),
    (0.646926, [-0.003141, -0.02872, 0.003495], [0.007962, -0.003925, 0.010254, 0.02811, 0.000704, 0.025995]),
    (3.228604, [0.027518, 0.039252, -0.066502], [0.037242, -0.004761, -0.011396, 0.036155, -0.012805, 0.01083]),
    (3.587895, [-0.05317, 0.104419, 0.027454], [0.025853, 0.007796, -0.001332, 0.019552, 0.008641, 0.028323]),
    (1.225946, [-0.011953, 0.041065, -0.038437], [0.035549, -0.002117, -0.004037, 0.029474, 0.000229, 0.008627]),
    (1.666555, [0.060149, -0.014117, -0.010517], [0.001964, 0.000109, -0.001158, 0.004354, 0.000341, 0.005433]),
    (0.735522, [0.010517, -0.004252, 0.061597], [0.012516, -0.000428, -0.001196, 0.010027, -0.000741, 0.004815]),
];

/// Reflected rotor inertia [kg m²]. Source: vendor values for the successor FR3, as quoted by Drake's model README.
pub(super) const ROTOR_INERTIA: [f64; 7] = [0.606, 0.606, 0.462, 0.462, 0.206, 0.206, 0.206];

/// The Panda with the gaz2019 link set, reflected rotor inertia and no payload; flange 0.107 m beyond joint 7.
///
/// Limits from franka_description and libfranka `rate_limiting.h`.
pub fn panda() -> Arm<7> {
    Arm {
        name: "panda".to_owned(),
        joint_names: JointNames::numbered("panda_joint", 7),
        mechanism: Mechanism {
            placements: DH.map(|(a_m, d_m, alpha_rad)| JointPlacement::from(ModifiedDh { a_m, d_m, alpha_rad })),
            links: links(&LINKS),
            link_from_flange_rotation: Matrix3::identity(),
            link_from_flange_translation: Vector3::new(0.0, 0.0, FLANGE_D_M),
        }
        .into(),
        rotor_inertia_kg_m2: SVector::from(ROTOR_INERTIA),
        limits: Limits {
            q_min_rad: SVector::from([-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973]),
            q_max_rad: SVector::from([2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973]),
            qd_max_rad_s: SVector::from([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61]),
            tau_max_nm: SVector::from([87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0]),
            tau_rate_max_nm_s: SVector::repeat(1000.0),
        },
        gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
    }
}

/// The Panda with its poses: the ready pose and two others of the workspace.
pub fn preset() -> Preset<7> {
    Preset {
        arm: panda(),
        poses_rad: [
            panda_ready_pose(),
            SVector::from([0.4, -0.3, 0.2, -2.0, 0.3, 1.9, 0.5]),
            SVector::from([-0.5, 0.1, -0.3, -1.8, -0.2, 1.8, 1.0]),
        ],
        joint_stiffness_nm_per_rad: PANDA_JOINT_STIFFNESS_NM_PER_RAD,
    }
}

/// Stiffness (Nm/rad) between motor and link of each joint, an assumption, as the vendor publishes none: the order of
/// magnitude of strain-wave gears of this size, less for the wrist.
pub const PANDA_JOINT_STIFFNESS_NM_PER_RAD: [f64; 7] = [1.4e4, 1.4e4, 1.4e4, 1.4e4, 9e3, 9e3, 9e3];

/// The vendor's ready pose (rad).
pub fn panda_ready_pose() -> SVector<f64, 7> {
    SVector::from([0.0, -FRAC_PI_4, 0.0, -3.0 * FRAC_PI_4, 0.0, FRAC_PI_2, FRAC_PI_4])
}
