//! Universal Robots UR3e, six joints.

use nalgebra::SVector;
use std::f64::consts::{FRAC_PI_2, PI};

use super::e_series::{self, Numbers};
use super::{Link, Preset};
use crate::Arm;

/// Standard DH rows (a (m), d (m), alpha (rad)). Source: universal-robots.com, "DH Parameters for calculations of
/// kinematics and dynamics".
const DH: [(f64, f64, f64); 6] = [
    (0.0, 0.15185, FRAC_PI_2),
    (-0.24355, 0.0, 0.0),
    (-0.2132, 0.0, 0.0),
    (0.0, 0.13105, FRAC_PI_2),
    (0.0, 0.08535, -FRAC_PI_2),
    (0.0, 0.0921, 0.0),
];

/// Links in the frame at the **far** end of each, as the standard convention has it. Source: the same page, inertia as in
/// Universal_Robots_ROS2_Description `config/ur3e/physical_parameters.yaml`, which has more digits of it.
const LINKS: [Link; 6] = [
    (1.98, [0.0, -0.02, 0.0], [0.0027657, 0.0000096, -0.0000149, 0.0021501, 0.0001873, 0.0025626]),
    (3.4445, [0.13, 0.0, 0.1157], [0.0042623, -0.0000409, -0.0014960, 0.0460284, -0.0000129, 0.0448947]),
    (1.437, [0.05, 0.0, 0.0238], [0.0010511, 0.0, -0.0000331, 0.0113396, 0.0000022, 0.0110895]),
    (0.871, [0.0, 0.0, 0.01], [0.0008174, -0.0000005, 0.0000021, 0.0006844, 0.0000617, 0.0005497]),
    (0.805, [0.0, 0.0, 0.01], [0.0006059, -0.0000006, -0.0000006, 0.0005837, -0.0000271, 0.0003831]),
    (0.261, [0.0, 0.0, -0.02], [0.0001080, -0.0000001, -0.0000001, 0.0001086, -0.0000002, 0.0001371]),
];

/// The UR3e without payload (`e_series.rs` says in which frames).
///
/// Limits of position, speed and torque from Universal_Robots_ROS2_Description `config/ur3e/joint_limits.yaml`. The vendor
/// publishes no rotor inertia. Assumption: in proportion to the torque limits,
/// as the 0.1 kg m² of the UR5e's large joints.
pub fn ur3e() -> Arm<6> {
    e_series::arm(&Numbers {
        name: "ur3e",
        dh: DH,
        links: LINKS,
        qd_max_rad_s: [PI, PI, PI, 2.0 * PI, 2.0 * PI, 2.0 * PI],
        tau_max_nm: [56.0, 56.0, 28.0, 12.0, 12.0, 12.0],
        rotor_inertia_kg_m2: [0.04, 0.04, 0.02, 0.01, 0.01, 0.01],
    })
}

/// The UR3e with its poses, elbow-up with the tool down: the middle of the workspace, to its side, and further out.
///
/// Joint stiffness is an assumption, as the vendor publishes none: the order of magnitude of strain-wave gears, in proportion
/// to the torque limits of these joints and the UR10e's.
pub(super) fn preset() -> Preset<6> {
    Preset {
        arm: ur3e(),
        poses_rad: [
            SVector::from([0.0, -1.8, 2.0, -1.77, -FRAC_PI_2, 0.0]),
            SVector::from([0.8, -1.5, 1.7, -1.7, -1.4, 0.4]),
            SVector::from([-0.6, -1.3, 1.6, -1.8, -1.7, -0.5]),
        ],
        joint_stiffness_nm_per_rad: [9e3, 9e3, 5e3, 2e3, 2e3, 2e3],
    }
}
