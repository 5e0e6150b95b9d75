//! Universal Robots UR5e, six joints.

use nalgebra::SVector;
use std::f64::consts::{FRAC_PI_2, PI};

use super::e_series::{self, Numbers};
use super::{Link, Preset};
use crate::Arm;

/// Standard DH rows (a (m), d (m), alpha (rad)). Source: universal-robots.com, "DH Parameters for calculations of
/// kinematics and dynamics".
const DH: [(f64, f64, f64); 6] = [
    (0.0, 0.1625, FRAC_PI_2),
    (-0.425, 0.0, 0.0),
    (-0.3922, 0.0, 0.0),
    (0.0, 0.1333, FRAC_PI_2),
    (0.0, 0.0997, -FRAC_PI_2),
    (0.0, 0.0996, 0.0),
];

/// Links in the frame at the **far** end of each, as the standard convention has it. Source: the same page, inertia as in
/// Universal_Robots_ROS2_Description `config/ur5e/physical_parameters.yaml`, which has more digits of it.
const LINKS: [Link; 6] = [
    (3.761, [0.0, -0.02561, 0.00193], [0.00700210, 0.00000073, -0.00001053, 0.00648091, 0.00049994, 0.00657286]),
    (8.058, [0.2125, 0.0, 0.11336], [0.01505885, -0.00005400, 0.00000563, 0.33388086, -0.00000181, 0.33247207]),
    (2.846, [0.15, 0.0, 0.0265], [0.00399632, -0.00001365, 0.00137272, 0.07879254, -0.00000660, 0.07848510]),
    (1.37, [0.0, -0.0018, 0.01634], [0.00165491, -0.00000282, -0.00000438, 0.00135962, 0.00010157, 0.00126279]),
    (1.3, [0.0, 0.0018, 0.01634], [0.00135617, -0.00000274, 0.00000444, 0.00127827, -0.00005048, 0.00096614]),
    (0.365, [0.0, 0.0, -0.001159], [0.00018694, 0.00000006, -0.00000017, 0.00018908, -0.00000092, 0.00025756]),
];

/// The UR5e without payload (`e_series.rs` says in which frames).
///
/// Limits of position, speed and torque from Universal_Robots_ROS2_Description `config/ur5e/joint_limits.yaml`. The vendor
/// publishes no rotor inertia. Assumption: 0.1 kg m² in every joint, the armature in
/// mujoco_menagerie `universal_robots_ur5e`.
pub fn ur5e() -> Arm<6> {
    e_series::arm(&Numbers {
        name: "ur5e",
        dh: DH,
        links: LINKS,
        qd_max_rad_s: [PI; 6],
        tau_max_nm: [150.0, 150.0, 150.0, 28.0, 28.0, 28.0],
        rotor_inertia_kg_m2: [0.1; 6],
    })
}

/// The UR5e with its poses, elbow-up with the tool down: the middle of the workspace, to its side, and further out.
///
/// Joint stiffness is an assumption, as the vendor publishes none: the order of magnitude of strain-wave gears, in proportion
/// to the torque limits of these joints and the UR10e's.
pub(super) fn preset() -> Preset<6> {
    Preset {
        arm: ur5e(),
        poses_rad: [
            SVector::from([0.0, -1.8, 2.0, -1.77, -FRAC_PI_2, 0.0]),
            SVector::from([0.8, -1.5, 1.7, -1.7, -1.4, 0.4]),
            SVector::from([-0.6, -1.3, 1.6, -1.8, -1.7, -0.5]),
        ],
        joint_stiffness_nm_per_rad: [2e4, 2e4, 2e4, 5e3, 5e3, 5e3],
    }
}
