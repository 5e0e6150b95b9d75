//! UFACTORY xArm 7, seven joints.

use nalgebra::{SVector, Vector3};
use std::f64::consts::PI;

use super::{Link, Preset, links, quarter_turns_x};
use crate::{Arm, JointNames, JointPlacement, Limits, Mechanism};

/// Origins of the joints (m) and quarter turns about the parents x axis. Source: xarm_ros
/// `xarm_description/config/kinematics/default/xarm7_default_kinematics.yaml`; its 1.5708 and the 3.14 of the speed limits are meant as π/2 and π.
const PLACEMENTS: [([f64; 3], i32); 7] = [
    ([0.0, 0.0, 0.267], 0),
    ([0.0, 0.0, 0.0], -1),
    ([0.0, -0.293, 0.0], 1),
    ([0.0525, 0.0, 0.0], 1),
    ([0.0775, -0.3425, 0.0], 1),
    ([0.0, 0.0, 0.0], 1),
    ([0.076, 0.097, 0.0], -1),
];

/// Links. Source: xarm_ros `xarm_description/config/link_inertial/xarm7_type7_HT_BR2.yaml`.
const LINKS: [Link; 7] = [
    (2.382, [-0.0002, 0.02905, -0.01233], [0.0056905, -1.579e-5, 5.125e-6, 0.0049566, -0.000873378, 0.003316654]),
    (1.869, [0.00022, -0.12856, 0.01735], [0.0095989, 1.541e-6, 5.56e-6, 0.00382472, -0.00317156, 0.007565669]),
    (1.6383, [0.0466, -0.02463, -0.00768], [0.00310955, 0.00030837, -0.00058453, 0.00264483, 0.000338893, 0.0026624]),
    (1.7269, [0.07047, -0.11575, 0.012], [0.005889, 0.00137112, 0.00088143, 0.00359703, -0.001762155, 0.00543244]),
    (1.3203, [-0.00032, 0.01604, -0.026], [0.00534665, 1.5117e-5, -3.69e-7, 0.0049779, -0.00022132, 0.0013624]),
    (1.325, [0.06469, 0.03278, 0.02141], [0.0014745, -0.000488, 0.0002953, 0.0019037, 0.00014749, 0.0023652]),
    (0.17, [0.0, -0.00677, -0.01098], [9.3e-5, 0.0, 0.0, 5.87e-5, -3.6e-6, 0.000132]),
];

/// The xArm 7 without payload; flange: `link_eef`, the frame of the last link.
///
/// Limits of position, speed and torque from xarm_ros `xarm_description/urdf/xarm7`. The vendor publishes neither torque
/// rate nor rotor inertia. Assumptions: 1000 Nm/s, as the Pandas; 0.1 kg m² at 50 Nm and in proportion to the torque limit, as
/// in the joints of the UR5e.
pub fn xarm7() -> Arm<7> {
    let tau_max_nm = SVector::from([50.0, 50.0, 30.0, 30.0, 30.0, 20.0, 20.0]);
    Arm {
        name: "xarm7".to_owned(),
        joint_names: JointNames::numbered("joint", 7),
        mechanism: Mechanism {
            placements: PLACEMENTS.map(|(origin, turns)| JointPlacement {
                rotation: quarter_turns_x(turns),
                translation: Vector3::from(origin),
            }),
            links: links(&LINKS),
            link_from_flange_rotation: quarter_turns_x(0),
            link_from_flange_translation: Vector3::zeros(),
        }
        .into(),
        rotor_inertia_kg_m2: tau_max_nm * (0.1 / 50.0),
        limits: Limits {
            q_min_rad: SVector::from([-2.0 * PI, -2.059, -2.0 * PI, -0.19198, -2.0 * PI, -1.69297, -2.0 * PI]),
            q_max_rad: SVector::from([2.0 * PI, 2.0944, 2.0 * PI, 3.927, 2.0 * PI, PI, 2.0 * PI]),
            qd_max_rad_s: SVector::repeat(PI),
            tau_max_nm,
            tau_rate_max_nm_s: SVector::repeat(1000.0),
        },
        gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
    }
}

/// The xArm 7 with its poses, the tool down in front of the arm, to its side, and further out.
///
/// Joint stiffness is an assumption, as the vendor publishes none: the order of magnitude of strain-wave gears of this size.
pub(super) fn preset() -> Preset<7> {
    Preset {
        arm: xarm7(),
        poses_rad: [
            SVector::from([0.0, -0.25, 0.0, 0.9, 0.0, 1.15, 0.0]),
            SVector::from([0.5, -0.1, 0.3, 1.2, 0.2, 1.2, 0.4]),
            SVector::from([-0.5, 0.1, -0.3, 1.0, -0.3, 0.9, -0.4]),
        ],
        joint_stiffness_nm_per_rad: [1e4, 1e4, 6e3, 6e3, 6e3, 4e3, 4e3],
    }
}
