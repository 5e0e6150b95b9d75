//! Franka Research 3, seven joints.

use nalgebra::{Matrix3, SVector, Vector3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use super::panda::{DH, FLANGE_D_M, PANDA_JOINT_STIFFNESS_NM_PER_RAD, ROTOR_INERTIA};
use super::{Link, Preset, links};
use crate::{Arm, JointPlacement, Limits, ModifiedDh};

/// Links. Source: franka_description `robots/fr3/inertials.yaml` (the vendor's own, axes of the link frames).
const LINKS: [Link; 7] = [
    (
        2.9274653454,
        [4.128e-7, -0.0181251324, -0.038603597],
        [
            0.023927316485107913,
            1.3317903455714081e-5,
            -0.00011404774918616684,
            0.0224821613275756,
            -0.0019950320628240115,
            0.006350098258530016,
        ],
    ),
    (
        2.9355370338,
        [0.0031828864, -0.0743221644, 0.0088146084],
        [
            0.041938946257609425,
            0.00020257331521090626,
            0.004077784227179924,
            0.02514514885014724,
            -0.0042252158006570156,
            0.06170214472888839,
        ],
    ),
    (
        2.2449013699,
        [0.0407015686, -0.0048200565, -0.0289730823],
        [
            0.02410142547240885,
            0.002404694559042109,
            -0.002856269270114313,
            0.01974053266708178,
            -0.002104212683891874,
            0.019044494482244823,
        ],
    ),
    (
        2.6155955791,
        [-0.0459100965, 0.063049296, -0.0085187868],
        [
            0.03452998321913202,
            0.01322552265982813,
            0.01015142998484113,
            0.028881621933049058,
            -0.0009762833870704552,
            0.04125471171146641,
        ],
    ),
    (
        2.3271207594,
        [-0.0016039605, 0.0292536262, -0.097296599],
        [
            0.051610278463662895,
            -0.005715173387783472,
            -0.0035673167625872135,
            0.04787729713371481,
            0.010673985108535986,
            0.016423625579357254,
        ],
    ),
    (
        1.8170376524,
        [0.0597131221, -0.0410294666, -0.0101692726],
        [
            0.005412333594383447,
            0.006193456360285834,
            0.0014219289306117652,
            0.014058329545509979,
            -0.0013140753741120031,
            0.016080817924212554,
        ],
    ),
    (
        0.6271432862,
        [0.0045225817, 0.0086261921, -0.0161633251],
        [
            0.00021092389150104718,
            -2.433299114461931e-5,
            4.564480393778983e-5,
            0.00017718568002411474,
            8.744070223226438e-5,
            5.993190599659971e-5,
        ],
    ),
];

/// The FR3 without payload; flange 0.107 m beyond joint 7.
///
/// Kinematics as the Panda's (franka_description: one file for both). Limits of position, speed and torque from
/// franka_description `robots/fr3/joint_limits.yaml`; torque rate from libfranka `rate_limiting.h`. Rotor inertia as
/// the vendor gives it (see the Panda).
pub fn fr3() -> Arm<7> {
    Arm {
        name: "fr3".to_owned(),
        placements: DH.map(|(a_m, d_m, alpha_rad)| JointPlacement::from(ModifiedDh { a_m, d_m, alpha_rad })),
        links: links(&LINKS),
        link_from_flange_rotation: Matrix3::identity(),
        link_from_flange_translation: Vector3::new(0.0, 0.0, FLANGE_D_M),
        rotor_inertia_kg_m2: SVector::from(ROTOR_INERTIA),
        limits: Limits {
            q_min_rad: SVector::from([-2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159]),
            q_max_rad: SVector::from([2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159]),
            qd_max_rad_s: SVector::from([2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26]),
            tau_max_nm: SVector::from([87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0]),
            tau_rate_max_nm_s: SVector::repeat(1000.0),
        },
        gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
    }
}

/// The FR3 with its poses: the vendor's ready pose and the Panda's two others. Joint stiffness: the assumption made for
/// the Panda.
pub(super) fn preset() -> Preset<7> {
    Preset {
        arm: fr3(),
        poses_rad: [
            SVector::from([0.0, -FRAC_PI_4, 0.0, -3.0 * FRAC_PI_4, 0.0, FRAC_PI_2, FRAC_PI_4]),
            SVector::from([0.4, -0.3, 0.2, -2.0, 0.3, 1.9, 0.5]),
            SVector::from([-0.5, 0.1, -0.3, -1.8, -0.2, 1.8, 1.0]),
        ],
        joint_stiffness_nm_per_rad: PANDA_JOINT_STIFFNESS_NM_PER_RAD,
    }
}
