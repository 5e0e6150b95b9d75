//! Franka Research 3, seven joints.

use nalgebra::SVector;

use super::{Link, Preset, links, panda, panda_preset};
use crate::{Arm, JointNames, Limits};

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
/// Kinematics as the Panda's (franka_description: one file for both). Limits of position and speed from
/// franka_description `robots/fr3/joint_limits.yaml`, which has the Panda's for torque; torque rate and rotor inertia are the Panda's too.
pub fn fr3() -> Arm<7> {
    let panda = panda().altered(|mechanism| mechanism.links = links(&LINKS));
    Arm {
        name: "fr3".to_owned(),
        joint_names: JointNames::numbered("fr3_joint", 7),
        limits: Limits {
            q_min_rad: SVector::from([-2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159]),
            q_max_rad: SVector::from([2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159]),
            qd_max_rad_s: SVector::from([2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26]),
            ..panda.limits
        },
        ..panda
    }
}

/// The FR3 with the Panda's poses, the first being the vendor's ready pose of both. Joint stiffness: the assumption made for
/// the Panda.
pub(super) fn preset() -> Preset<7> {
    Preset { arm: fr3(), ..panda_preset() }
}
