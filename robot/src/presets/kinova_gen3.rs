//! Kinova Gen3 with seven joints and vision module.

use nalgebra::{SVector, Vector3};
use std::f64::consts::FRAC_PI_2;

use super::{Link, Preset, links, quarter_turns_x};
use crate::{Arm, JointNames, JointPlacement, Limits, Mechanism};

/// Origins of the joints (m) and quarter turns about the parent's x axis. Source: ros_kortex
/// `GEN3-7DOF-VISION_ARM_URDF_V12.urdf`; its 3.1416 and 1.5708 are meant as π and π/2.
const PLACEMENTS: [([f64; 3], i32); 7] = [
    ([0.0, 0.0, 0.15643], 2),
    ([0.0, 0.005375, -0.12838], 1),
    ([0.0, -0.21038, -0.006375], -1),
    ([0.0, 0.006375, -0.21038], 1),
    ([0.0, -0.20843, -0.006375], -1),
    ([0.0, 0.00017505, -0.10593], 1),
    ([0.0, -0.10593, -0.00017505], -1),
];

/// Links. Source: the same file.
const LINKS: [Link; 7] = [
    (1.3773, [-2.3e-5, -0.010364, -0.07336], [0.00457, 1e-6, 2e-6, 0.004831, 0.000448, 0.001409]),
    (1.1636, [-4.4e-5, -0.09958, -0.013278], [0.011088, 5e-6, 0.0, 0.001072, -0.000691, 0.011255]),
    (1.1636, [-4.4e-5, -0.006641, -0.117892], [0.010932, 0.0, -7e-6, 0.011127, 0.000606, 0.001043]),
    (0.9302, [-1.8e-5, -0.075478, -0.015006], [0.008147, -1e-6, 0.0, 0.000631, -0.0005, 0.008316]),
    (0.6781, [1e-6, -0.009432, -0.063883], [0.001596, 0.0, 0.0, 0.001607, 0.000256, 0.000399]),
    (0.6781, [1e-6, -0.045483, -0.00965], [0.001641, 0.0, 0.0, 0.00041, -0.000278, 0.001641]),
    (0.5006, [-0.000281, -0.011402, -0.029798], [0.000587, 3e-6, 3e-6, 0.000369, 0.000118, 0.000609]),
];

/// The Gen3 without payload; flange: `end_effector_link`, 0.061525 m beyond joint 7, z outward.
///
/// Limits of position, speed and torque from ros_kortex (the same file); joints without position limits may turn five
/// times either way here. The vendor publishes neither torque rate nor rotor inertia. Assumptions: 1000 Nm/s, as the
/// Panda's; rotor inertia as the diagnosis of two public logs finds it (`experiments/06_diagnosis`: 0.09 kg m² in
/// joints 0 to 2, 0.08 in joint 3, 0.013 in joint 4, whose actuator joints 5 and 6 have too).
pub fn kinova_gen3() -> Arm<7> {
    let endless = 10.0 * std::f64::consts::PI;
    Arm {
        name: "kinova_gen3".to_owned(),
        joint_names: JointNames::numbered("joint_", 7),
        mechanism: Mechanism {
            placements: PLACEMENTS.map(|(origin, turns)| JointPlacement {
                rotation: quarter_turns_x(turns),
                translation: Vector3::from(origin),
            }),
            links: links(&LINKS),
            link_from_flange_rotation: quarter_turns_x(2),
            link_from_flange_translation: Vector3::new(0.0, 0.0, -0.061525),
        }
        .into(),
        rotor_inertia_kg_m2: SVector::from([0.09, 0.09, 0.09, 0.08, 0.013, 0.013, 0.013]),
        limits: Limits {
            q_min_rad: SVector::from([-endless, -2.24, -endless, -2.57, -endless, -2.09, -endless]),
            q_max_rad: SVector::from([endless, 2.24, endless, 2.57, endless, 2.09, endless]),
            qd_max_rad_s: SVector::from([1.3963, 1.3963, 1.3963, 1.3963, 1.2218, 1.2218, 1.2218]),
            tau_max_nm: SVector::from([39.0, 39.0, 39.0, 39.0, 9.0, 9.0, 9.0]),
            tau_rate_max_nm_s: SVector::repeat(1000.0),
        },
        gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
    }
}

/// The Gen3 with its poses: the vendor's home (mujoco_menagerie `kinova_gen3`, key `home`) and two others of the workspace.
///
/// Joint stiffness is an assumption, as the vendor publishes none: the order of magnitude of strain-wave gears of this size.
pub(super) fn preset() -> Preset<7> {
    let home = [0.0, 0.26179939, std::f64::consts::PI, -2.26892803, 0.0, 0.95993109, FRAC_PI_2];
    Preset {
        arm: kinova_gen3(),
        poses_rad: [
            SVector::from(home),
            SVector::from([0.4, 0.6, 2.8, -1.9, 0.3, 1.0, 1.2]),
            SVector::from([-0.5, 0.5, 3.4, -1.7, -0.3, 1.2, 1.9]),
        ],
        joint_stiffness_nm_per_rad: [7e3, 7e3, 7e3, 7e3, 4e3, 4e3, 4e3],
    }
}
