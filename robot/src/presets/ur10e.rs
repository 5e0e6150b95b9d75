//! Universal Robots UR10e, six joints.

use nalgebra::SVector;
use std::f64::consts::{FRAC_PI_2, PI};

use super::e_series::{self, Numbers};
use super::{Link, Preset};
use crate::Arm;

/// Standard DH rows (a (m), d (m), alpha (rad)). Source: universal-robots.com, "DH Parameters for calculations of
/// kinematics and dynamics".
const DH: [(f64, f64, f64); 6] = [
    (0.0, 0.1807, FRAC_PI_2),
    (-0.6127, 0.0, 0.0),
    (-0.57155, 0.0, 0.0),
    (0.0, 0.17415, FRAC_PI_2),
    (0.0, 0.11985, -FRAC_PI_2),
    (0.0, 0.11655, 0.0),
];

/// Links in the frame at the **far** end of each, as the standard convention has it. Source: the same page.
const LINKS: [Link; 6] = [
    (7.369, [0.021, 0.0, 0.027], [0.03408, 0.00002, -0.00425, 0.03529, 0.00008, 0.02156]),
    (13.051, [0.38, 0.0, 0.158], [0.02814, 0.00005, -0.01561, 0.77068, 0.00002, 0.76943]),
    (3.989, [0.24, 0.0, 0.068], [0.01014, 0.00008, 0.00916, 0.30928, 0.0, 0.30646]),
    (2.1, [0.0, 0.007, 0.018], [0.00296, -0.00001, 0.0, 0.00222, -0.00024, 0.00258]),
    (1.98, [0.0, 0.007, 0.018], [0.00296, -0.00001, 0.0, 0.00222, -0.00024, 0.00258]),
    (0.615, [0.0, 0.0, -0.026], [0.0004, 0.0, 0.0, 0.00041, 0.0, 0.00034]),
];

/// The UR10e without payload (`e_series.rs` says in which frames).
///
/// Limits of position, speed and torque from Universal_Robots_ROS2_Description `config/ur10e/joint_limits.yaml`. The vendor
/// publishes no rotor inertia. Assumption: 0.1 kg m² in every joint, the armature in mujoco_menagerie
/// `universal_robots_ur10e`, which calls it not carefully tuned.
pub fn ur10e() -> Arm<6> {
    e_series::arm(&Numbers {
        name: "ur10e",
        dh: DH,
        links: LINKS,
        qd_max_rad_s: [2.0 * PI / 3.0, 2.0 * PI / 3.0, PI, PI, PI, PI],
        tau_max_nm: [330.0, 330.0, 150.0, 56.0, 56.0, 56.0],
        rotor_inertia_kg_m2: [0.1; 6],
    })
}

/// The UR10e with its poses, all elbow-up with the tool down: the middle of the workspace, to its side, and further out.
///
/// Joint stiffness is an assumption, as the vendor publishes none: the order of magnitude of strain-wave gears of the size
/// of these joints (330, 150 and 56 Nm).
pub(super) fn preset() -> Preset<6> {
    Preset {
        arm: ur10e(),
        poses_rad: [
            SVector::from([0.0, -1.8, 2.0, -1.77, -FRAC_PI_2, 0.0]),
            SVector::from([0.8, -1.5, 1.7, -1.7, -1.4, 0.4]),
            SVector::from([-0.6, -2.1, 1.9, -1.3, -1.7, -0.5]),
        ],
        joint_stiffness_nm_per_rad: [3e4, 3e4, 2e4, 9e3, 9e3, 9e3],
    }
}
