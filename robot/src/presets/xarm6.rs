//! UFACTORY xArm 6, six joints.

use nalgebra::{SVector, Vector3};
use std::f64::consts::PI;

use super::{Link, Preset, links, quarter_turns_x};
use crate::{Arm, JointNames, JointPlacement, Limits, Mechanism};

/// Origins of the joints (m) and quarter turns about the parents x axis. Source: xarm_ros
/// `xarm_description/config/kinematics/default/xarm6_default_kinematics.yaml`; its 1.5708 and the 3.14 of the speed limits are meant as π/2 and π.
const PLACEMENTS: [([f64; 3], i32); 6] = [
    ([0.0, 0.0, 0.267], 0),
    ([0.0, 0.0, 0.0], -1),
    ([0.0535, -0.2845, 0.0], 0),
    ([0.0775, 0.3425, 0.0], -1),
    ([0.0, 0.0, 0.0], 1),
    ([0.076, 0.097, 0.0], -1),
];

/// Links. Source: xarm_ros `xarm_description/config/link_inertial/xarm6_type6_HT_BR2.yaml`.
const LINKS: [Link; 6] = [
    (2.3814, [0.00022, 0.02951, -0.0124], [0.0058562, -1.79e-5, 3.55e-6, 0.0050316, -0.000888336, 0.003536652]),
    (2.2675, [0.03881, -0.22783, 0.03496], [0.028315776, 0.005, 0.00066546, 0.0058, -0.0045741, 0.0273447]),
    (1.875, [0.07041, 0.11631, 0.0107], [0.0063483, -0.0015397, 0.00096858, 0.00379758, 0.00186567, 0.00595768]),
    (1.3192, [-0.00018, 0.01798, -0.02291], [0.004896, -6.925e-6, -1.418e-5, 0.00445694, -0.00023186, 0.00134332]),
    (
        1.33854,
        [0.0651, 0.03096, 0.00315],
        [0.00146378, -0.000450624, 0.000284306, 0.00184192, 0.000130866, 0.002333524],
    ),
    (0.17, [0.0, -0.00677, -0.01098], [9.3e-5, 0.0, 0.0, 5.87e-5, -3.6e-6, 0.000132]),
];

/// The xArm 6 without payload; flange: `link_eef`, the frame of the last link.
///
/// Limits of position, speed and torque from xarm_ros `xarm_description/urdf/xarm6`. The vendor publishes neither torque
/// rate nor rotor inertia. Assumptions: 1000 Nm/s, as the Pandas; 0.1 kg m² at 50 Nm and in proportion to the torque limit, as
/// in the joints of the UR5e.
pub fn xarm6() -> Arm<6> {
    let tau_max_nm = SVector::from([50.0, 50.0, 32.0, 32.0, 32.0, 20.0]);
    Arm {
        name: "xarm6".to_owned(),
        joint_names: JointNames::numbered("joint", 6),
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
            q_min_rad: SVector::from([-2.0 * PI, -2.059, -3.927, -2.0 * PI, -1.69297, -2.0 * PI]),
            q_max_rad: SVector::from([2.0 * PI, 2.0944, 0.19198, 2.0 * PI, PI, 2.0 * PI]),
            qd_max_rad_s: SVector::repeat(PI),
            tau_max_nm,
            tau_rate_max_nm_s: SVector::repeat(1000.0),
        },
        gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
    }
}

/// The xArm 6 with its poses, the tool down in front of the arm, to its side, and further out.
///
/// Joint stiffness is an assumption, as the vendor publishes none: the order of magnitude of strain-wave gears of this size.
pub(super) fn preset() -> Preset<6> {
    Preset {
        arm: xarm6(),
        poses_rad: [
            SVector::from([0.0, -0.3, -1.1, 0.0, 1.4, 0.0]),
            SVector::from([0.7, -0.2, -1.3, 0.2, 1.3, 0.4]),
            SVector::from([-0.5, 0.0, -1.2, -0.3, 1.0, -0.5]),
        ],
        joint_stiffness_nm_per_rad: [1e4, 1e4, 6e3, 6e3, 6e3, 4e3],
    }
}
